//! Lines of OBJ, read without what comes before them in the file.

use std::borrow::Cow;

use pointstage_plugin_api::lines::{Line, Lines, Words, integer, number, scan_i64};
use pointstage_plugin_api::pieces::Fault;

use crate::mtl::rest_of;

/// Names no vertex, no texture coordinates, no normal; the host drops a face that names no vertex, and counts it.
pub(crate) const NO_VERTEX: u32 = u32::MAX;

/// What some lines of a file say.
#[derive(Debug, Default)]
pub(crate) struct Piece {
    pub(crate) positions: Vec<[f64; 3]>,
    /// Nothing while no vertex has a colour; then of each, white for those without.
    pub(crate) colours: Vec<[f32; 3]>,
    pub(crate) uvs: Vec<[f32; 2]>,
    pub(crate) normals: Vec<[f32; 3]>,
    /// Lengths of the faces.
    pub(crate) lengths: Vec<u32>,
    /// Vertices of all corners.
    pub(crate) corners: Vec<u32>,
    /// Texture coordinates of the corners; nothing, or missing at the end, where none has any.
    pub(crate) corner_uvs: Vec<u32>,
    /// Normals of the corners, in the same way.
    pub(crate) corner_normals: Vec<u32>,
    /// Indices that count from the end of what has been read.
    relative: Vec<Relative>,
    /// Lines about materials, each with the number of faces before it.
    pub(crate) events: Vec<(usize, Event)>,
    pub(crate) lines_and_points: u64,
}

/// A line about materials.
#[derive(Debug)]
pub(crate) enum Event {
    Library(Vec<u8>),
    Material(Vec<u8>),
}

/// What a corner names, counted from 0; [`NO_VERTEX`] for nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Corner {
    pub(crate) vertex: u32,
    pub(crate) uv: u32,
    pub(crate) normal: u32,
}

/// An index that depends on what was read before the piece.
#[derive(Debug)]
struct Relative {
    corner: usize,
    part: usize,
    /// From the first that the piece adds.
    from_first: i64,
}

/// The numbers of a corner as they stand there; 0 for one that is left out.
type Parts = [i64; 3];

/// Whether a piece may begin at a byte where a line does: not behind a backslash, which continues the line.
pub(crate) fn may_begin(text: &[u8], start: usize) -> bool {
    let line = text.get(..start).unwrap_or_default();
    let line = line.strip_suffix(b"\n").unwrap_or(line);
    let line = line.strip_suffix(b"\r").unwrap_or(line);
    !line.ends_with(b"\\")
}

/// Reads lines.
pub(crate) fn read_lines(mut lines: Lines<'_>) -> Result<Piece, Fault> {
    let mut piece = Piece::default();
    while let Some(line) = lines.next() {
        let text = join_continued(line, &mut lines);
        let line = Line {
            text: &text,
            ..line
        };
        piece.read_line(&line)?;
    }
    Ok(piece)
}

/// The line with those that follow it while each ends in a backslash.
fn join_continued<'a>(line: Line<'a>, lines: &mut Lines<'a>) -> Cow<'a, [u8]> {
    let Some(begin) = line.text.strip_suffix(b"\\") else {
        return Cow::Borrowed(line.text);
    };
    let mut joined = begin.to_vec();
    for next in lines.by_ref() {
        joined.push(b' ');
        let part = next.text.strip_suffix(b"\\");
        joined.extend_from_slice(part.unwrap_or(next.text));
        if part.is_none() {
            break;
        }
    }
    Cow::Owned(joined)
}

