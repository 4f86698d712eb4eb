//! OFF, the object file format of Geomview, as text.
//!
//! The first word says what a vertex has: `ST` texture coordinates, `C` a colour, `N` a normal, before `OFF`. Four
//! coordinates (`4OFF`), other dimensions (`nOFF`) and binary files are refused.
//!
//! Where vertices have no colour, they take the mean of those of their faces (three or four numbers behind the corners, 0 to 255,
//! or to 1 where no face has a larger one), in linear light and weighted by area. A single number behind the corners names a colour
//! of a map that no file holds.

use std::ops::Range;

use pointstage_plugin_api::lines::{Line, Lines, excerpt};
use pointstage_plugin_api::loading::{Claim, FileStart, Loader, Output, SourceFile};
use pointstage_plugin_api::pieces::{Fault, Text};
use pointstage_plugin_api::{Error, Host, Progress, Result, Settings};
use pointstage_texels::linear;

use crate::columns::Mesh;

/// The loader of OFF files.
pub struct OffLoader;

/// What the first word says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Kind {
    has_uv: bool,
    has_colour: bool,
    has_normal: bool,
    /// Homogeneous, or of another dimension.
    is_other: bool,
}

impl Kind {
    fn of(word: &[u8]) -> Option<Self> {
        let mut rest = word.strip_suffix(b"OFF")?;
        let mut take = |prefix: &[u8]| {
            let stripped = rest.strip_prefix(prefix);
            rest = stripped.unwrap_or(rest);
            stripped.is_some()
        };
        let has_uv = take(b"ST");
        let (has_colour, has_normal) = (take(b"C"), take(b"N"));
        let is_other = take(b"4") | take(b"n");
        rest.is_empty().then_some(Self {
            has_uv,
            has_colour,
            has_normal,
            is_other,
        })
    }
}

impl Loader for OffLoader {
    fn claims(start: &FileStart<'_>) -> Claim {
        let first = first_word(start.bytes);
        match first.and_then(Kind::of) {
            Some(_) => Claim::Certain,
            None => Claim::No,
        }
    }

    fn load(
        host: &Host,
        file: &SourceFile<'_>,
        _settings: Settings<'_>,
        out: &mut Output<'_>,
        progress: &Progress<'_>,
    ) -> Result<()> {
        let mut lines = Filled::new(Lines::new(file.bytes));
        let (kind, counts) = header(&mut lines, file.bytes)?;
        let body = Body {
            file: file.bytes,
            lines: lines.lines,
            host,
            progress,
        };
        body.read(kind, counts, out)?.write(out, progress)
    }
}

fn first_word(text: &[u8]) -> Option<&[u8]> {
    Lines::new(text)
        .filter_map(|line| line.words().next())
        .find(|word| !word.starts_with(b"#"))
}

/// Lines that hold something, without comments.
struct Filled<'a> {
    lines: Lines<'a>,
    /// The rest of a line of which the first word has been read.
    held: Option<Line<'a>>,
}

impl<'a> Filled<'a> {
    fn new(lines: Lines<'a>) -> Self {
        Self { lines, held: None }
    }
}

impl<'a> Iterator for Filled<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        if let Some(line) = self.held.take() {
            return Some(line);
        }
        for line in self.lines.by_ref() {
            let end = memchr::memchr(b'#', line.text);
            let text = &line.text[..end.unwrap_or(line.text.len())];
            if !text.trim_ascii_start().is_empty() {
                return Some(Line { text, ..line });
            }
        }
        None
    }
}

fn ended(last: u64, what: &str, row: u64, rows: u64) -> Error {
    Error::failed(format!(
        "line {last}: expected {what} {row} of {rows}, found the end of the file; the file is truncated, copy it again"
    ))
}

/// The kind, and the numbers of vertices and faces.
fn header(lines: &mut Filled<'_>, file: &[u8]) -> Result<(Kind, [u64; 2])> {
    let not_off = |found: &[u8]| {
        Error::failed(format!(
            "line 1: expected 'OFF' with what it may be prefixed with, found '{}'; this is not an OFF file",
            excerpt(found)
        ))
    };
    let line = lines.next().ok_or_else(|| not_off(file))?;
    let word = line.words().next().unwrap_or_default();
    let kind = Kind::of(word).ok_or_else(|| not_off(line.text))?;
    if kind.is_other {
        return Err(Error::failed(format!(
            "line {}: '{}' has vertices that are not of three coordinates, which are not read; convert the file to OFF",
            line.number,
            word.escape_ascii()
        )));
    }
    // The counts may stand on the same line.
    let text = line.text.trim_ascii_start();
    let rest = text.get(word.len()..).unwrap_or_default();
    if rest.trim_ascii().starts_with(b"BINARY") {
        return Err(Error::failed(format!(
            "line {}: binary OFF is not read; convert the file to text, or to PLY",
            line.number
        )));
    }
    if !rest.trim_ascii().is_empty() {
        lines.held = Some(Line { text: rest, ..line });
    }
    let line = lines.next();
    let line = line.ok_or_else(|| ended(lines.lines.number(), "the line of counts", 1, 1))?;
    let mut words = line.words();
    let mut count = || words.integer().and_then(|value| u64::try_from(value).ok());
    match (count(), count()) {
        (Some(vertices), Some(faces)) => Ok((kind, [vertices, faces])),
        _ => Err(Error::failed(format!(
            "line {}: expected the numbers of vertices, faces and edges, found '{}'; the file is damaged, export it again",
            line.number,
            line.excerpt()
        ))),
    }
}

