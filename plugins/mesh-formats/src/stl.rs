//! STL, binary and text. A facet names no vertices, so corners at one place become one vertex; the facets' normals are
//! left to the host, which computes smooth ones from the faces.
//!
//! Two conventions keep a colour in the two bytes behind a binary facet, five bits a component. That of Magics is taken where the
//! header has `COLOR=`, with the colour of facets that have none of their own, which set bit 15; red is in the lowest bits. Else that of
//! VisCAM and SolidView: bit 15 says that there is a colour, and blue is in the lowest bits. A vertex takes the mean of its facets'
//! colours, in linear light and weighted by area.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use pointstage_plugin_api::lines::{Line, Lines, number};
use pointstage_plugin_api::loading::{Claim, FileStart, Loader, Output, SourceFile};
use pointstage_plugin_api::{Error, Host, Progress, Result, Settings};
use pointstage_texels::{linear, linear_of};

use crate::columns::Mesh;

/// Bytes before the facets of a binary file: a text, and their number.
const HEADER: usize = 84;
/// Bytes of a facet: a normal, three corners, and two bytes that every program uses as it likes.
const FACET: usize = 50;
/// Facets read between two looks at the cancel flag.
const FACETS_A_PIECE: usize = 1 << 14;

/// The loader of STL files.
pub struct StlLoader;

/// Whether the length is that of a binary file with the number of facets in its header.
fn is_binary(start: &[u8], length: u64) -> bool {
    facet_count(start)
        .is_some_and(|count| count > 0 && length == HEADER as u64 + FACET as u64 * count)
}

/// The number of facets that a binary file's header says.
fn facet_count(start: &[u8]) -> Option<u64> {
    let bytes = start.get(80..)?.first_chunk()?;
    Some(u64::from(u32::from_le_bytes(*bytes)))
}

fn is_text(start: &[u8]) -> bool {
    start.trim_ascii_start().starts_with(b"solid")
}

impl Loader for StlLoader {
    fn claims(start: &FileStart<'_>) -> Claim {
        // Some binary files begin with 'solid' too, so their length is looked at first.
        if is_binary(start.bytes, start.length) {
            return Claim::Certain;
        }
        let has_facet = start.bytes.windows(5).any(|word| word == b"facet");
        match (is_text(start.bytes), has_facet) {
            (true, true) => Claim::Certain,
            (true, false) => Claim::Likely,
            // A binary file that was cut off: its extension decides.
            (false, _) if start.length >= HEADER as u64 => Claim::Possible,
            (false, _) => Claim::No,
        }
    }

    fn load(
        _host: &Host,
        file: &SourceFile<'_>,
        _settings: Settings<'_>,
        out: &mut Output<'_>,
        progress: &Progress<'_>,
    ) -> Result<()> {
        let mut welder = Welder::default();
        if is_binary(file.bytes, file.bytes.len() as u64) || !is_text(file.bytes) {
            read_binary(file.bytes, &mut welder, out, progress)?;
        } else {
            read_text(file.bytes, &mut welder, progress)?;
        }
        if welder.mesh.positions.is_empty() {
            return Err(Error::failed(
                "the file has no facets; there is nothing to show",
            ));
        }
        welder.mesh.write(out, progress)
    }
}

/// Makes one vertex of corners at one place.
#[derive(Default)]
struct Welder {
    mesh: Mesh,
    vertices: HashMap<[u32; 3], u32, BuildHasherDefault<PlaceHasher>>,
}

impl Welder {
    fn add_facet(&mut self, corners: [[f32; 3]; 3]) {
        for corner in corners {
            // 0 and −0 are one place.
            let place = corner.map(|value| (value + 0.0).to_bits());
            let next = self.mesh.positions.len() as u32;
            let positions = &mut self.mesh.positions;
            let vertex = *self.vertices.entry(place).or_insert_with(|| {
                positions.push(corner.map(f64::from));
                next
            });
            self.mesh.corners.push(vertex);
        }
        self.mesh.lengths.push(3);
    }
}

/// Hashes the bits of three floats: a multiplication and a rotation a word, as FxHash does.
#[derive(Default)]
struct PlaceHasher(u64);

impl Hasher for PlaceHasher {
    fn finish(&self) -> u64 {
        // The table takes the upper bits for one thing and the lower for another: mix them.
        self.0 ^ (self.0 >> 32)
    }

    fn write(&mut self, bytes: &[u8]) {
        for chunk in bytes.chunks(4) {
            let mut word = [0; 4];
            word[..chunk.len()].copy_from_slice(chunk);
            self.write_u32(u32::from_le_bytes(word));
        }
    }

    fn write_u32(&mut self, word: u32) {
        self.0 = (self.0.rotate_left(5) ^ u64::from(word)).wrapping_mul(0x517c_c1b7_2722_0a95);
    }

    fn write_usize(&mut self, _length: usize) {
        // All keys have one length.
    }
}

