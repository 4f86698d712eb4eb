//! Words of a text, row by row.
//!
//! Nothing is cut before it is read: a number ends where its digits end, a row where a word is followed by a line's end.

/// A place in a text that moves on from word to word; words are apart by blanks, tabs, carriage returns or other control
/// characters, rows by line ends.
pub(super) struct Words<'a> {
    rest: &'a [u8],
    line_end: u8,
}

impl<'a> Words<'a> {
    /// The start of `text`.
    pub(super) fn new(text: &'a [u8], line_end: u8) -> Self {
        Self {
            rest: text,
            line_end,
        }
    }

    /// The text from here on.
    pub(super) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// Moves on to the next word, over blank lines too; false if there is none.
    #[inline]
    pub(super) fn start_row(&mut self) -> bool {
        while let [b'\0'..=b' ', rest @ ..] = self.rest {
            self.rest = rest;
        }
        !self.rest.is_empty()
    }

    /// Moves on to the start of the next line.
    #[inline]
    pub(super) fn end_row(&mut self) {
        if let [byte, rest @ ..] = self.rest
            && *byte == self.line_end
        {
            self.rest = rest;
            return;
        }
        self.rest = match memchr::memchr(self.line_end, self.rest) {
            Some(end) => &self.rest[end + 1..],
            None => &[],
        };
    }

    /// Bytes left in the line.
    pub(super) fn left_in_row(&self) -> usize {
        memchr::memchr(self.line_end, self.rest).unwrap_or(self.rest.len())
    }

    /// The next word of the row.
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

    /// The next word of the row as a number, if `scan` reads all of it; otherwise the word stays.
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
        while let [byte @ b'\0'..=b' ', rest @ ..] = self.rest
            && *byte != self.line_end
        {
            self.rest = rest;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::number::{scan_f64, scan_i64};
    use super::*;

    #[test]
    fn words_stay_in_their_row() {
        let mut words = Words::new(b"\n \r\n1 two\t\r\n\n 3", b'\n');
        assert!(words.start_row());
        assert_eq!(words.next_number(scan_i64), Some(1));
        assert_eq!(words.next_number(scan_i64), None);
        assert_eq!(words.next(), Some(&b"two"[..]));
        assert_eq!((words.next(), words.next_number(scan_f64)), (None, None));
        words.end_row();
        assert!(words.start_row());
        assert_eq!(words.left_in_row(), 1);
        assert_eq!(words.next_number(scan_f64), Some(3.0));
        assert_eq!((words.next(), words.start_row()), (None, false));
    }

    #[test]
    fn the_rest_of_a_row_is_passed_over() {
        let mut words = Words::new(b"1 2 3\r4\r", b'\r');
        assert_eq!(words.next(), Some(&b"1"[..]));
        words.end_row();
        assert_eq!(words.next(), Some(&b"4"[..]));
        words.end_row();
        assert!(!words.start_row());
    }
}
