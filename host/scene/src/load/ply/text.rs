//! The text of a body, cut at line ends into pieces for threads, with its lines counted.

use rayon::prelude::*;

use super::body::Stop;
use super::error::{Place, PlyError};
use super::header::{Element, PlyHeader};
use crate::job::Job;

/// Text read between two looks at the cancel flag, and by one thread at a time, bytes.
const PIECE_BYTES: usize = 256 << 10;

/// The text of a body, with its lines counted.
pub(super) struct Text<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) line_end: u8,
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
    pub(super) fn index(bytes: &'a [u8], header: &PlyHeader, job: &Job) -> Result<Self, Stop> {
        let line_end = header.line_end;
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
                let all = lines_of(&bytes[start..end], line_end);
                Ok(all.fold((0, 0), |(with_words, all), line| {
                    (with_words + u64::from(has_words(line)), all + 1)
                }))
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
            bytes,
            line_end,
            pieces,
            lines: lines_before,
            file_lines: file_lines_before,
        })
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

/// Lines of `text`, without their ends; no line after the last end.
pub(super) fn lines_of(text: &[u8], line_end: u8) -> impl Iterator<Item = &[u8]> {
    let mut start = 0;
    std::iter::from_fn(move || {
        let rest = text.get(start..).filter(|rest| !rest.is_empty())?;
        let length = memchr::memchr(line_end, rest).unwrap_or(rest.len());
        start += length + 1;
        Some(&rest[..length])
    })
}

pub(super) fn has_words(line: &[u8]) -> bool {
    line.iter().any(|byte| *byte > b' ')
}

/// The words of a line, apart by blanks, tabs or carriage returns.
pub(super) struct Words<'a> {
    pub(super) rest: &'a [u8],
}

impl<'a> Words<'a> {
    /// The next word.
    #[inline]
    pub(super) fn next(&mut self) -> Option<&'a [u8]> {
        self.skip_blanks();
        let length = self
            .rest
            .iter()
            .position(|byte| *byte <= b' ')
            .unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(length);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }

    /// The next word as a number, if `scan` reads all of it; otherwise the word stays.
    #[inline]
    pub(super) fn next_number<T>(
        &mut self,
        scan: impl Fn(&[u8]) -> Option<(T, usize)>,
    ) -> Option<T> {
        self.skip_blanks();
        let (value, length) = scan(self.rest)?;
        let rest = &self.rest[length..];
        if rest.first().is_some_and(|byte| *byte > b' ') {
            return None;
        }
        self.rest = rest;
        Some(value)
    }

    #[inline]
    fn skip_blanks(&mut self) {
        while let [b'\0'..=b' ', rest @ ..] = self.rest {
            self.rest = rest;
        }
    }
}
