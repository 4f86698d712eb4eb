//! Wavefront OBJ.
//!
//! A vertex (`v`) is a surfel. Corners of faces may give one vertex several normals and texture coordinates: the vertex gets
//! the mean of its normals and the first of its texture coordinates. Its colour is the mean of what the materials of its faces
//! say, in linear light and weighted by area: the texels that each face's part round it covers, where there is a texture
//! (`map_Kd`), else the diffuse colour (`Kd`). Where no face has a texture, colours behind the coordinates of `v`, as many scanners
//! write them, come before diffuse colours.

use std::borrow::Cow;
use std::collections::HashMap;

use pointstage_plugin_api::lines::{Line, Lines, integer, number};
use pointstage_plugin_api::loading::{Claim, FileStart, Loader, Output, SourceFile};
use pointstage_plugin_api::{Error, Host, Progress, Result, Settings};
use pointstage_texels::{Material, NO_MATERIAL, Wrap, linear};

use crate::columns::Mesh;
use crate::mtl::{Materials, Texture, rest_of};
use crate::textured::{Meets, Pictures, Textured, Textures};

/// Lines read between two looks at the cancel flag.
const LINES_A_PIECE: u64 = 1 << 14;

/// Names no vertex; the host drops the face and counts it.
const NO_VERTEX: u32 = u32::MAX;

/// What lines may begin with.
const KEYWORDS: [&[u8]; 14] = [
    b"v", b"vn", b"vt", b"vp", b"f", b"l", b"p", b"o", b"g", b"s", b"mtllib", b"usemtl", b"mg",
    b"cstype",
];

/// The loader of OBJ files.
pub struct ObjLoader;

impl Loader for ObjLoader {
    fn claims(start: &FileStart<'_>) -> Claim {
        if start.bytes.contains(&0) {
            return Claim::No;
        }
        let first = Lines::new(start.bytes)
            .filter_map(|line| line.words().next())
            .find(|word| !word.starts_with(b"#"));
        match first {
            Some(word) if KEYWORDS.contains(&word) => Claim::Likely,
            Some(_) => Claim::No,
            None => Claim::Possible,
        }
    }