impl Piece {
    fn read_line(&mut self, line: &Line<'_>) -> Result<(), Fault> {
        let mut words = line.words();
        match words.next() {
            Some(b"v") => return self.read_vertex(line, words),
            Some(b"f" | b"fo") => return self.read_face(line, words),
            Some(b"vn") => {
                let mut value = || words.number().map(|value| value as f32);
                let (Some(x), Some(y), Some(z)) = (value(), value(), value()) else {
                    return Err(not_numbers(line, "3 numbers"));
                };
                self.normals.push([x, y, z]);
            }
            Some(b"vt") => {
                let value = |word: Option<&[u8]>| word.map_or(Some(0.0), number);
                match (words.number(), value(words.next())) {
                    (Some(u), Some(v)) => self.uvs.push([u as f32, v as f32]),
                    _ => return Err(not_numbers(line, "1 to 3 numbers")),
                }
            }
            Some(b"l" | b"p") => self.lines_and_points += 1,
            Some(b"mtllib") => {
                let name = rest_of(line.text, b"mtllib").to_vec();
                self.events.push((self.lengths.len(), Event::Library(name)));
            }
            Some(b"usemtl") => {
                let name = rest_of(line.text, b"usemtl").to_vec();
                self.events
                    .push((self.lengths.len(), Event::Material(name)));
            }
            _ => {}
        }
        Ok(())
    }

    /// `v x y z`, perhaps with a weight, or with red, green and blue.
    fn read_vertex(&mut self, line: &Line<'_>, mut words: Words<'_>) -> Result<(), Fault> {
        let mut values = [0.0; 8];
        let mut count = 0;
        while !words.rest().is_empty() {
            let value = words.number().filter(|_| count < values.len());
            values[count] = value.ok_or_else(|| not_numbers(line, "3 to 7 numbers"))?;
            count += 1;
        }
        if count < 3 {
            return Err(not_numbers(line, "3 to 7 numbers"));
        }
        // A fourth number alone is a weight; behind a colour comes alpha.
        if count >= 6 {
            self.colours.resize(self.positions.len(), [1.0; 3]);
            let colour = [values[3], values[4], values[5]];
            self.colours.push(colour.map(|value| value as f32));
        }
        self.positions.push([values[0], values[1], values[2]]);
        Ok(())
    }

    /// `f a b c …`, each corner as `v`, `v/vt`, `v//vn` or `v/vt/vn`; numbers from 1, or negative from the end.
    fn read_face(&mut self, line: &Line<'_>, mut words: Words<'_>) -> Result<(), Fault> {
        let mut length = 0;
        loop {
            let rest = words.rest();
            if matches!(rest, [] | [b'#', ..]) {
                break;
            }
            let parts = if let Some((parts, bytes)) = scan_corner(rest) {
                words.advance(bytes);
                parts
            } else {
                let parts = words.next().and_then(read_corner);
                parts.ok_or_else(|| not_numbers(line, "corners like 1, 1/2, 1//3 or 1/2/3"))?
            };
            self.add_corner(parts);
            length += 1;
        }
        if length < 3 {
            return Err(not_numbers(line, "three corners or more"));
        }
        self.lengths.push(length);
        Ok(())
    }

    fn add_corner(&mut self, parts: Parts) {
        let corner = self.corners.len();
        let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
        let mut index = |part: usize| {
            let number = parts[part];
            if number < 0 {
                self.relative.push(Relative {
                    corner,
                    part,
                    from_first: (counts[part] as i64).saturating_add(number),
                });
            }
            u32::try_from(number - i64::from(number > 0))
                .ok()
                .filter(|_| number > 0)
        };
        let [vertex, uv, normal] = [0, 1, 2].map(&mut index);
        self.corners.push(vertex.unwrap_or(NO_VERTEX));
        for (own, number, index) in [
            (&mut self.corner_uvs, parts[1], uv),
            (&mut self.corner_normals, parts[2], normal),
        ] {
            if number != 0 {
                own.resize(corner, NO_VERTEX);
                own.push(index.unwrap_or(NO_VERTEX));
            }
        }
    }

    /// Finds what relative indices mean; `before` says how many vertices, texture coordinates and normals come before the piece.
    pub(crate) fn resolve(&mut self, before: [usize; 3]) {
        for Relative {
            corner,
            part,
            from_first,
        } in std::mem::take(&mut self.relative)
        {
            let own = [
                &mut self.corners,
                &mut self.corner_uvs,
                &mut self.corner_normals,
            ];
            let index = (before[part] as i64).saturating_add(from_first);
            if let Some(slot) = own[part].get_mut(corner) {
                *slot = u32::try_from(index).unwrap_or(NO_VERTEX);
            }
        }
    }

