//! Lines, words and numbers of text files, for loaders; [`pieces`](crate::pieces) has them read by several threads.

use memchr::memchr2;

pub use crate::scan::{scan_f64, scan_i64};

/// The lines of a text file, with their numbers; they end in LF, CR LF or CR.
#[derive(Clone, Debug)]
pub struct Lines<'a> {
    text: &'a [u8],
    position: usize,
    number: u64,
}

/// One line of a text file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line<'a> {
    /// From 1, as editors count; in a [piece](crate::pieces) from its start.
    pub number: u64,
    /// Without its end.
    pub text: &'a [u8],
}

impl<'a> Lines<'a> {
    /// The lines of `text`.
    pub fn new(text: &'a [u8]) -> Self {
        Self {
            text,
            position: 0,
            number: 0,
        }
    }

    /// All of the text, what has been read too.
    pub(crate) fn text(&self) -> &'a [u8] {
        self.text
    }

    /// Number of the line that was read last; 0 before the first.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// The same lines without those that begin at byte `end` or behind it, where a line begins.
    #[must_use]
    pub fn until(mut self, end: usize) -> Self {
        self.text = self.text.get(..end).unwrap_or(self.text);
        self
    }

    /// Byte where the next line begins.
    pub fn position(&self) -> usize {
        self.position
    }

    /// Part of the file that has been read, 0 to 1.
    pub fn fraction(&self) -> f32 {
        (self.position as f64 / self.text.len().max(1) as f64) as f32
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        let rest = self.text.get(self.position..)?;
        if rest.is_empty() {
            return None;
        }
        self.number += 1;
        let length = memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
        let (text, end) = rest.split_at(length);
        let end = match end {
            [b'\r', b'\n', ..] => 2,
            [_, ..] => 1,
            [] => 0,
        };
        self.position += length + end;
        Some(Line {
            number: self.number,
            text,
        })
    }
}

impl<'a> Line<'a> {
    /// What stands between spaces and tabs.
    pub fn words(&self) -> Words<'a> {
        Words { rest: self.text }
    }

    /// The line for a message: at most 40 bytes, escaped.
    pub fn excerpt(&self) -> String {
        excerpt(self.text)
    }
}

/// The words of a line that have not been read yet.
#[derive(Clone, Debug)]
pub struct Words<'a> {
    rest: &'a [u8],
}

impl<'a> Words<'a> {
    /// What is left of the line, from the next word on.
    #[inline]
    pub fn rest(&mut self) -> &'a [u8] {
        while let [first, behind @ ..] = self.rest
            && is_blank(*first)
        {
            self.rest = behind;
        }
        self.rest
    }

    /// Passes over so many bytes of what is left.
    #[inline]
    pub fn advance(&mut self, bytes: usize) {
        self.rest = self.rest.get(bytes..).unwrap_or_default();
    }

    /// The next word as a number; `None` if there is no word or it is no number, which is passed over then.
    #[inline]
    pub fn number(&mut self) -> Option<f64> {
        self.scan(scan_f64, number)
    }

    /// The next word as a whole number; `None` if there is no word or it is none, which is passed over then.
    #[inline]
    pub fn integer(&mut self) -> Option<i64> {
        self.scan(scan_i64, integer)
    }

    /// What nearly every number looks like need not be cut out first.
    #[inline]
    fn scan<T>(
        &mut self,
        scan: impl Fn(&[u8]) -> Option<(T, usize)>,
        read: impl Fn(&[u8]) -> Option<T>,
    ) -> Option<T> {
        let rest = self.rest();
        if let Some((value, length)) = scan(rest)
            && let behind = &rest[length..]
            && behind.first().is_none_or(|byte| is_blank(*byte))
        {
            self.rest = behind;
            return Some(value);
        }
        self.next().and_then(read)
    }
}

impl<'a> Iterator for Words<'a> {
    type Item = &'a [u8];

    #[inline]
    fn next(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest();
        let length = rest.iter().position(|byte| is_blank(*byte));
        let (word, behind) = rest.split_at(length.unwrap_or(rest.len()));
        self.rest = behind;
        (!word.is_empty()).then_some(word)
    }
}

fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | 0x0b | 0x0c)
}

/// The number that a word is, if it is one: `1`, `-2.5e3`, `+.5`, `nan`, `inf`.
#[inline]
pub fn number(word: &[u8]) -> Option<f64> {
    match scan_f64(word) {
        Some((value, length)) if length == word.len() => Some(value),
        _ => std::str::from_utf8(word).ok()?.parse().ok(),
    }
}

/// The whole number that a word is, if it is one.
#[inline]
pub fn integer(word: &[u8]) -> Option<i64> {
    match scan_i64(word) {
        Some((value, length)) if length == word.len() => Some(value),
        _ => std::str::from_utf8(word).ok()?.parse().ok(),
    }
}

/// Bytes of a file for a message: at most 40, escaped.
pub fn excerpt(bytes: &[u8]) -> String {
    const MOST: usize = 40;
    let shown = bytes[..bytes.len().min(MOST)].escape_ascii().to_string();
    if bytes.len() > MOST {
        shown + "…"
    } else {
        shown
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_in_any_of_the_three_ways_and_are_counted() {
        let mut lines = Lines::new(b"a b\r\nc\rd\n\nlast");
        let read: Vec<(u64, &[u8])> = lines
            .by_ref()
            .map(|line| (line.number, line.text))
            .collect();
        let expected: [(u64, &[u8]); 5] =
            [(1, b"a b"), (2, b"c"), (3, b"d"), (4, b""), (5, b"last")];
        assert_eq!(read, expected);
        assert_eq!((lines.position(), lines.fraction()), (14, 1.0));
        assert_eq!(Lines::new(b"").next(), None);
    }

    #[test]
    fn words_are_apart_by_any_space() {
        let line = Lines::new(b"  1\t-2.5e3   nan x ")
            .next()
            .expect("one line");
        let words: Vec<&[u8]> = line.words().collect();
        assert_eq!(words.len(), 4);
        assert_eq!(
            (number(words[0]), number(words[1]), number(words[3])),
            (Some(1.0), Some(-2500.0), None)
        );
        assert!(number(words[2]).is_some_and(f64::is_nan));
        let mut words = Lines::new(b" 7 -2.5e3 7.0 x9 1e400 12a 5 ")
            .next()
            .expect("one line")
            .words();
        assert_eq!((words.integer(), words.number()), (Some(7), Some(-2500.0)));
        assert_eq!((words.integer(), words.number()), (None, None));
        assert_eq!(
            (words.number(), words.number()),
            (Some(f64::INFINITY), None)
        );
        assert_eq!(
            (words.rest(), words.next(), words.number()),
            (&b"5 "[..], Some(&b"5"[..]), None)
        );
        assert_eq!(
            (integer(b"-7"), integer(b"7.0"), integer(b"\xff")),
            (Some(-7), None, None)
        );
    }
}
