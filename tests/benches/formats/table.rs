//! What was measured, as a table in Markdown.

use std::path::PathBuf;

use crate::measured::Measured;
use crate::peers::Peers;

/// A file and what its readers took.
pub(crate) struct Row {
    pub(crate) file: PathBuf,
    pub(crate) bytes: u64,
    pub(crate) ours: Measured,
    pub(crate) others: Peers,
}

/// The most memory that a load may take.
const fn allowed_bytes(file_bytes: u64) -> u64 {
    4 * file_bytes + 64_000_000
}

/// The head of the table.
pub(crate) const HEAD: &str = "\
| format | file | MB | surfels | triangles | s | MB/s | fastest other | its s | times as fast | peak MB | allowed MB |
|---|---|---|---|---|---|---|---|---|---|---|---|";

/// The head of the others' table.
pub(crate) const OTHERS_HEAD: &str = "\
| file | reader | s | peak MB | points | triangles |
|---|---|---|---|---|---|";

impl Row {
    /// The line of the table.
    pub(crate) fn line(&self) -> String {
        let (seconds, megabytes) = (self.ours.median(), self.bytes as f64 / 1e6);
        let (name, other, ratio) = self.others.fastest().map_or_else(
            || ("none".to_owned(), "–".to_owned(), "–".to_owned()),
            |(name, measured)| {
                let median = measured.median();
                (
                    name.to_owned(),
                    format!("{median:.4}"),
                    format!("{:.2}", median / seconds),
                )
            },
        );
        format!(
            "| {} | {} | {megabytes:.2} | {} | {} | {seconds:.4} | {:.0} | {name} | {other} | {ratio} | {:.1} | {:.1} |",
            self.ours.format,
            self.name(),
            self.ours.surfels,
            self.ours.triangles,
            megabytes / seconds,
            self.ours.peak_bytes as f64 / 1e6,
            allowed_bytes(self.bytes) as f64 / 1e6,
        )
    }

    /// The lines of the others.
    pub(crate) fn lines_of_others(&self) -> Vec<String> {
        let others = self.others.0.iter();
        others
            .map(|(name, measured)| {
                let median = measured.median();
                let seconds = if median.is_nan() {
                    "not read".to_owned()
                } else {
                    format!("{median:.4}")
                };
                format!(
                    "| {} | {name} | {seconds} | {:.1} | {} | {} |",
                    self.name(),
                    measured.peak_bytes as f64 / 1e6,
                    measured.surfels,
                    measured.triangles
                )
            })
            .collect()
    }

    fn name(&self) -> String {
        let name = self.file.file_name().unwrap_or_default();
        name.to_string_lossy().into_owned()
    }
}
