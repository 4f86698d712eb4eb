//! STL, binary and text. A facet names no vertices, so corners at one place become one vertex; the facets' normals are
//! left to the host, which computes smooth ones from the faces.
//!
//! Two conventions keep a colour in the two bytes behind a binary facet, five bits a component. That of Magics is taken where the
//! header has `COLOR=`, with the colour of facets that have none of their own, which set bit 15; red is in the lowest bits. Else that of
//! VisCAM and SolidView: bit 15 says that there is a colour, and blue is in the lowest bits. A vertex takes the mean of its facets'
//! colours, in linear light and weighted by area.

use pointstage_plugin_api::lines::{Line, Lines, number};
use pointstage_plugin_api::loading::{
    Claim, Column, FileStart, Loader, Output, SourceFile, bytes_of,
};
use pointstage_plugin_api::pieces::{Fault, Text, in_order};
use pointstage_plugin_api::{Error, Host, Progress, Result, Settings};
use pointstage_texels::{linear, linear_of};

use crate::columns::Mesh;
use crate::weld::Welder;

/// Bytes before the facets of a binary file: a text, and their number.
const HEADER: usize = 84;
/// Bytes of a facet: a normal, three corners, and two bytes that every program uses as it likes.
const FACET: usize = 50;
/// Facets read by one thread at a time: the table of their vertices stays in its second-level cache.
const FACETS_A_PIECE: usize = 1 << 14;

/// Vertices that indices can name, with room for those of one more piece.
const MOST_VERTICES: usize = (u32::MAX / 2) as usize;

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
        host: &Host,
        file: &SourceFile<'_>,
        _settings: Settings<'_>,
        out: &mut Output<'_>,
        progress: &Progress<'_>,
    ) -> Result<()> {
        let whole = if is_binary(file.bytes, file.bytes.len() as u64) || !is_text(file.bytes) {
            read_binary(file.bytes, host, out, progress)?
        } else {
            read_text(file.bytes, host, progress)?
        };
        if whole.triangles.is_empty() {
            return Err(Error::failed(
                "the file has no facets; there is nothing to show",
            ));
        }
        whole.write(out, progress)
    }
}

/// Some facets, with the vertices that they share.
struct Facets {
    welder: Welder,
    triangles: Vec<[u32; 3]>,
    /// Colour of each facet, linear; empty while none has one, and missing at the end where the last have none.
    colours: Vec<Option<[f32; 4]>>,
}

impl Facets {
    /// Room for so many.
    fn with_room(facets: usize) -> Self {
        Self {
            // Of a closed surface there are half as many vertices.
            welder: Welder::new(facets / 2 + 1),
            triangles: Vec::with_capacity(facets),
            colours: Vec::new(),
        }
    }

    #[inline]
    fn add(&mut self, corners: [[f32; 3]; 3]) {
        let triangle = corners.map(|corner| self.welder.add(corner));
        self.triangles.push(triangle);
    }

    /// Gives the last facet a colour.
    fn colour_last(&mut self, colour: [f32; 4]) {
        self.colours.resize(self.triangles.len() - 1, None);
        self.colours.push(Some(colour));
    }

    /// Adds those that follow.
    fn append(&mut self, piece: &Self) -> Result<()> {
        let vertices = self.welder.add_all(&piece.welder);
        if self.welder.len() > MOST_VERTICES {
            return Err("the file has more vertices than an index can name; split it".into());
        }
        if !piece.colours.is_empty() {
            self.colours.resize(self.triangles.len(), None);
            self.colours.extend(&piece.colours);
        }
        let named = |corners: &[u32; 3]| corners.map(|corner| vertices[corner as usize]);
        self.triangles.extend(piece.triangles.iter().map(named));
        Ok(())
    }

    /// Hands everything over.
    fn write(self, out: &mut Output<'_>, progress: &Progress<'_>) -> Result<()> {
        let positions = self.welder.into_positions();
        if !self.colours.is_empty() {
            let mut mesh = Mesh {
                positions: positions.iter().map(|place| place.map(f64::from)).collect(),
                lengths: vec![3; self.triangles.len()],
                corners: self.triangles.into_flattened(),
                ..Mesh::default()
            };
            mesh.take_face_colours(&self.colours);
            return mesh.write(out, progress);
        }
        out.columns(&[Column::POSITION_F32], positions.len() as u64)?;
        for run in positions.chunks(1 << 16) {
            progress.check()?;
            out.rows(run.len(), &[bytes_of(run)])?;
        }
        out.triangles(&self.triangles)
    }
}

