//! Sections of a TRI file: heads with a name, and rows of numbers under them.

use memchr::memchr2;
use pointstage_plugin_api::lines::excerpt;

use super::error::TriError;
use crate::job::Job;
use crate::load::assemble::MAX_COORDINATE;
use crate::load::error::LoadStop;
use crate::load::ply::number::parse_f64;

/// Rows read between two looks at the cancel flag.
const ROWS_A_PIECE: usize = 1 << 14;

/// A section that something comes of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Vertices,
    VertexNormals,
    Triangles,
    TriangleNormals,
}

impl Kind {
    /// All of them, those with longer names first.
    const ALL: [Self; 4] = [
        Self::VertexNormals,
        Self::TriangleNormals,
        Self::Vertices,
        Self::Triangles,
    ];

    /// As it is matched: without apostrophes, in lower case.
    const fn plain_name(self) -> &'static str {
        match self {
            Self::Vertices => "vertices",
            Self::VertexNormals => "vertices normals",
            Self::Triangles => "triangles",
            Self::TriangleNormals => "triangles normals",
        }
    }

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Vertices => "Vertices",
            Self::VertexNormals => "Vertices' Normals",
            Self::Triangles => "Triangles",
            Self::TriangleNormals => "Triangles' Normals",
        }
    }
}

/// Rows of three numbers.
#[derive(Debug)]
pub(super) struct Section {
    pub(super) kind: Kind,
    /// Its head, from 1.
    pub(super) line: u64,
    /// Rows that it says it has.
    count: Option<u64>,
    /// Three numbers, and the fourth if the row has one; NaN stands for none.
    rows: Vec<[f64; 4]>,
    /// Every row so far has four numbers, of which the first counts the rows from 0, or from 1.
    counts_rows_from: [bool; 2],
}

impl Section {
    fn new(kind: Kind, line: u64, count: Option<u64>) -> Self {
        Self {
            kind,
            line,
            count,
            rows: Vec::new(),
            counts_rows_from: [true; 2],
        }
    }

    pub(super) fn len(&self) -> usize {
        self.rows.len()
    }

    /// The rows, without the running number where every row has one.
    pub(super) fn rows(&self) -> impl ExactSizeIterator<Item = [f64; 3]> {
        let skipped = usize::from(self.counts_rows_from.contains(&true));
        self.rows
            .iter()
            .map(move |row| [row[skipped], row[skipped + 1], row[skipped + 2]])
    }

    /// Adds the row of a line, or takes its count from it.
    fn add_line(&mut self, text: &[u8], line: u64) -> Result<(), TriError> {
        let row = self.rows.len() as u64 + 1;
        let section = self.kind.name();
        let mut numbers = [f64::NAN; 4];
        let mut found = 0;
        let mut exact = true;
        for word in words(text) {
            let Some(number) = numbers.get_mut(found) else {
                exact = false;
                break;
            };
            let value = parse_f64(word).filter(|value| value.abs() <= MAX_COORDINATE);
            match value {
                Some(value) => *number = value,
                // Beyond the third, anything may stand.
                None if found == 3 => break,
                None => {
                    return Err(TriError::Number {
                        line,
                        section,
                        row,
                        found: excerpt(word),
                    });
                }
            }
            found += 1;
        }
        if found == 1 && self.count.is_none() && self.rows.is_empty() {
            let only = words(text).next().and_then(unsigned);
            if let Some(count) = only {
                self.count = Some(count);
                return Ok(());
            }
        }
        if found < 3 {
            return Err(TriError::ShortRow {
                line,
                section,
                row,
                found,
            });
        }
        if self.count.is_some_and(|count| row > count) {
            return Err(self.wrong_count(line, row));
        }
        for (base, counts) in self.counts_rows_from.iter_mut().enumerate() {
            *counts &= found == 4 && exact && numbers[0] == (row - 1) as f64 + base as f64;
        }
        self.rows.push(numbers);
        Ok(())
    }

    fn wrong_count(&self, line: u64, found: u64) -> TriError {
        TriError::RowCount {
            line,
            section: self.kind.name(),
            expected: self.count.unwrap_or(0),
            found,
        }
    }

    /// Refuses a section that ends early.
    fn end(self, line: u64) -> Result<Self, TriError> {
        match self.count {
            Some(count) if count != self.rows.len() as u64 => {
                Err(self.wrong_count(line, self.rows.len() as u64))
            }
            _ => Ok(self),
        }
    }
}