fn read_binary(
    file: &[u8],
    welder: &mut Welder,
    out: &mut Output<'_>,
    progress: &Progress<'_>,
) -> Result<()> {
    let count = facet_count(file).ok_or_else(|| {
        Error::failed(format!(
            "expected {HEADER} bytes before the facets, found a file of {}; the file is truncated, copy it again",
            file.len()
        ))
    })?;
    let body = file.get(HEADER..).unwrap_or_default();
    let there = (body.len() / FACET) as u64;
    if there < count {
        return Err(Error::failed(format!(
            "byte {}: expected {count} facets of {FACET} bytes, found bytes for {there}; the file is truncated, copy it again",
            file.len()
        )));
    }
    let (facets, _) = body.as_chunks::<FACET>();
    let facets = &facets[..count as usize];
    let convention = Convention::of(&file[..80]);
    let mut colours = Vec::with_capacity(facets.len());
    let mut attributed = 0;
    for (piece, some) in facets.chunks(FACETS_A_PIECE).enumerate() {
        progress.check()?;
        let done = (piece * FACETS_A_PIECE) as f64 / facets.len() as f64;
        progress.set(done as f32, "reading facets");
        for facet in some {
            let value = |index: usize| {
                let bytes = facet[12 + 4 * index..].first_chunk();
                bytes.map_or(f32::NAN, |bytes| f32::from_le_bytes(*bytes))
            };
            let corner =
                |index: usize| [value(3 * index), value(3 * index + 1), value(3 * index + 2)];
            welder.add_facet([corner(0), corner(1), corner(2)]);
            let word = u16::from_le_bytes([facet[48], facet[49]]);
            let colour = convention.colour(word);
            attributed += u64::from(word != 0 && colour.is_none());
            colours.push(colour);
        }
    }
    let rest = body.len() as u64 - count * FACET as u64;
    out.warn("a byte behind the last facet is ignored", rest);
    out.warn(
        "a facet has attribute bytes that are no colour, as bit 15 is not set: they are left out",
        attributed,
    );
    if colours.iter().any(Option::is_some) {
        welder.mesh.take_face_colours(&colours);
    }
    Ok(())
}

/// How the two bytes behind a facet are meant.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Convention {
    /// Magics: the colour of facets without one of their own, linear.
    Magics([f32; 4]),
    VisCam,
}

impl Convention {
    fn of(header: &[u8]) -> Self {
        let mark = b"COLOR=";
        let place = header.windows(mark.len()).position(|word| word == mark);
        let colour = place.and_then(|place| header.get(place + mark.len()..)?.first_chunk::<3>());
        colour.map_or(Self::VisCam, |colour| {
            let [red, green, blue] = colour.map(linear_of);
            Self::Magics([red, green, blue, 1.0])
        })
    }

    /// Colour of a facet, linear.
    fn colour(self, word: u16) -> Option<[f32; 4]> {
        let part = |shift: u32| linear(f32::from((word >> shift) & 31) / 31.0);
        let is_marked = word & 0x8000 != 0;
        match self {
            Self::Magics(common) if is_marked => Some(common),
            Self::Magics(_) => Some([part(0), part(5), part(10), 1.0]),
            Self::VisCam => is_marked.then(|| [part(10), part(5), part(0), 1.0]),
        }
    }
}

fn read_text(file: &[u8], welder: &mut Welder, progress: &Progress<'_>) -> Result<()> {
    let fail = |line: &Line<'_>, expected: &str| {
        Error::failed(format!(
            "line {}: expected {expected}, found '{}'; the file is damaged or truncated, export it again",
            line.number,
            line.excerpt()
        ))
    };
    let mut corners: Vec<[f32; 3]> = Vec::new();
    let mut lines = Lines::new(file);
    let mut last = Line {
        number: 1,
        text: b"",
    };
    let mut is_ended = false;
    while let Some(line) = lines.next() {
        if line.number % (1 << 14) == 0 {
            progress.check()?;
            progress.set(lines.fraction(), "reading facets");
        }
        let mut words = line.words();
        let Some(word) = words.next() else { continue };
        last = line;
        match word.to_ascii_lowercase().as_slice() {
            b"vertex" => {
                let mut value = || words.next().and_then(number).map(|value| value as f32);
                let (Some(x), Some(y), Some(z)) = (value(), value(), value()) else {
                    return Err(fail(&line, "three numbers behind 'vertex'"));
                };
                corners.push([x, y, z]);
            }
            b"endloop" | b"endfacet" if !corners.is_empty() => {
                let [a, b, c] = corners[..] else {
                    return Err(fail(&line, "three vertices before the end of a facet"));
                };
                welder.add_facet([a, b, c]);
                corners.clear();
            }
            b"endsolid" => is_ended = true,
            b"solid" => is_ended = false,
            b"facet" | b"outer" | b"endloop" | b"endfacet" | b"color" => {}
            _ => return Err(fail(&line, "'facet', 'vertex' or another word of STL")),
        }
    }
    if !corners.is_empty() || !is_ended {
        return Err(fail(&last, "'endsolid' in the end"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_conventions_give_the_same_red() {
        let red = Some([1.0, 0.0, 0.0, 1.0]);
        let viscam = Convention::of(&[b' '; 80]);
        assert_eq!(viscam.colour(0x8000 | 31 << 10), red);
        assert_eq!(viscam.colour(31 << 10), None);
        let mut header = [b' '; 80];
        header[20..30].copy_from_slice(b"COLOR=\x00\xff\x00\xff");
        let magics = Convention::of(&header);
        assert_eq!(magics.colour(31), red);
        assert_eq!(magics.colour(0x8000), Some([0.0, 1.0, 0.0, 1.0]));
        // A mark at the very end has no colour behind it.
        let mut header = [b' '; 80];
        header[74..].copy_from_slice(b"COLOR=");
        assert_eq!(Convention::of(&header), Convention::VisCam);
    }
}
