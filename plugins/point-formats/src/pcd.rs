//! PCD, the format of the Point Cloud Library. The viewpoint of its header is the sensor's place, and moves no point.

use std::borrow::Cow;

use pointstage_plugin_api::lines::{Lines, number};
use pointstage_plugin_api::loading::{Claim, FileStart, Loader, Output, SourceFile};
use pointstage_plugin_api::{Error, Host, Progress, Result, Settings};

use crate::columns::{Columns, Kept, Value, run_of};
use crate::lzf;
use crate::pcd_header::{Body, Field, Header, Kind};

/// The loader of PCD files.
pub struct PcdLoader;

impl Loader for PcdLoader {
    fn claims(start: &FileStart<'_>) -> Claim {
        let first = Lines::new(start.bytes).find(|line| {
            let word = line.words().next();
            word.is_some_and(|word| !word.starts_with(b"#"))
        });
        let begins = first.and_then(|line| line.words().next());
        match begins {
            Some(b"VERSION" | b"FIELDS" | b"COLUMNS") => Claim::Certain,
            _ if start.bytes.starts_with(b"# .PCD") => Claim::Certain,
            _ => Claim::No,
        }
    }

    fn load(
        _host: &Host,
        file: &SourceFile<'_>,
        _settings: Settings<'_>,
        out: &mut Output<'_>,
        progress: &Progress<'_>,
    ) -> Result<()> {
        progress.set(0.0, "reading points");
        let header = Header::parse(file.bytes)?;
        if header.points == 0 {
            return Err(Error::failed(
                "the file has 0 points; there is nothing to show",
            ));
        }
        let values: Vec<Value> = header
            .fields
            .iter()
            .flat_map(|field| std::iter::repeat_n(value_of(field), field.count))
            .collect();
        let columns = Columns::new(&values)?;
        columns.declare(out, header.points)?;
        match header.body {
            Body::Text => read_text(file.bytes, &header, values.len(), &columns, out, progress),
            Body::Binary | Body::Compressed => {
                read_binary(file.bytes, &header, &columns, out, progress)
            }
        }
    }
}

fn is_packed_colour(field: &Field) -> bool {
    field.size == 4 && field.count == 1 && matches!(field.name.as_str(), "rgb" | "rgba")
}

fn value_of(field: &Field) -> Value {
    let kept = match (field.kind, field.size) {
        _ if is_packed_colour(field) => Kept::PackedColour,
        (Kind::Float, 4) => Kept::F32,
        (Kind::Unsigned, 1) => Kept::U8,
        (Kind::Unsigned, 2) => Kept::U16,
        (Kind::Unsigned, 4) => Kept::U32,
        (Kind::Signed, 1 | 2 | 4) => Kept::I32,
        // Integers of 64 bits too: exact up to 2⁵³.
        _ => Kept::F64,
    };
    Value {
        name: field.name.clone(),
        kept,
    }
}

fn read_text(
    file: &[u8],
    header: &Header,
    width: usize,
    columns: &Columns,
    out: &mut Output<'_>,
    progress: &Progress<'_>,
) -> Result<()> {
    let kinds: Vec<&Field> = header
        .fields
        .iter()
        .flat_map(|field| std::iter::repeat_n(field, field.count))
        .collect();
    let mut lines = Lines::new(file.get(header.body_start..).unwrap_or_default());
    let run = run_of(width);
    let mut values = Vec::new();
    let (mut read, mut last) = (0, header.body_line);
    while read < header.points {
        let Some(line) = lines.next() else {
            return Err(Error::failed(format!(
                "line {last}: expected point {} of {}, found the end of the file; the file is truncated, copy it again",
                read + 1,
                header.points
            )));
        };
        last = header.body_line + line.number - 1;
        let before = values.len();
        values.extend(line.words().zip(&kinds).map_while(|(word, field)| {
            let value = number(word)?;
            let is_float = is_packed_colour(field) && field.kind == Kind::Float;
            Some(if is_float {
                f64::from((value as f32).to_bits())
            } else {
                value
            })
        }));
        match values.len() - before {
            0 if line.text.trim_ascii().is_empty() => continue,
            found if found == width => read += 1,
            found => {
                return Err(Error::failed(format!(
                    "line {last}: expected {width} numbers, found {found} in '{}'; correct that line or export the file again",
                    line.excerpt()
                )));
            }
        }
        if values.len() == run * width {
            progress.check()?;
            progress.set(lines.fraction(), "reading points");
            columns.write(out, &values)?;
            values.clear();
        }
    }
    columns.write(out, &values)
}

/// Where the values of a field lie.
struct Place {
    kind: Kind,
    size: usize,
    is_colour: bool,
    /// Byte of the first point's value.
    start: usize,
    /// Bytes to the next point's.
    stride: usize,
}