fn read_binary(
    file: &[u8],
    host: &Host,
    out: &mut Output<'_>,
    progress: &Progress<'_>,
) -> Result<Facets> {
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
    let mut whole = Facets::with_room(facets.len());
    let mut attributed = 0;
    in_order(
        host.thread_count(),
        facets.chunks(FACETS_A_PIECE),
        |some| read_facets(some, convention),
        |some, (piece, count)| {
            progress.check()?;
            whole.append(&piece)?;
            attributed += count;
            let done = (whole.triangles.len() + some.len()) as f64 / facets.len() as f64;
            progress.set(done as f32, "reading facets");
            Ok(())
        },
    )?;
    let rest = body.len() as u64 - count * FACET as u64;
    out.warn("a byte behind the last facet is ignored", rest);
    out.warn(
        "a facet has attribute bytes that are no colour, as bit 15 is not set: they are left out",
        attributed,
    );
    Ok(whole)
}

/// Binary facets, and how many have attribute bytes that are no colour.
fn read_facets(facets: &[[u8; FACET]], convention: Convention) -> (Facets, u64) {
    let mut read = Facets::with_room(facets.len());
    let mut attributed = 0;
    for facet in facets {
        let value = |index: usize| {
            let bytes = facet[12 + 4 * index..].first_chunk();
            bytes.map_or(f32::NAN, |bytes| f32::from_le_bytes(*bytes))
        };
        let corner = |index: usize| [value(3 * index), value(3 * index + 1), value(3 * index + 2)];
        read.add([corner(0), corner(1), corner(2)]);
        let word = u16::from_le_bytes([facet[48], facet[49]]);
        match convention.colour(word) {
            Some(colour) => read.colour_last(colour),
            None => attributed += u64::from(word != 0),
        }
    }
    (read, attributed)
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

fn read_text(file: &[u8], host: &Host, progress: &Progress<'_>) -> Result<Facets> {
    let text = Text::new(Lines::new(file), "reading facets").with_begin(|text, start| {
        // However much space a file has, little of it is looked at.
        let line = &text[start..text.len().min(start + 64)];
        let word = line.trim_ascii_start().get(..5);
        word.is_some_and(|word| word.eq_ignore_ascii_case(b"facet"))
    });
    let (mut whole, mut is_ended) = (Facets::with_room(0), false);
    text.read(host, progress, read_text_piece, |(facets, ends)| {
        is_ended = ends.unwrap_or(is_ended);
        whole.append(&facets)
    })?;
    if is_ended {
        return Ok(whole);
    }
    let last = Lines::new(file).filter(|line| line.words().next().is_some());
    let last = last.last().unwrap_or(Line {
        number: 1,
        text: b"",
    });
    Err(Error::failed(format!(
        "line {}: {}",
        last.number,
        not_stl(&last, "'endsolid' in the end")
    )))
}

fn not_stl(line: &Line<'_>, expected: &str) -> String {
    format!(
        "expected {expected}, found '{}'; the file is damaged or truncated, export it again",
        line.excerpt()
    )
}

/// The facets of whole lines, and whether a solid ended in them, or else began.
fn read_text_piece(lines: Lines<'_>) -> Result<(Facets, Option<bool>), Fault> {
    let fail = |line: &Line<'_>, expected: &str| Fault::new(line, not_stl(line, expected));
    let open = |line: &Line<'_>| fail(line, "'endloop' behind the vertices of a facet");
    let mut facets = Facets::with_room(0);
    let mut corners: Vec<[f32; 3]> = Vec::new();
    let mut last = None;
    let mut is_ended = None;
    for line in lines {
        let mut words = line.words();
        let Some(word) = words.next() else { continue };
        let is = |name: &[u8]| word.eq_ignore_ascii_case(name);
        if is(b"vertex") {
            let mut value = || words.next().and_then(number).map(|value| value as f32);
            let (Some(x), Some(y), Some(z)) = (value(), value(), value()) else {
                return Err(fail(&line, "three numbers behind 'vertex'"));
            };
            corners.push([x, y, z]);
        } else if is(b"endloop") || is(b"endfacet") {
            if !corners.is_empty() {
                let [a, b, c] = corners[..] else {
                    return Err(fail(&line, "three vertices before the end of a facet"));
                };
                facets.add([a, b, c]);
                corners.clear();
            }
        } else if is(b"facet") {
            // A piece may end before it.
            if let Some(last) = last.filter(|_| !corners.is_empty()) {
                return Err(open(&last));
            }
        } else if is(b"endsolid") || is(b"solid") {
            is_ended = Some(is(b"endsolid"));
        } else if !is(b"outer") && !is(b"color") {
            return Err(fail(&line, "'facet', 'vertex' or another word of STL"));
        }
        last = Some(line);
    }
    match last.filter(|_| !corners.is_empty()) {
        Some(last) => Err(open(&last)),
        None => Ok((facets, is_ended)),
    }
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
