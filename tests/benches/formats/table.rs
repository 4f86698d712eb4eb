//! What was measured, as a table in Markdown.

use std::fmt::Write as _;
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

/// The table, and below it each other reader by itself.
pub(crate) fn markdown(rows: &[Row]) -> String {
    let mut text = String::from(
        "| format | file | MB | surfels | triangles | s | MB/s | fastest other | its s | times as fast | peak MB | allowed MB |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for row in rows {
        let (seconds, megabytes) = (row.ours.median(), row.bytes as f64 / 1e6);
        let (name, other, ratio) = row.others.fastest().map_or_else(
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
        let _ = writeln!(
            text,
            "| {} | {} | {megabytes:.2} | {} | {} | {seconds:.4} | {:.0} | {name} | {other} | {ratio} | {:.1} | {:.1} |",
            row.ours.format,
            row.name(),
            row.ours.surfels,
            row.ours.triangles,
            megabytes / seconds,
            row.ours.peak_bytes as f64 / 1e6,
            allowed_bytes(row.bytes) as f64 / 1e6,
        );
    }
    text.push_str(
        "\n| file | reader | s | peak MB | points | triangles |\n|---|---|---|---|---|---|\n",
    );
    for row in rows {
        for (name, measured) in &row.others.0 {
            let _ = writeln!(
                text,
                "| {} | {name} | {:.4} | {:.1} | {} | {} |",
                row.name(),
                measured.median(),
                measured.peak_bytes as f64 / 1e6,
                measured.surfels,
                measured.triangles
            );
        }
    }
    text
}

impl Row {
    fn name(&self) -> String {
        let name = self.file.file_name().unwrap_or_default();
        name.to_string_lossy().into_owned()
    }
}
