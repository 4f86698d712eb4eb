//! Points as text: XYZ, PTS and CSV. A point is a line of numbers, apart by spaces, tabs, commas or semicolons.

use pointstage_plugin_api::lines::{Lines, number};
use pointstage_plugin_api::loading::{Claim, FileStart, Loader, Output, SourceFile};
use pointstage_plugin_api::{Error, Host, Progress, Result, Settings};

use crate::columns::{Columns, Value, run_of};
use crate::xyz_columns::{LineKind, guess, kind_of, named, words};

/// Whole lines of points at a file's start that make it look like one of ours.
const LINES_TO_CLAIM: usize = 3;

/// The loader of text files.
pub struct XyzLoader;

impl Loader for XyzLoader {
    fn claims(start: &FileStart<'_>) -> Claim {
        if start.bytes.contains(&0) {
            return Claim::No;
        }
        // The last line may have been cut off.
        let is_all = start.bytes.len() as u64 == start.length;
        let end = start
            .bytes
            .iter()
            .rposition(|byte| matches!(byte, b'\n' | b'\r'));
        let whole = if is_all {
            start.bytes
        } else {
            &start.bytes[..end.unwrap_or(0)]
        };
        let (mut width, mut rows) = (None, 0);
        for line in Lines::new(whole) {
            match kind_of(&line) {
                LineKind::Numbers(count) if count >= 3 && *width.get_or_insert(count) == count => {
                    rows += 1;
                }
                LineKind::Numbers(_) | LineKind::Other => return Claim::Possible,
                LineKind::Empty | LineKind::Count | LineKind::Heading(_) => {}
            }
        }
        match rows {
            0 => Claim::Possible,
            rows if rows >= LINES_TO_CLAIM || is_all => Claim::Likely,
            _ => Claim::Possible,
        }
    }

    fn load(
        _host: &Host,
        file: &SourceFile<'_>,
        settings: Settings<'_>,
        out: &mut Output<'_>,
        progress: &Progress<'_>,
    ) -> Result<()> {
        progress.set(0.0, "reading points");
        let option = settings.text("columns")?;
        let values: Vec<Value> = if option.trim().is_empty() {
            guess(file.bytes).ok_or_else(|| {
                Error::failed(
                    "expected lines of three numbers or more, found none; there is nothing to show",
                )
            })?
        } else {
            named(&option.split_whitespace().collect::<Vec<_>>())
        };
        let columns = Columns::new(&values)?;
        read(file.bytes, &columns, values.len(), out, progress)
    }
}

fn read(
    file: &[u8],
    columns: &Columns,
    width: usize,
    out: &mut Output<'_>,
    progress: &Progress<'_>,
) -> Result<()> {
    // A short line holds two bytes a value; a usual one some ten.
    columns.declare(out, (file.len() / (10 * width)) as u64)?;
    let run = run_of(width);
    let mut values = Vec::with_capacity(width * run.min(file.len() / (2 * width) + 1));
    let (mut lines, mut has_points) = (Lines::new(file), false);
    while let Some(line) = lines.next() {
        let before = values.len();
        values.extend(words(line.text).map_while(number));
        if values.len() - before != width {
            let found = values.len() - before;
            values.truncate(before);
            // Comments, headings, and counts before the points of each scan.
            match kind_of(&line) {
                LineKind::Empty | LineKind::Count | LineKind::Heading(_) => continue,
                LineKind::Other if !has_points => continue,
                LineKind::Numbers(_) | LineKind::Other => {}
            }
            return Err(Error::failed(format!(
                "line {}: expected {width} numbers as in the lines before, found {found} in '{}'; correct that line, or export the file again",
                line.number,
                line.excerpt()
            )));
        }
        has_points = true;
        if values.len() == run * width {
            progress.check()?;
            progress.set(lines.fraction(), "reading points");
            columns.write(out, &values)?;
            values.clear();
        }
    }
    columns.write(out, &values)
}
