//! Points as text: XYZ, PTS and CSV. A point is a line of numbers, apart by spaces, tabs, commas or semicolons.

use pointstage_plugin_api::lines::{Line, Lines};
use pointstage_plugin_api::loading::{Claim, FileStart, Loader, Output, SourceFile};
use pointstage_plugin_api::pieces::{Fault, Text};
use pointstage_plugin_api::{Error, Host, Progress, Result, Settings};

use crate::columns::{Bytes, Columns, Value};
use crate::xyz_columns::{LineKind, guess, kind_of, named, read_numbers};

/// Whole lines of points at a file's start that make it look like one of ours.
const LINES_TO_CLAIM: usize = 3;

/// Lines looked at between two looks at the cancel flag.
const LINES_A_PIECE: u64 = 1 << 14;

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
        host: &Host,
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
        // A short line holds two bytes a value; a usual one some ten.
        columns.declare(out, (file.bytes.len() / (10 * values.len())) as u64)?;
        let first = first_point(file.bytes, values.len(), progress)?;
        Text::new(first, "reading points").read(
            host,
            progress,
            |lines| read(lines, &columns, values.len()),
            |points| points.write(out),
        )
    }
}

/// The lines from the first point on, behind anything but other numbers.
fn first_point<'f>(file: &'f [u8], width: usize, progress: &Progress<'_>) -> Result<Lines<'f>> {
    let mut values = Vec::new();
    let mut lines = Lines::new(file);
    loop {
        let from_here = lines.clone();
        let Some(line) = lines.next() else {
            return Ok(lines);
        };
        if line.number.is_multiple_of(LINES_A_PIECE) {
            progress.check()?;
        }
        values.clear();
        read_numbers(line.text, &mut values);
        if values.len() == width {
            return Ok(from_here);
        }
        if let LineKind::Numbers(_) = kind_of(&line) {
            let (number, message) = (line.number, other_width(&line, width, values.len()));
            return Err(Error::failed(format!("line {number}: {message}")));
        }
    }
}

/// The points of some lines.
fn read(lines: Lines<'_>, columns: &Columns, width: usize) -> Result<Bytes, Fault> {
    let mut values = Vec::new();
    for line in lines {
        let before = values.len();
        read_numbers(line.text, &mut values);
        let found = values.len() - before;
        if found == width {
            continue;
        }
        values.truncate(before);
        // Comments, and counts and headings before the points of each scan.
        if let LineKind::Numbers(_) | LineKind::Other = kind_of(&line) {
            return Err(Fault::new(&line, other_width(&line, width, found)));
        }
    }
    Ok(columns.bytes(&values))
}

fn other_width(line: &Line<'_>, width: usize, found: usize) -> String {
    format!(
        "expected {width} numbers as in the lines before, found {found} in '{}'; correct that line, or export the file again",
        line.excerpt()
    )
}
