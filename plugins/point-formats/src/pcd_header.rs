//! Headers of PCD files, version 0.7 and before.

use pointstage_plugin_api::lines::{Line, Lines, integer};
use pointstage_plugin_api::{Error, Result};

/// How the points stand behind the header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Body {
    Text,
    /// Point by point.
    Binary,
    /// Field by field, compressed.
    Compressed,
}

/// Type of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Signed,
    Unsigned,
    Float,
}

/// One field of a point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Field {
    pub(crate) name: String,
    pub(crate) kind: Kind,
    /// Bytes of one value: 1, 2, 4 or 8.
    pub(crate) size: usize,
    /// Values a point.
    pub(crate) count: usize,
}

/// A header.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Header {
    pub(crate) fields: Vec<Field>,
    pub(crate) points: u64,
    pub(crate) body: Body,
    /// Byte where the body begins.
    pub(crate) body_start: usize,
    /// Line where the body begins.
    pub(crate) body_line: u64,
}

/// Values a point that are taken for possible.
const MOST_VALUES: usize = 4096;

impl Header {
    pub(crate) fn parse(file: &[u8]) -> Result<Self> {
        let mut lines = Lines::new(file);
        let (mut names, mut sizes, mut kinds, mut counts) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let (mut width, mut height, mut points) = (None, 1, None);
        let mut last = 1;
        while let Some(line) = lines.next() {
            last = line.number;
            let mut words = line.words();
            let Some(keyword) = words.next() else {
                continue;
            };
            let whole = |words: &mut dyn Iterator<Item = &[u8]>| {
                let value = words.next().and_then(integer);
                let value = value.and_then(|value| u64::try_from(value).ok());
                value.ok_or_else(|| fail(&line, "a whole number"))
            };
            match keyword {
                b"FIELDS" | b"COLUMNS" => {
                    names = words
                        .map(|word| String::from_utf8_lossy(word).into_owned())
                        .collect();
                }
                b"SIZE" => {
                    let size = |word| match integer(word) {
                        Some(size @ (1 | 2 | 4 | 8)) => Ok(size as usize),
                        _ => Err(fail(&line, "sizes of 1, 2, 4 or 8")),
                    };
                    sizes = words.map(size).collect::<Result<_>>()?;
                }
                b"TYPE" => {
                    let kind = |word: &[u8]| match word {
                        b"I" => Ok(Kind::Signed),
                        b"U" => Ok(Kind::Unsigned),
                        b"F" => Ok(Kind::Float),
                        _ => Err(fail(&line, "types I, U or F")),
                    };
                    kinds = words.map(kind).collect::<Result<_>>()?;
                }
                b"COUNT" => {
                    let count =
                        |word| match integer(word).and_then(|count| usize::try_from(count).ok()) {
                            Some(count) if count <= MOST_VALUES => Ok(count),
                            _ => Err(fail(&line, "counts from 0 to 4096")),
                        };
                    counts = words.map(count).collect::<Result<_>>()?;
                }
                b"WIDTH" => width = Some(whole(&mut words)?),
                b"HEIGHT" => height = whole(&mut words)?,
                b"POINTS" => points = Some(whole(&mut words)?),
                b"DATA" => {
                    let body = match words.next() {
                        Some(b"ascii") => Body::Text,
                        Some(b"binary") => Body::Binary,
                        Some(b"binary_compressed") => Body::Compressed,
                        _ => return Err(fail(&line, "'ascii', 'binary' or 'binary_compressed'")),
                    };
                    let fields = fields(&line, names, &sizes, &kinds, &counts)?;
                    let product = width.and_then(|width: u64| width.checked_mul(height));
                    let points = points
                        .or(product)
                        .ok_or_else(|| fail(&line, "POINTS, or WIDTH and HEIGHT, before it"))?;
                    return Ok(Self {
                        fields,
                        points,
                        body,
                        body_start: lines.position(),
                        body_line: line.number + 1,
                    });
                }
                b"VERSION" | b"VIEWPOINT" => {}
                other if other.starts_with(b"#") => {}
                _ => return Err(fail(&line, "a word of a PCD header")),
            }
        }
        Err(Error::failed(format!(
            "line {last}: expected 'DATA' at the end of the header, found the end of the file after {} bytes; the file is truncated, copy it again",
            file.len()
        )))
    }

    /// Bytes of a point in a binary body.
    pub(crate) fn stride(&self) -> usize {
        self.fields
            .iter()
            .map(|field| field.size * field.count)
            .sum()
    }
}

fn fields(
    line: &Line<'_>,
    names: Vec<String>,
    sizes: &[usize],
    kinds: &[Kind],
    counts: &[usize],
) -> Result<Vec<Field>> {
    let is_whole = sizes.len() == names.len()
        && kinds.len() == names.len()
        && (counts.is_empty() || counts.len() == names.len());
    if names.is_empty() || !is_whole {
        return Err(Error::failed(format!(
            "line {}: the header has {} FIELDS, {} SIZE, {} TYPE and {} COUNT, expected as many of each; the file is damaged, export it again",
            line.number,
            names.len(),
            sizes.len(),
            kinds.len(),
            counts.len()
        )));
    }
    let total: usize = counts.iter().sum();
    if names.len() > MOST_VALUES || total > MOST_VALUES {
        return Err(fail(line, "no more than 4096 values a point"));
    }
    let field = |(index, name): (usize, String)| {
        let (kind, size) = (kinds[index], sizes[index]);
        if kind == Kind::Float && size < 4 {
            return Err(fail(line, "floats of 4 or 8 bytes"));
        }
        Ok(Field {
            name,
            kind,
            size,
            count: counts.get(index).copied().unwrap_or(1),
        })
    };
    names.into_iter().enumerate().map(field).collect()
}

fn fail(line: &Line<'_>, expected: &str) -> Error {
    Error::failed(format!(
        "line {}: expected {expected}, found '{}'; the header is damaged, export the file again",
        line.number,
        line.excerpt()
    ))
}