/// The sections of a file, in its order, and the number of its lines.
pub(super) fn sections(file: &[u8], job: &Job) -> Result<(Vec<Section>, u64), LoadStop> {
    let mut ended: Vec<Section> = Vec::new();
    let mut open: Option<Section> = None;
    let mut last_line = 0;
    for (text, line) in lines(file).zip(1..) {
        last_line = line;
        if line % ROWS_A_PIECE as u64 == 0 {
            job.check()?;
            job.set_progress_within(&(0.0..0.3), file.len() - text.len(), file.len());
        }
        let text = without_comment(text);
        let Some(first) = words(text).next() else {
            continue;
        };
        if parse_f64(first).is_some() {
            if let Some(section) = &mut open {
                section.add_line(text, line)?;
            }
            continue;
        }
        if let (Some(section), b'0'..=b'9' | b'+' | b'-' | b'.') = (&mut open, first[0]) {
            // It looks like a number and is none: the row says what is wrong.
            section.add_line(text, line)?;
            continue;
        }
        // A head that is not known begins a section that is passed over.
        if let Some(section) = open.take() {
            ended.push(section.end(line)?);
        }
        if let Some((kind, count)) = head(text) {
            if ended.iter().any(|section| section.kind == kind) {
                let section = kind.name();
                return Err(TriError::Twice { line, section }.into());
            }
            open = Some(Section::new(kind, line, count));
        }
    }
    if let Some(section) = open.take() {
        ended.push(section.end(last_line)?);
    }
    Ok((ended, last_line))
}

/// The section whose head a line is, and the count behind its name.
pub(super) fn head(text: &[u8]) -> Option<(Kind, Option<u64>)> {
    // Only a short line can be one.
    const LONGEST: usize = 200;
    let mut plain = String::new();
    for &byte in &text[..text.len().min(LONGEST)] {
        match byte {
            // Apostrophes: the one of ASCII, and the typographic one in Windows-1252 and, in three bytes, in UTF-8.
            b'\'' | 0x92 | 0xE2 | 0x80 | 0x99 => {}
            b'[' | b']' | b'<' | b'>' | b'{' | b'}' | b'"' | b':' | b'=' | b' ' | b'\t' => {
                if !plain.is_empty() && !plain.ends_with(' ') {
                    plain.push(' ');
                }
            }
            _ => plain.push(char::from(byte.to_ascii_lowercase())),
        }
    }
    Kind::ALL.into_iter().find_map(|kind| {
        let rest = plain.strip_prefix(kind.plain_name())?;
        if rest.starts_with(|next: char| next.is_alphanumeric()) {
            return None;
        }
        let count = rest.split_whitespace().next();
        Some((kind, count.and_then(|word| unsigned(word.as_bytes()))))
    })
}

/// A number of decimal digits only.
fn unsigned(word: &[u8]) -> Option<u64> {
    let is_digits = word.iter().all(u8::is_ascii_digit);
    let text = std::str::from_utf8(word).ok().filter(|_| is_digits)?;
    text.parse().ok()
}

/// The lines of a text, whatever ends them.
pub(super) fn lines(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    let mut rest = Some(text);
    std::iter::from_fn(move || {
        let text = rest?;
        let Some(end) = memchr2(b'\n', b'\r', text) else {
            rest = None;
            return (!text.is_empty()).then_some(text);
        };
        let next = match text[end..] {
            [b'\r', b'\n', ..] => end + 2,
            _ => end + 1,
        };
        rest = Some(&text[next..]);
        Some(&text[..end])
    })
}

/// A line without its comment.
pub(super) fn without_comment(line: &[u8]) -> &[u8] {
    let end = line.iter().enumerate().position(|(index, byte)| {
        matches!(byte, b'#' | b';') || (*byte == b'/' && line.get(index + 1) == Some(&b'/'))
    });
    &line[..end.unwrap_or(line.len())]
}

/// Words between blanks and commas.
fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(|byte| *byte <= b' ' || *byte == b',')
        .filter(|word| !word.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heads_are_found_in_many_spellings() {
        for (line, kind, count) in [
            ("Vertices", Kind::Vertices, None),
            ("[VERTICES] 12", Kind::Vertices, Some(12)),
            ("<Vertices' Normals>", Kind::VertexNormals, None),
            ("vertices’  normals:", Kind::VertexNormals, None),
            ("Vertices Normals = 3", Kind::VertexNormals, Some(3)),
            ("\"Triangles\"", Kind::Triangles, None),
            ("Triangles 7:", Kind::Triangles, Some(7)),
            ("{Triangle's Normals}", Kind::TriangleNormals, None),
        ] {
            assert_eq!(head(line.as_bytes()), Some((kind, count)), "{line}");
        }
        for line in ["TRI 1.0", "Verticesque", "Edges", "", "normals"] {
            assert_eq!(head(line.as_bytes()), None, "{line}");
        }
    }

    #[test]
    fn lines_end_in_three_ways() {
        let found: Vec<&[u8]> = lines(b"a\r\nb\rc\n\nd").collect();
        assert_eq!(found, [&b"a"[..], b"b", b"c", b"", b"d"]);
        assert_eq!(without_comment(b"1 2 // three"), b"1 2 ");
        assert_eq!(without_comment(b"1/2 ; half"), b"1/2 ");
    }
}