/// What follows the header.
struct Body<'b> {
    file: &'b [u8],
    /// Behind the header.
    lines: Lines<'b>,
    host: &'b Host,
    progress: &'b Progress<'b>,
}

impl<'b> Body<'b> {
    fn read(
        &self,
        kind: Kind,
        [vertex_count, face_count]: [u64; 2],
        out: &mut Output<'_>,
    ) -> Result<Mesh> {
        if vertex_count == 0 {
            return Err(Error::failed(
                "the file has 0 vertices; there is nothing to show",
            ));
        }
        let counted = self.counted()?;
        let found: u64 = counted.iter().map(|(_, count)| count).sum();
        let [vertices, faces] = [vertex_count, vertex_count.saturating_add(face_count)]
            .map(|rows| self.end_of_row(rows, &counted));
        let mut mesh = Mesh::default();
        self.text(self.lines.position(), vertices, 0.1..0.5).read(
            self.host,
            self.progress,
            |lines| read_vertices(lines, kind),
            |piece| {
                mesh.append(&piece);
                Ok(())
            },
        )?;
        if found < vertex_count {
            return Err(self.ended("vertex", found, vertex_count));
        }
        let mut colours = FaceColours::default();
        self.text(vertices, faces, 0.5..1.0).read(
            self.host,
            self.progress,
            read_faces,
            |(piece, piece_colours)| {
                colours.append(&piece_colours, mesh.lengths.len());
                mesh.append(&piece);
                Ok(())
            },
        )?;
        if found - vertex_count < face_count {
            return Err(self.ended("face", found - vertex_count, face_count));
        }
        colours.give(kind, &mut mesh, out);
        Ok(mesh)
    }

    /// Byte where each piece of the body ends, and its rows.
    fn counted(&self) -> Result<Vec<(usize, u64)>> {
        let mut end = self.lines.position();
        let mut counted = Vec::new();
        let text = Text::new(self.lines.clone(), "counting lines").with_part(0.0..0.1);
        let count = |lines: Lines<'b>| {
            let mut filled = Filled::new(lines);
            let count = filled.by_ref().count() as u64;
            Ok((filled.lines.position(), count))
        };
        text.read(self.host, self.progress, count, |(bytes, count)| {
            end += bytes;
            counted.push((end, count));
            Ok(())
        })?;
        Ok(counted)
    }

    /// Byte behind the first `rows` rows, or the end of the file.
    fn end_of_row(&self, rows: u64, counted: &[(usize, u64)]) -> usize {
        let (mut start, mut before) = (self.lines.position(), 0);
        for &(end, count) in counted {
            if before + count >= rows {
                let mut filled = Filled::new(Lines::new(&self.file[start..end]));
                for _ in before..rows {
                    filled.next();
                }
                return start + filled.lines.position();
            }
            (start, before) = (end, before + count);
        }
        self.file.len()
    }

    /// Lines between two bytes.
    fn text(&self, start: usize, end: usize, part: Range<f32>) -> Text<'b> {
        Text::new(self.lines.clone().until(end), "reading lines")
            .from_byte(start)
            .with_part(part)
    }

    fn ended(&self, what: &str, found: u64, rows: u64) -> Error {
        ended(Lines::new(self.file).count() as u64, what, found + 1, rows)
    }
}

fn fault(line: &Line<'_>, what: &str, expected: &str) -> Fault {
    let found = line.excerpt();
    Fault::new(
        line,
        format!(
            "expected {expected} of {what}, found '{found}'; correct that line or export the file again"
        ),
    )
}

fn read_vertices(lines: Lines<'_>, kind: Kind) -> Result<Mesh, Fault> {
    let least = 3 + 3 * usize::from(kind.has_normal) + 3 * usize::from(kind.has_colour);
    let least = least + 2 * usize::from(kind.has_uv);
    let mut mesh = Mesh::default();
    let mut values: Vec<f64> = Vec::new();
    for line in Filled::new(lines) {
        values.clear();
        let mut words = line.words();
        values.extend(std::iter::from_fn(|| words.number()));
        if values.len() < least {
            return Err(fault(&line, "a vertex", &format!("{least} numbers")));
        }
        mesh.positions.push([values[0], values[1], values[2]]);
        let mut rest = &values[3..];
        if kind.has_normal {
            let [x, y, z] = [rest[0], rest[1], rest[2]];
            mesh.normals.push([x, y, z].map(|value| value as f32));
            rest = &rest[3..];
        }
        if kind.has_colour {
            mesh.colours
                .push([rest[0], rest[1], rest[2]].map(|value| value as f32));
        }
        if kind.has_uv {
            let [u, v] = [values[values.len() - 2], values[values.len() - 1]];
            mesh.uvs.push([u as f32, v as f32]);
        }
    }
    Ok(mesh)
}

