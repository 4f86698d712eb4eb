//! What is wrong in a TOML text, and where.

use std::fmt;

/// The first thing wrong in a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Flaw {
    /// Line, from 1; `None` if it is nowhere in particular.
    pub(crate) place: Option<Place>,
    /// What was expected and found.
    pub(crate) message: String,
}

/// A place in a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Place {
    /// From 1.
    pub(crate) line: usize,
    /// From 1, in characters.
    pub(crate) column: usize,
    /// What the line says.
    pub(crate) text: String,
}

/// The longest part of a line that a message quotes, characters.
const MOST_QUOTED: usize = 60;

impl Flaw {
    /// The flaw that the parser found in `text`.
    pub(crate) fn of(error: &toml::de::Error, text: &str) -> Self {
        Self {
            place: error.span().map(|span| Place::of(text, span.start)),
            message: error.message().replace('\n', ", "),
        }
    }

    /// Bytes as text.
    ///
    /// # Errors
    /// The flaw, if they are no UTF-8.
    pub(crate) fn text_of(bytes: &[u8]) -> Result<&str, Self> {
        std::str::from_utf8(bytes).map_err(|error| {
            let valid = &bytes[..error.valid_up_to()];
            let text = std::str::from_utf8(valid).unwrap_or_default();
            Self {
                place: Some(Place::of(text, text.len())),
                message: format!(
                    "expected text in UTF-8, found the byte {:#04x}",
                    bytes.get(valid.len()).copied().unwrap_or_default()
                ),
            }
        })
    }
}

impl Place {
    fn of(text: &str, byte: usize) -> Self {
        let before = text.get(..byte).unwrap_or(text);
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let line = text[line_start..].lines().next().unwrap_or_default().trim();
        let is_long = line.chars().count() > MOST_QUOTED;
        let mut quoted: String = line.chars().take(MOST_QUOTED).collect();
        if is_long {
            quoted.push('…');
        }
        Self {
            line: before.matches('\n').count() + 1,
            column: before[line_start..].chars().count() + 1,
            text: quoted,
        }
    }
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { place, message } = self;
        let Some(Place { line, column, text }) = place else {
            return f.write_str(message);
        };
        write!(f, "line {line}, column {column}: {message}")?;
        if !text.is_empty() {
            write!(f, " (the line reads '{text}')")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flaw_is_told_with_line_column_and_text() {
        let text = "a = 1\nbé = = 2\n";
        let error = toml::from_str::<toml::Table>(text).expect_err("two equals signs");
        let flaw = Flaw::of(&error, text);
        let place = flaw.place.clone().expect("a place");
        assert_eq!(place.line, 2, "{flaw}");
        assert!(flaw.to_string().contains("'bé = = 2'"), "{flaw}");
    }

    #[test]
    fn what_is_no_text_is_placed_too() {
        let flaw = Flaw::text_of(b"a = 1\nb\xff").expect_err("no UTF-8");
        let place = flaw.place.clone().expect("a place");
        assert_eq!((place.line, place.column), (2, 2), "{flaw}");
        assert!(flaw.to_string().contains("0xff"), "{flaw}");
    }
}
