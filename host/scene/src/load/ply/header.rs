//! The header: format, elements and their properties.
//!
//! After [`PlyHeader::parse`] every type is known and every list has an integer length; whether the counts are true only
//! the body can tell.

use super::error::{PlyError, excerpt};
use crate::geometry::ScalarType;

/// How the body is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// Header of a PLY file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PlyHeader {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    pub(super) pictures: NamedPictures,
    /// Offset of the body's first byte.
    pub(super) body_start: usize,
    /// Lines of the header, so that messages can count on.
    pub(super) line_count: u64,
    /// What ends a line: `\n`, or `\r` in files of the old Macintosh.
    pub(super) line_end: u8,
}

/// What comments say of pictures.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct NamedPictures {
    /// Their names, in the order of their comments `TextureFile`.
    pub(super) names: Vec<String>,
    /// Fingerprint of those whose colours the vertices have already, of the comment `TextureColours`.
    pub(super) coloured_by: Option<u64>,
}

/// A table of the body.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

/// A column of an element.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: PropertyKind,
}

/// One value a row, or a counted list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum PropertyKind {
    Scalar(ScalarType),
    List {
        length: ScalarType,
        item: ScalarType,
    },
}

impl PropertyKind {
    /// Type of its value, or of a list's values.
    pub(super) const fn scalar(self) -> ScalarType {
        match self {
            Self::Scalar(scalar) | Self::List { item: scalar, .. } => scalar,
        }
    }

    /// Least bytes that a row's value takes.
    pub(super) const fn min_size(self) -> usize {
        match self {
            Self::Scalar(scalar) => scalar.size(),
            Self::List { length, .. } => length.size(),
        }
    }
}

impl Element {
    /// Least bytes of a row of a binary body: all of it if there are no lists.
    pub(super) fn min_row_size(&self) -> usize {
        self.properties
            .iter()
            .map(|property| property.kind.min_size())
            .sum()
    }

    /// True if any property is a list.
    pub(super) fn has_lists(&self) -> bool {
        self.properties
            .iter()
            .any(|property| matches!(property.kind, PropertyKind::List { .. }))
    }

    /// Index of the property called `name`.
    pub(super) fn find(&self, name: &str) -> Option<usize> {
        self.properties
            .iter()
            .position(|property| property.name.eq_ignore_ascii_case(name))
    }
}

impl PlyHeader {
    /// Reads the header at the start of a file.
    pub(super) fn parse(file: &[u8]) -> Result<Self, PlyError> {
        let not_ply = || PlyError::NotPly {
            found: excerpt(
                file.split(|byte| *byte == b'\n' || *byte == b'\r')
                    .next()
                    .unwrap_or(file),
            ),
        };
        let after_magic = file.strip_prefix(b"ply").ok_or_else(not_ply)?;
        let blank = after_magic
            .iter()
            .position(|byte| !matches!(byte, b' ' | b'\t'))
            .ok_or(PlyError::NoEndHeader {
                line: 1,
                bytes: file.len() as u64,
            })?;
        let line_end = match &after_magic[blank..] {
            [b'\n', ..] | [b'\r', b'\n', ..] => b'\n',
            [b'\r', ..] => b'\r',
            _ => return Err(not_ply()),
        };
        let mut lines = Lines {
            file,
            position: 0,
            line_end,
            line: 0,
        };
        lines.next_line()?;
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        let mut pictures = NamedPictures::default();
        loop {
            let text = lines.next_line()?;
            let line = lines.line;
            let error = |expected| PlyError::HeaderLine {
                line,
                expected,
                found: excerpt(text),
            };
            let words: Vec<&str> = match std::str::from_utf8(text) {
                Ok(text) => text.split_ascii_whitespace().collect(),
                // Comments may be in any encoding.
                Err(_)
                    if text.trim_ascii_start().starts_with(b"comment")
                        || text.trim_ascii_start().starts_with(b"obj_info") =>
                {
                    continue;
                }
                Err(_) => return Err(error("text")),
            };
            match words[..] {
                ["end_header"] => break,
                ["comment", "TextureFile", ..] => {
                    // Names may hold blanks.
                    let text = String::from_utf8_lossy(text);
                    let name = text.split_once("TextureFile").map_or("", |(_, name)| name);
                    pictures.names.push(name.trim().to_owned());
                }
                ["comment", "TextureColours", fingerprint] => {
                    pictures.coloured_by = u64::from_str_radix(fingerprint, 16).ok();
                }
                ["comment" | "obj_info", ..] | [] => {}
                ["format", name, _version] => {
                    let known = "format ascii, binary_little_endian or binary_big_endian";
                    encoding = Some(parse_encoding(name).ok_or_else(|| error(known))?);
                }
                ["element", name, count] => {
                    let count = count.parse().map_err(|_| error("a count of 0 or more"))?;
                    elements.push(Element {
                        name: name.to_owned(),
                        count,
                        properties: Vec::new(),
                    });
                }
                ["property", ref rest @ ..] => {
                    let element = elements
                        .last_mut()
                        .ok_or_else(|| error("an element before its properties"))?;
                    element
                        .properties
                        .push(parse_property(rest).map_err(error)?);
                }
                _ => {
                    return Err(error(
                        "format, element, property, comment, obj_info or end_header",
                    ));
                }
            }
        }
        let encoding = encoding.ok_or(PlyError::HeaderLine {
            line: lines.line,
            expected: "a format line before end_header",
            found: "end_header".into(),
        })?;
        Ok(Self {
            encoding,
            elements,
            pictures,
            body_start: lines.position,
            line_count: lines.line,
            line_end,
        })
    }
}