    /// The corner at an index.
    pub(crate) fn corner(&self, index: usize) -> Corner {
        let of = |all: &[u32]| all.get(index).copied().unwrap_or(NO_VERTEX);
        Corner {
            vertex: of(&self.corners),
            uv: of(&self.corner_uvs),
            normal: of(&self.corner_normals),
        }
    }
}

/// The corner at the start of `text` and the bytes it takes, for what nearly every corner looks like.
#[inline]
fn scan_corner(text: &[u8]) -> Option<(Parts, usize)> {
    let mut parts = [0; 3];
    let mut bytes = 0;
    for part in 0..3 {
        if let Some((number, length)) = scan_i64(&text[bytes..]) {
            // 0 names nothing, but is not left out.
            if number == 0 {
                return None;
            }
            parts[part] = number;
            bytes += length;
        } else if part == 0 {
            return None;
        }
        match text.get(bytes) {
            None | Some(b' ' | b'\t') => return Some((parts, bytes)),
            Some(b'/') => bytes += 1,
            Some(_) => return None,
        }
    }
    None
}

/// The corner that a word is.
fn read_corner(word: &[u8]) -> Option<Parts> {
    let mut parts = word.split(|byte| *byte == b'/').map(|part| {
        if part.is_empty() {
            Some(None)
        } else {
            integer(part).map(Some)
        }
    });
    let mut part = || parts.next().unwrap_or(Some(None));
    let (Some(Some(vertex)), Some(uv), Some(normal)) = (part(), part(), part()) else {
        return None;
    };
    // 0 names nothing: neither does a number that is far beyond every vertex.
    let named = |number: i64| if number == 0 { i64::MAX } else { number };
    Some([named(vertex), uv.map_or(0, named), normal.map_or(0, named)])
}

fn not_numbers(line: &Line<'_>, expected: &str) -> Fault {
    let keyword = line.words().next().unwrap_or_default().escape_ascii();
    Fault::new(
        line,
        format!(
            "expected {expected} behind '{keyword}', found '{}'; correct that line or export the file again",
            line.excerpt()
        ),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_are_scanned_as_they_are_read() {
        for (word, parts) in [
            ("7", Some([7, 0, 0])),
            ("7/8", Some([7, 8, 0])),
            ("7//9", Some([7, 0, 9])),
            ("7/8/9", Some([7, 8, 9])),
            ("-1/-2/-3", Some([-1, -2, -3])),
            ("+7", None),
            ("7/8/9/10", None),
            ("0//1", None),
            ("7/", Some([7, 0, 0])),
            ("7x", None),
            ("/8", None),
        ] {
            let text = format!("{word} 5");
            let scanned = scan_corner(text.as_bytes());
            assert_eq!(scanned, parts.map(|parts| (parts, word.len())), "{word}");
            if parts.is_some() {
                assert_eq!(read_corner(word.as_bytes()), parts, "{word}");
            }
        }
        assert_eq!(read_corner(b"+7"), Some([7, 0, 0]));
        assert_eq!(read_corner(b"0//1"), Some([i64::MAX, 0, 1]));
        assert_eq!(read_corner(b"7/8/9/10"), Some([7, 8, 9]));
        assert_eq!((read_corner(b"/8"), read_corner(b"7x")), (None, None));
    }

    #[test]
    fn a_piece_begins_behind_no_backslash() {
        let text = b"f 1 2 \\\r\n3\nf 1 2 \\\n3\n";
        let begins: Vec<bool> = [9, 11, 19, 21].map(|start| may_begin(text, start)).into();
        assert_eq!(begins, [false, true, false, true]);
    }

    #[test]
    fn relative_corners_are_found_behind_what_came_before() {
        let text = b"v 0 0 0\nvn 0 0 1\nf -1//-1 -2//1 -9\n";
        let mut piece = read_lines(Lines::new(text)).expect("sound");
        piece.resolve([5, 0, 7]);
        let corner = |vertex, normal| Corner {
            vertex,
            uv: NO_VERTEX,
            normal,
        };
        let corners: Vec<Corner> = (0..3).map(|index| piece.corner(index)).collect();
        assert_eq!(
            corners,
            [corner(5, 7), corner(4, 0), corner(NO_VERTEX, NO_VERTEX)]
        );
    }
}