fn read_faces(lines: Lines<'_>) -> Result<(Mesh, FaceColours), Fault> {
    let mut mesh = Mesh::default();
    let mut colours = FaceColours::default();
    for line in Filled::new(lines) {
        let mut words = line.words();
        let length = words.integer();
        let length = length.and_then(|length| u32::try_from(length).ok());
        let length = length.ok_or_else(|| fault(&line, "a face", "the number of corners"))?;
        for _ in 0..length {
            let corner = words.integer().ok_or_else(|| {
                let expected = format!("{length} corners behind their number");
                fault(&line, "a face", &expected)
            })?;
            // What names no vertex is dropped by the host, and counted.
            mesh.corners.push(u32::try_from(corner).unwrap_or(u32::MAX));
        }
        mesh.lengths.push(length);
        let mut values = [f32::NAN; 4];
        let numbers = std::iter::from_fn(|| words.number());
        let mut count = 0;
        for (value, number) in values.iter_mut().zip(numbers) {
            *value = number as f32;
            count += 1;
        }
        match count {
            0 => {}
            1 | 2 => colours.indexed += 1,
            _ => {
                colours.all.resize(mesh.lengths.len() - 1, None);
                colours.all.push(Some(values));
            }
        }
    }
    Ok((mesh, colours))
}

/// What faces say of their colours.
#[derive(Default)]
struct FaceColours {
    /// Of each face as the file has it, NaN for an alpha that is not given; empty while none has one, and missing at the end where
    /// the last have none.
    all: Vec<Option<[f32; 4]>>,
    /// Faces with the number of a colour.
    indexed: u64,
}

impl FaceColours {
    /// Adds those of faces that follow `before` others.
    fn append(&mut self, piece: &Self, before: usize) {
        self.indexed += piece.indexed;
        if !piece.all.is_empty() {
            self.all.resize(before, None);
            self.all.extend(&piece.all);
        }
    }

    /// Gives them to the vertices, if these have none.
    fn give(self, kind: Kind, mesh: &mut Mesh, out: &mut Output<'_>) {
        out.warn(
            "a face has a colour by its number in a map, which is left out",
            self.indexed,
        );
        let coloured = self.all.iter().flatten().count();
        if kind.has_colour {
            out.warn(
                "a face has a colour of its own, which is left out, since vertices have colours",
                coloured as u64,
            );
        } else if coloured > 0 {
            mesh.take_face_colours(&as_light(self.all));
        }
    }
}

/// Linear colours of faces from those of the file; an alpha that is not given is NaN.
fn as_light(mut colours: Vec<Option<[f32; 4]>>) -> Vec<Option<[f32; 4]>> {
    let all = colours.iter().flatten().flatten();
    let largest = all.fold(0.0_f32, |largest, value| largest.max(*value));
    // A little above 1 is a rounding of 1.
    let scale = if largest > 1.5 { 255.0 } else { 1.0 };
    for colour in colours.iter_mut().flatten() {
        let [red, green, blue, alpha] = colour.map(|value| (value / scale).clamp(0.0, 1.0));
        let alpha = if alpha.is_nan() { 1.0 } else { alpha };
        *colour = [linear(red), linear(green), linear(blue), alpha];
    }
    colours
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_of_faces_are_bytes_or_parts_of_one() {
        let white = Some([1.0; 4]);
        let of = |colour: [f32; 4]| as_light(vec![Some(colour), None]);
        assert_eq!(of([255.0, 255.0, 255.0, f32::NAN]), [white, None]);
        assert_eq!(of([1.0, 1.0, 1.0, 1.0]), [white, None]);
        assert_eq!(
            of([0.0, 255.0, 0.0, 0.0]),
            [Some([0.0, 1.0, 0.0, 0.0]), None]
        );
    }

    #[test]
    fn the_first_word_says_what_a_vertex_has() {
        let kind = |word: &str| {
            Kind::of(word.as_bytes())
                .map(|kind| (kind.has_uv, kind.has_colour, kind.has_normal, kind.is_other))
        };
        assert_eq!(kind("OFF"), Some((false, false, false, false)));
        assert_eq!(kind("STCNOFF"), Some((true, true, true, false)));
        assert_eq!(kind("4OFF"), Some((false, false, false, true)));
        assert_eq!(kind("COFFEE"), None);
        assert_eq!(kind("XOFF"), None);
    }
}
