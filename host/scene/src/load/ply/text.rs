//! The text of a body, cut at line ends into pieces for threads, with its lines counted.

use rayon::prelude::*;

use super::body::Stop;
use super::error::{Place, PlyError};
use super::header::{Element, PlyHeader};
use super::words::Words;
use crate::job::Job;
use crate::load::source::Source;

/// Text read between two looks at the cancel flag, and by one thread at a time, bytes.
const PIECE_BYTES: usize = 256 << 10;

/// The text of a body, with its lines counted.
pub(super) struct Text<'a> {
    file: &'a Source,
    /// The body.
    bytes: &'a [u8],
    line_end: u8,
    pub(super) pieces: Vec<Piece>,
    /// Lines with words.
    pub(super) lines: u64,
    /// Lines of the whole file.
    pub(super) file_lines: u64,
}

/// A run of whole lines.
pub(super) struct Piece {
    pub(super) start: usize,
    pub(super) end: usize,
    /// Lines with words before this piece, in the body.
    pub(super) lines_before: u64,
    /// Lines with words in it.
    pub(super) lines: u64,
    /// Lines before this piece in the file, blank ones too.
    pub(super) file_lines_before: u64,
}

impl<'a> Text<'a> {
    /// Counts the lines of the body of `file`.
    pub(super) fn index(file: &'a Source, header: &PlyHeader, job: &Job) -> Result<Self, Stop> {
        let line_end = header.line_end;
        let bytes = file.get(header.body_start..).unwrap_or_default();
        let mut starts = vec![0];
        while let Some(wanted) = starts
            .last()
            .map(|start| start + PIECE_BYTES)
            .filter(|wanted| *wanted < bytes.len())
        {
            let Some(end) = memchr::memchr(line_end, &bytes[wanted..]) else {
                break;
            };
            starts.push(wanted + end + 1);
        }
        let ends = starts.iter().skip(1).copied().chain([bytes.len()]);
        let ranges: Vec<(usize, usize)> = starts.iter().copied().zip(ends).collect();
        let counts: Vec<(u64, u64)> = ranges
            .par_iter()
            .map(|&(start, end)| {
                job.check()?;
                let counted = count_lines(&bytes[start..end], line_end);
                // Memory stays low: the piece is read again later, which costs little while the system still has it.
                file.release(header.body_start + start..header.body_start + end);
                Ok(counted)
            })
            .collect::<Result<_, Stop>>()?;
        let (mut lines_before, mut file_lines_before) = (0, header.line_count);
        let mut pieces = Vec::with_capacity(ranges.len());
        for ((start, end), (lines, all_lines)) in ranges.into_iter().zip(counts) {
            pieces.push(Piece {
                start,
                end,
                lines_before,
                lines,
                file_lines_before,
            });
            lines_before += lines;
            file_lines_before += all_lines;
        }
        Ok(Self {
            file,
            bytes,
            line_end,
            pieces,
            lines: lines_before,
            file_lines: file_lines_before,
        })
    }

    /// The words of a piece.
    pub(super) fn words(&self, piece: &Piece) -> Words<'a> {
        Words::new(&self.bytes[piece.start..piece.end], self.line_end)
    }

    /// Line of the file where `rest`, the end of a piece, starts.
    pub(super) fn line_of(&self, piece: &Piece, rest: &[u8]) -> u64 {
        let before = &self.bytes[piece.start..piece.end - rest.len()];
        piece.file_lines_before + 1 + count(before, |byte| byte == self.line_end)
    }

    /// Tells the system that a piece has been read.
    pub(super) fn release(&self, piece: &Piece) {
        let body_start = self.file.len() - self.bytes.len();
        self.file
            .release(body_start + piece.start..body_start + piece.end);
    }

    /// Refuses rows that are not there before anything is allocated for them.
    pub(super) fn check_room(
        &self,
        element: &Element,
        first_line: u64,
        rows: u64,
    ) -> Result<(), PlyError> {
        let left = self.lines - first_line;
        if rows <= left {
            return Ok(());
        }
        Err(PlyError::MissingRows {
            place: Place::Line(self.file_lines),
            element: element.name.clone(),
            row: left + 1,
            rows,
        })
    }
}

/// Lines of `text` that have words, and all of its lines.
fn count_lines(text: &[u8], line_end: u8) -> (u64, u64) {
    let unfinished = text.last().is_some_and(|byte| *byte != line_end);
    let all = count(text, |byte| byte == line_end) + u64::from(unfinished);
    // Most files have no line that starts with a blank, hence none without words.
    let after_ends = text.get(1..).unwrap_or_default();
    let blank_starts = count_pairs(text, after_ends, |before, byte| {
        before == line_end && byte <= b' '
    });
    if blank_starts == 0 && text.first().is_some_and(|byte| *byte > b' ') {
        return (all, all);
    }
    let mut words = Words::new(text, line_end);
    let mut with_words = 0;
    while words.start_row() {
        with_words += 1;
        words.end_row();
    }
    (with_words, all)
}

/// Bytes summed at once: 255 ones fit into a byte, so that the loop over them runs on whole vectors.
const BYTES_A_SUM: usize = 255;

fn count(bytes: &[u8], is_wanted: impl Fn(u8) -> bool) -> u64 {
    let sum = |bytes: &[u8]| {
        bytes
            .iter()
            .map(|byte| u8::from(is_wanted(*byte)))
            .sum::<u8>()
    };
    bytes
        .chunks(BYTES_A_SUM)
        .map(|bytes| u64::from(sum(bytes)))
        .sum()
}

fn count_pairs(first: &[u8], second: &[u8], is_wanted: impl Fn(u8, u8) -> bool) -> u64 {
    let sum = |(first, second): (&[u8], &[u8])| {
        let pairs = first.iter().zip(second);
        pairs.map(|(a, b)| u8::from(is_wanted(*a, *b))).sum::<u8>()
    };
    let chunks = first.chunks(BYTES_A_SUM).zip(second.chunks(BYTES_A_SUM));
    chunks.map(|pair| u64::from(sum(pair))).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn lines_are_counted_as_one_by_one(text in "[a \t\r\n]{0,600}", line_end in prop_oneof![Just(b'\n'), Just(b'\r')]) {
            let text = text.as_bytes();
            let mut lines: Vec<&[u8]> = text.split(|byte| *byte == line_end).collect();
            // What follows the last end is a line only if there is something.
            lines.pop_if(|last| last.is_empty());
            let with_words = lines.iter().filter(|line| line.contains(&b'a')).count() as u64;
            prop_assert_eq!(count_lines(text, line_end), (with_words, lines.len() as u64));
        }
    }
}
