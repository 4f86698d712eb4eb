//! One row of a text: its values in order, and what can be wrong with them.

use super::error::{Place, PlyError, excerpt};
use super::header::{Element, PropertyKind};
use super::number::{parse_f64, parse_i64, scan_f64, scan_i64};
use super::words::Words;

/// The row at a place in a text.
pub(super) struct Row<'a> {
    words: Words<'a>,
}

/// Why a row cannot be read. Properties are named by their index in the element.
#[derive(Debug, PartialEq)]
pub(super) enum Fault {
    /// The line ends before this property.
    Short { property: usize },
    /// A word is no number.
    Number { property: usize, found: String },
    /// A list cannot be this long.
    ListLength { property: usize, found: i64 },
}

impl<'a> Row<'a> {
    /// Before the first row of `words`.
    pub(super) fn new(words: Words<'a>) -> Self {
        Self { words }
    }

    /// The text from here on.
    pub(super) fn rest(&self) -> &'a [u8] {
        self.words.rest()
    }

    /// Moves on to the first word of the next row.
    #[inline]
    pub(super) fn start(&mut self) {
        self.words.start_row();
    }

    /// Moves on to the end of the row.
    #[inline]
    pub(super) fn end(&mut self) {
        self.words.end_row();
    }

    /// The next value.
    #[inline]
    pub(super) fn number(&mut self, property: usize) -> Result<f64, Fault> {
        if let Some(value) = self.words.next_number(scan_f64) {
            return Ok(value);
        }
        self.odd_word(property, parse_f64)
    }

    /// The next value as an integer.
    #[inline]
    pub(super) fn integer(&mut self, property: usize) -> Result<i64, Fault> {
        if let Some(value) = self.words.next_number(scan_i64) {
            return Ok(value);
        }
        self.odd_word(property, parse_i64)
    }

    /// The length at the start of a list.
    #[inline]
    pub(super) fn list_length(&mut self, property: usize) -> Result<u32, Fault> {
        let found = self.integer(property)?;
        // Short lists run into the line's end when their length is wrong; a long one would look far for it.
        if (0..=4).contains(&found) {
            return Ok(found as u32);
        }
        // Each item takes a word, and a word a byte and a blank.
        let most = self.words.left_in_row() as u64 / 2 + 1;
        u32::try_from(found)
            .ok()
            .filter(|length| u64::from(*length) <= most)
            .ok_or(Fault::ListLength { property, found })
    }

    /// The values of a property: one, or those of a list.
    pub(super) fn values(
        &mut self,
        property: usize,
        kind: PropertyKind,
    ) -> Result<Vec<f64>, Fault> {
        let length = match kind {
            PropertyKind::Scalar(_) => 1,
            PropertyKind::List { .. } => self.list_length(property)?,
        };
        (0..length).map(|_| self.number(property)).collect()
    }

    /// Passes over a property; how many values it had.
    #[inline]
    pub(super) fn skip(&mut self, property: usize, kind: PropertyKind) -> Result<u32, Fault> {
        let length = match kind {
            PropertyKind::Scalar(_) => 1,
            PropertyKind::List { .. } => self.list_length(property)?,
        };
        for _ in 0..length {
            self.words.next().ok_or(Fault::Short { property })?;
        }
        Ok(length)
    }

    /// The next word by the slower way.
    #[cold]
    fn odd_word<T>(
        &mut self,
        property: usize,
        parse: impl Fn(&[u8]) -> Option<T>,
    ) -> Result<T, Fault> {
        let word = self.words.next().ok_or(Fault::Short { property })?;
        parse(word).ok_or_else(|| Fault::Number {
            property,
            found: excerpt(word),
        })
    }
}

impl Fault {
    /// The error that names `row` (from 1) of `element` and its line in the file.
    pub(super) fn into_error(self, element: &Element, row: u64, line: u64) -> PlyError {
        let name_of = |property: usize| {
            element
                .properties
                .get(property)
                .map_or(String::new(), |property| property.name.clone())
        };
        let (place, element) = (Place::Line(line), element.name.clone());
        match self {
            Self::Short { property } => PlyError::ShortLine {
                place,
                element,
                row,
                property: name_of(property),
            },
            Self::Number { property, found } => PlyError::Number {
                place,
                element,
                row,
                property: name_of(property),
                found,
            },
            Self::ListLength { property, found } => PlyError::ListLength {
                place,
                element,
                row,
                property: name_of(property),
                found,
            },
        }
    }
}
