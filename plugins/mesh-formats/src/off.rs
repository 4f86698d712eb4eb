//! OFF, the object file format of Geomview, as text.
//!
//! The first word says what a vertex has: `ST` texture coordinates, `C` a colour, `N` a normal, before `OFF`. Four
//! coordinates (`4OFF`), other dimensions (`nOFF`) and binary files are refused.
//!
//! Where vertices have no colour, they take the mean of those of their faces (three or four numbers behind the corners, 0 to 255,
//! or to 1 where no face has a larger one), in linear light and weighted by area. A single number behind the corners names a colour
//! of a map that no file holds.

use pointstage_plugin_api::lines::{Line, Lines, excerpt, integer, number};
use pointstage_plugin_api::loading::{Claim, FileStart, Loader, Output, SourceFile};
use pointstage_plugin_api::{Error, Host, Progress, Result, Settings};
use pointstage_texels::linear;

use crate::columns::Mesh;

/// Lines read between two looks at the cancel flag.
const LINES_A_PIECE: u64 = 1 << 14;

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
        _host: &Host,
        file: &SourceFile<'_>,
        _settings: Settings<'_>,
        out: &mut Output<'_>,
        progress: &Progress<'_>,
    ) -> Result<()> {
        let mut lines = Filled {
            lines: Lines::new(file.bytes),
            last: 0,
            held: None,
        };
        let (kind, counts) = header(&mut lines, file.bytes)?;
        let mesh = read(kind, counts, &mut lines, out, progress)?;
        mesh.write(out, progress)
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
    /// Number of the last line.
    last: u64,
    /// The rest of a line of which the first word has been read.
    held: Option<Line<'a>>,
}

impl<'a> Filled<'a> {
    fn next(&mut self) -> Option<Line<'a>> {
        if let Some(line) = self.held.take() {
            return Some(line);
        }
        for line in self.lines.by_ref() {
            self.last = line.number;
            let end = line.text.iter().position(|byte| *byte == b'#');
            let text = &line.text[..end.unwrap_or(line.text.len())];
            if !text.trim_ascii().is_empty() {
                return Some(Line { text, ..line });
            }
        }
        None
    }

    fn expect(&mut self, what: &str, row: usize, rows: u64) -> Result<Line<'a>> {
        let last = self.last;
        self.next().ok_or_else(|| {
            Error::failed(format!(
                "line {last}: expected {what} {} of {rows}, found the end of the file; the file is truncated, copy it again",
                row + 1
            ))
        })
    }
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
    let line = lines.expect("the line of counts", 0, 1)?;
    let mut words = line.words();
    let mut count = || {
        let value = words.next().and_then(integer);
        value.and_then(|value| u64::try_from(value).ok())
    };
    match (count(), count()) {
        (Some(vertices), Some(faces)) => Ok((kind, [vertices, faces])),
        _ => Err(Error::failed(format!(
            "line {}: expected the numbers of vertices, faces and edges, found '{}'; the file is damaged, export it again",
            line.number,
            line.excerpt()
        ))),
    }
}

fn read(
    kind: Kind,
    [vertex_count, face_count]: [u64; 2],
    lines: &mut Filled<'_>,
    out: &mut Output<'_>,
    progress: &Progress<'_>,
) -> Result<Mesh> {
    let mut mesh = Mesh::default();
    let fail = |line: &Line<'_>, what: &str, expected: &str| {
        Error::failed(format!(
            "line {}: expected {expected} of {what}, found '{}'; correct that line or export the file again",
            line.number,
            line.excerpt()
        ))
    };
    let look = |lines: &Filled<'_>, row: u64| {
        if row.is_multiple_of(LINES_A_PIECE) {
            progress.set(lines.lines.fraction(), "reading lines");
            return progress.check();
        }
        Ok(())
    };
    if vertex_count == 0 {
        return Err(Error::failed(
            "the file has 0 vertices; there is nothing to show",
        ));
    }
    let mut values: Vec<f64> = Vec::new();
    for row in 0..vertex_count {
        look(lines, row)?;
        let line = lines.expect("vertex", row as usize, vertex_count)?;
        values.clear();
        values.extend(line.words().map_while(number));
        let least = 3 + 3 * usize::from(kind.has_normal) + 3 * usize::from(kind.has_colour);
        let least = least + 2 * usize::from(kind.has_uv);
        if values.len() < least {
            return Err(fail(&line, "a vertex", &format!("{least} numbers")));
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
    let mut colours: Vec<Option<[f32; 4]>> = Vec::new();
    let mut indexed = 0;
    for row in 0..face_count {
        look(lines, row)?;
        let line = lines.expect("face", row as usize, face_count)?;
        let mut words = line.words();
        let length = words
            .next()
            .and_then(integer)
            .and_then(|length| u32::try_from(length).ok());
        let length = length.ok_or_else(|| fail(&line, "a face", "the number of corners"))?;
        for _ in 0..length {
            let corner = words.next().and_then(integer);
            let corner = corner.ok_or_else(|| {
                fail(
                    &line,
                    "a face",
                    &format!("{length} corners behind their number"),
                )
            })?;
            // What names no vertex is dropped by the host, and counted.
            mesh.corners.push(u32::try_from(corner).unwrap_or(u32::MAX));
        }
        mesh.lengths.push(length);
        let values: Vec<f32> = words
            .map_while(number)
            .map(|value| value as f32)
            .take(4)
            .collect();
        let is_named = values.len() == 1 || values.len() == 2;
        indexed += u64::from(is_named);
        colours.push(match values[..] {
            [red, green, blue] => Some([red, green, blue, f32::NAN]),
            [red, green, blue, alpha] => Some([red, green, blue, alpha]),
            _ => None,
        });
    }
    out.warn(
        "a face has a colour by its number in a map, which is left out",
        indexed,
    );
    let coloured = colours.iter().flatten().count();
    if kind.has_colour {
        out.warn(
            "a face has a colour of its own, which is left out, since vertices have colours",
            coloured as u64,
        );
    } else if coloured > 0 {
        mesh.take_face_colours(&as_light(colours));
    }
    Ok(mesh)
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