fn read_binary(
    file: &[u8],
    header: &Header,
    columns: &Columns,
    out: &mut Output<'_>,
    progress: &Progress<'_>,
) -> Result<()> {
    let body = body_of(file, header, progress)?;
    let points = header.points as usize;
    let mut places = Vec::new();
    let mut offset = 0;
    for field in &header.fields {
        let whole = field.size * field.count;
        for index in 0..field.count {
            let inside = index * field.size;
            let (start, stride) = match header.body {
                Body::Compressed => (offset * points + inside, whole),
                Body::Binary | Body::Text => (offset + inside, header.stride()),
            };
            places.push(Place {
                kind: field.kind,
                size: field.size,
                is_colour: is_packed_colour(field),
                start,
                stride,
            });
        }
        offset += whole;
    }
    let run = run_of(places.len());
    let mut values = Vec::new();
    for start in (0..points).step_by(run) {
        progress.check()?;
        progress.set((start as f64 / points as f64) as f32, "reading points");
        values.clear();
        for point in start..points.min(start + run) {
            for place in &places {
                let bytes = body
                    .get(place.start + point * place.stride..)
                    .unwrap_or_default();
                values.push(read(place, bytes));
            }
        }
        columns.write(out, &values)?;
    }
    Ok(())
}

/// The bytes of all points, unpacked.
fn body_of<'a>(file: &'a [u8], header: &Header, progress: &Progress<'_>) -> Result<Cow<'a, [u8]>> {
    let body = file.get(header.body_start..).unwrap_or_default();
    let short = |expected: u64, found: usize| {
        Error::failed(format!(
            "byte {}: expected {expected} bytes for {} points, found {found}; the file is truncated, copy it again",
            header.body_start, header.points
        ))
    };
    let expected = header.points.saturating_mul(header.stride() as u64);
    if header.body == Body::Binary {
        if (body.len() as u64) < expected {
            return Err(short(expected, body.len()));
        }
        return Ok(Cow::Borrowed(body));
    }
    let size = |at: usize| {
        let bytes = body.get(at..).and_then(|rest| rest.first_chunk());
        bytes.map(|bytes| u32::from_le_bytes(*bytes) as usize)
    };
    let (Some(packed), Some(unpacked)) = (size(0), size(4)) else {
        return Err(short(8, body.len()));
    };
    if unpacked as u64 != expected {
        return Err(Error::failed(format!(
            "byte {}: expected {expected} bytes for {} points, the compressed body says {unpacked}; the file is damaged, copy it again",
            header.body_start + 4,
            header.points
        )));
    }
    let data = body
        .get(8..)
        .and_then(|rest| rest.get(..packed))
        .ok_or_else(|| short(packed as u64, body.len().saturating_sub(8)))?;
    let unpacked = lzf::unpack(data, unpacked, || !progress.is_cancelled());
    progress.check()?;
    let unpacked = unpacked.ok_or_else(|| {
        Error::failed(format!(
            "byte {}: the compressed body is damaged; copy the file again",
            header.body_start + 8
        ))
    })?;
    Ok(Cow::Owned(unpacked))
}

/// One value, little endian; 0 past the end, which lengths exclude.
fn read(place: &Place, bytes: &[u8]) -> f64 {
    let mut word = [0; 8];
    let Some(own) = bytes.get(..place.size) else {
        return 0.0;
    };
    word[..place.size].copy_from_slice(own);
    let bits = u64::from_le_bytes(word);
    // Moved up, so that the sign is where i64 has it.
    let shift = 64 - 8 * place.size as u32;
    match (place.kind, place.size) {
        _ if place.is_colour => f64::from(bits as u32),
        (Kind::Float, 4) => f64::from(f32::from_bits(bits as u32)),
        (Kind::Float, _) => f64::from_bits(bits),
        (Kind::Unsigned, _) => bits as f64,
        (Kind::Signed, _) => ((bits << shift) as i64 >> shift) as f64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_all_types_are_read() {
        let place = |kind, size| Place {
            kind,
            size,
            is_colour: false,
            start: 0,
            stride: 0,
        };
        assert_eq!(read(&place(Kind::Signed, 2), &[0xfe, 0xff]), -2.0);
        assert_eq!(read(&place(Kind::Unsigned, 2), &[0xfe, 0xff]), 65534.0);
        assert_eq!(read(&place(Kind::Float, 4), &1.5_f32.to_le_bytes()), 1.5);
        assert_eq!(read(&place(Kind::Float, 8), &1.5_f64.to_le_bytes()), 1.5);
        assert_eq!(read(&place(Kind::Signed, 8), &(-7_i64).to_le_bytes()), -7.0);
    }
}