    fn load(
        _host: &Host,
        file: &SourceFile<'_>,
        settings: Settings<'_>,
        out: &mut Output<'_>,
        progress: &Progress<'_>,
    ) -> Result<()> {
        let mut reader = Reader {
            wants_materials: settings.bool("materials")?,
            textures: Textures::of(settings)?,
            textured: Textured {
                is_from_bottom: true,
                ..Textured::default()
            },
            ..Reader::default()
        };
        let mut lines = Lines::new(file.bytes);
        while let Some(line) = lines.next() {
            if line.number % LINES_A_PIECE == 0 {
                progress.check()?;
                progress.set(lines.fraction(), "reading lines");
            }
            let text = join_continued(line, &mut lines);
            let line = Line {
                text: &text,
                ..line
            };
            reader.read_line(&line, file, out)?;
        }
        if reader.mesh.positions.is_empty() {
            return Err(Error::failed(
                "the file has no vertices (lines that begin with 'v'); there is nothing to show",
            ));
        }
        reader.finish(out, progress)?.write(out, progress)
    }
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

/// The file as far as it has been read.
#[derive(Default)]
struct Reader {
    mesh: Mesh,
    has_colours: bool,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    wants_materials: bool,
    textures: Textures,
    materials: Materials,
    pictures: Pictures,
    /// What faces say of their colours; materials in the order in which they are first used.
    textured: Textured,
    /// Indices of the materials that have been used, and what moves their texture coordinates.
    used: HashMap<Vec<u8>, (u32, Option<Texture>)>,
    /// The material in use.
    material: Option<(u32, Option<Texture>)>,
    lines_and_points: u64,
    unknown_materials: u64,
}

impl Reader {
    fn read_line(
        &mut self,
        line: &Line<'_>,
        file: &SourceFile<'_>,
        out: &mut Output<'_>,
    ) -> Result<()> {
        let mut words = line.words();
        match words.next() {
            Some(b"v") => self.read_vertex(line),
            Some(b"vn") => {
                self.normals.push(numbers(line)?.map(|value| value as f32));
                Ok(())
            }
            Some(b"vt") => {
                let value = |word: Option<&[u8]>| word.map_or(Some(0.0), number);
                match (words.next().and_then(number), value(words.next())) {
                    (Some(u), Some(v)) => self.uvs.push([u as f32, v as f32]),
                    _ => return Err(not_numbers(line, "1 to 3 numbers")),
                }
                Ok(())
            }
            Some(b"f" | b"fo") => self.read_face(line),
            Some(b"l" | b"p") => {
                self.lines_and_points += 1;
                Ok(())
            }
            Some(b"mtllib") if self.wants_materials => {
                self.read_library(rest_of(line.text, b"mtllib"), file, out);
                Ok(())
            }
            Some(b"usemtl") => {
                self.use_material(rest_of(line.text, b"usemtl"), file, out);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// `v x y z`, perhaps with a weight, or with red, green and blue.
    fn read_vertex(&mut self, line: &Line<'_>) -> Result<()> {
        let mut values = [0.0; 8];
        let mut count = 0;
        for word in line.words().skip(1) {
            let value = number(word).filter(|_| count < values.len());
            values[count] = value.ok_or_else(|| not_numbers(line, "3 to 7 numbers"))?;
            count += 1;
        }
        if count < 3 {
            return Err(not_numbers(line, "3 to 7 numbers"));
        }
        self.mesh.positions.push([values[0], values[1], values[2]]);
        // A fourth number alone is a weight; behind a colour comes alpha.
        let colour = (count >= 6).then(|| [values[3], values[4], values[5]]);
        if colour.is_some() && !self.has_colours {
            self.has_colours = true;
            self.mesh.colours = vec![[1.0; 3]; self.mesh.positions.len() - 1];
        }
        if self.has_colours {
            let colour = colour.unwrap_or([1.0; 3]);
            self.mesh.colours.push(colour.map(|value| value as f32));
        }
        Ok(())
    }

    /// `f a b c …`, each corner as `v`, `v/vt`, `v//vn` or `v/vt/vn`; numbers from 1, or negative from the end.
    fn read_face(&mut self, line: &Line<'_>) -> Result<()> {
        let mut length = 0;
        for word in line.words().skip(1) {
            if word.starts_with(b"#") {
                break;
            }
            let mut parts = word.split(|byte| *byte == b'/').map(|part| {
                if part.is_empty() {
                    Some(None)
                } else {
                    integer(part).map(Some)
                }
            });
            let mut part = || parts.next().unwrap_or(Some(None));
            let (Some(Some(vertex)), Some(uv), Some(normal)) = (part(), part(), part()) else {
                return Err(not_numbers(line, "corners like 1, 1/2, 1//3 or 1/2/3"));
            };
            let corner = resolve(vertex, self.mesh.positions.len());
            self.mesh.corners.push(corner);
            length += 1;
            self.note_corner(corner, uv, normal);
        }
        if length < 3 {
            return Err(not_numbers(line, "three corners or more"));
        }
        if let Some((material, _)) = &self.material {
            let faces = &mut self.textured.faces;
            faces.resize(self.mesh.lengths.len(), NO_MATERIAL);
            faces.push(*material);
        }
        self.mesh.lengths.push(length);
        Ok(())
    }

    /// What a corner says of its vertex.
    fn note_corner(&mut self, corner: u32, uv: Option<i64>, normal: Option<i64>) {
        let (vertex, count) = (corner as usize, self.mesh.positions.len());
        if vertex >= count {
            return;
        }
        let normal = normal.and_then(|index| {
            self.normals
                .get(resolve(index, self.normals.len()) as usize)
        });
        if let Some(normal) = normal {
            if self.mesh.normals.len() <= vertex {
                self.mesh.normals.resize(count, [0.0; 3]);
            }
            for (sum, value) in self.mesh.normals[vertex].iter_mut().zip(normal) {
                *sum += value;
            }
        }
        let uv = uv.and_then(|index| self.uvs.get(resolve(index, self.uvs.len()) as usize));
        if let Some(uv) = uv {
            if self.mesh.uvs.len() <= vertex {
                self.mesh.uvs.resize(count, [f32::NAN; 2]);
            }
            if self.mesh.uvs[vertex][0].is_nan() {
                self.mesh.uvs[vertex] = *uv;
            }
        }
        if let (Some(uv), Some((_, Some(texture)))) = (uv, &self.material) {
            let uvs = &mut self.textured.uvs;
            uvs.resize(self.mesh.corners.len() - 1, [f32::NAN; 2]);
            uvs.push(texture.place(*uv));
        }
    }

    /// Takes the material `name` for the faces that follow.
    fn use_material(&mut self, name: &[u8], file: &SourceFile<'_>, out: &mut Output<'_>) {
        if let Some(known) = self.used.get(name) {
            self.material = Some(known.clone());
            return;
        }
        let described = self.materials.all.get(name).cloned();
        self.unknown_materials += u64::from(self.wants_materials && described.is_none());
        self.material = described.and_then(|described| {
            let texture = described
                .texture
                .filter(|_| self.textures != Textures::None);
            let picture = texture.as_ref().and_then(|texture| {
                let picture = self.pictures.beside(file.path, &texture.name, out)?;
                Some((picture, texture))
            });
            let diffuse = described
                .diffuse
                .map(|[red, green, blue]| [linear(red), linear(green), linear(blue), 1.0]);
            let material = match (picture, diffuse) {
                (Some((picture, texture)), diffuse) => Material {
                    wrap: if texture.is_clamped {
                        [Wrap::Clamp; 2]
                    } else {
                        [Wrap::Repeat; 2]
                    },
                    plain: diffuse,
                    ..Material::of_picture(picture)
                },
                (None, Some(diffuse)) => Material::of_colour(diffuse),
                (None, None) => return None,
            };
            let texture = texture.filter(|_| material.picture.is_some());
            let index = self.textured.materials.len() as u32;
            self.textured.materials.push(material);
            let known = (index, texture);
            self.used.insert(name.to_vec(), known.clone());
            Some(known)
        });
    }

    fn read_library(&mut self, name: &[u8], file: &SourceFile<'_>, out: &mut Output<'_>) {
        let name = String::from_utf8_lossy(name).replace('\\', "/");
        let path = file.path.with_file_name(&name);
        match std::fs::read(&path) {
            Ok(text) => self.materials.read(&text),
            Err(error) => out.warn(
                &format!("the material library '{name}' cannot be read ({error}): its colours are left out"),
                1,
            ),
        }
    }

    /// The mesh, with every column as long as there are vertices.
    fn finish(mut self, out: &mut Output<'_>, progress: &Progress<'_>) -> Result<Mesh> {
        let count = self.mesh.positions.len();
        if !self.mesh.normals.is_empty() {
            self.mesh.normals.resize(count, [0.0; 3]);
        }
        if !self.mesh.uvs.is_empty() {
            self.mesh.uvs.resize(count, [f32::NAN; 2]);
        }
        let has_pictures = self.textured.has_pictures();
        if has_pictures || (!self.has_colours && !self.textured.faces.is_empty()) {
            let (how, meets) = (self.textures, Meets::Replaces);
            self.textured
                .colour(&mut self.mesh, how, meets, out, progress)?;
        }
        out.warn(
            "a line or point element is left out: its vertices are shown",
            self.lines_and_points,
        );
        out.warn(
            "a material that no library describes is used: its faces have no colour of their own",
            self.unknown_materials,
        );
        Ok(self.mesh)
    }
}

/// An index from 0 of a number from 1, or of a negative one from the end.
fn resolve(number: i64, count: usize) -> u32 {
    let index = match number {
        1.. => number - 1,
        0 => -1,
        _ => count as i64 + number,
    };
    u32::try_from(index).unwrap_or(NO_VERTEX)
}

/// The three numbers behind a keyword.
fn numbers(line: &Line<'_>) -> Result<[f64; 3]> {
    let mut values = [0.0; 3];
    let mut words = line.words().skip(1);
    for value in &mut values {
        let word = words.next().and_then(number);
        *value = word.ok_or_else(|| not_numbers(line, "3 numbers"))?;
    }
    Ok(values)
}

fn not_numbers(line: &Line<'_>, expected: &str) -> Error {
    let keyword = line.words().next().unwrap_or_default().escape_ascii();
    Error::failed(format!(
        "line {}: expected {expected} behind '{keyword}', found '{}'; correct that line or export the file again",
        line.number,
        line.excerpt()
    ))
}