fn parse_encoding(name: &str) -> Option<Encoding> {
    Some(match name {
        "ascii" => Encoding::Ascii,
        "binary_little_endian" => Encoding::LittleEndian,
        "binary_big_endian" => Encoding::BigEndian,
        _ => return None,
    })
}

fn parse_property(words: &[&str]) -> Result<Property, &'static str> {
    const TYPES: &str =
        "a type such as char, uchar, short, ushort, int, uint, float, double, or int8 … float64";
    let (kind, name) = match *words {
        ["list", length, item, name] => {
            let length = parse_type(length).ok_or(TYPES)?;
            if matches!(length, ScalarType::F32 | ScalarType::F64) {
                return Err("an integer type for a list's length");
            }
            (
                PropertyKind::List {
                    length,
                    item: parse_type(item).ok_or(TYPES)?,
                },
                name,
            )
        }
        ["list", ..] => return Err("'property list LENGTH_TYPE ITEM_TYPE NAME'"),
        [scalar, name] => (PropertyKind::Scalar(parse_type(scalar).ok_or(TYPES)?), name),
        _ => return Err("'property TYPE NAME'"),
    };
    Ok(Property {
        name: name.to_owned(),
        kind,
    })
}

fn parse_type(name: &str) -> Option<ScalarType> {
    Some(match name {
        "char" | "int8" => ScalarType::I8,
        "uchar" | "uint8" => ScalarType::U8,
        "short" | "int16" => ScalarType::I16,
        "ushort" | "uint16" => ScalarType::U16,
        "int" | "int32" => ScalarType::I32,
        "uint" | "uint32" => ScalarType::U32,
        "float" | "float32" => ScalarType::F32,
        "double" | "float64" => ScalarType::F64,
        _ => return None,
    })
}

/// The header's lines, one by one.
struct Lines<'a> {
    file: &'a [u8],
    position: usize,
    line_end: u8,
    line: u64,
}

impl<'a> Lines<'a> {
    /// The next line, without what ends it.
    fn next_line(&mut self) -> Result<&'a [u8], PlyError> {
        let rest = &self.file[self.position..];
        self.line += 1;
        let Some(length) = rest.iter().position(|byte| *byte == self.line_end) else {
            // The last line may lack its end when there is no body.
            if rest.trim_ascii() == b"end_header" {
                self.position = self.file.len();
                return Ok(rest.trim_ascii());
            }
            return Err(PlyError::NoEndHeader {
                line: self.line,
                bytes: self.file.len() as u64,
            });
        };
        // Exactly one line end: a body may start with the byte of another.
        self.position += length + 1;
        let line = &rest[..length];
        Ok(line.strip_suffix(b"\r").unwrap_or(line))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error_of(text: &str) -> String {
        PlyHeader::parse(text.as_bytes())
            .expect_err(text)
            .to_string()
    }

    #[test]
    fn all_three_line_ends_give_the_same_elements() {
        let lf = "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float32 x\nproperty list uchar int i\nend_header\n";
        let parsed = PlyHeader::parse(lf.as_bytes()).unwrap();
        assert_eq!(parsed.elements[0].properties.len(), 2);
        assert_eq!(parsed.elements[0].min_row_size(), 5);
        for end in ["\r\n", "\r"] {
            let text = lf.replace('\n', end);
            let other = PlyHeader::parse(text.as_bytes()).unwrap();
            assert_eq!(
                (other.elements, other.body_start),
                (parsed.elements.clone(), text.len()),
                "{end:?}"
            );
        }
    }

    #[test]
    fn a_body_that_starts_with_a_line_end_keeps_it() {
        let file = b"ply\nformat binary_little_endian 1.0\nend_header\n\n\r\n";
        assert_eq!(PlyHeader::parse(file).unwrap().body_start, file.len() - 3);
    }

    #[test]
    fn errors_name_line_expected_and_found() {
        for (text, parts) in [
            ("plx\n", ["line 1", "'ply'", "plx"]),
            (
                "ply\nformat ascii 1.0\nelement vertex -3\n",
                ["line 3", "count", "element vertex -3"],
            ),
            (
                "ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\n",
                ["line 4", "a type such as", "quad"],
            ),
            (
                "ply\nformat ascii 1.0\nproperty float x\n",
                ["line 3", "an element before", "property float x"],
            ),
            (
                "ply\nformat ascii 1.0\nelement f 1\nproperty list float int x\n",
                ["line 4", "integer", "list float"],
            ),
            ("ply\nformat ebcdic 1.0\n", ["line 2", "ascii", "ebcdic"]),
            ("ply\nwhat is this\n", ["line 2", "end_header", "what"]),
            (
                "ply\nformat ascii 1.0\n",
                ["line 3", "end_header", "21 bytes"],
            ),
            ("ply\nend_header\n", ["line 2", "format line", "end_header"]),
        ] {
            let error = error_of(text);
            assert!(
                parts.iter().all(|part| error.contains(part)),
                "{text:?} gave: {error}"
            );
        }
    }
}
