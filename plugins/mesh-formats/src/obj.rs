//! Wavefront OBJ.
//!
//! A vertex (`v`) is a surfel. Corners of faces may give one vertex several normals and texture coordinates: the vertex gets
//! the mean of its normals and the first of its texture coordinates. Its colour is the mean of what the materials of its faces
//! say, in linear light and weighted by area: the texels that each face's part round it covers, where there is a texture
//! (`map_Kd`), else the diffuse colour (`Kd`). Where no face has a texture, colours behind the coordinates of `v`, as many scanners
//! write them, come before diffuse colours.

use std::collections::HashMap;

use pointstage_plugin_api::lines::Lines;
use pointstage_plugin_api::loading::{Claim, FileStart, Loader, Output, SourceFile};
use pointstage_plugin_api::pieces::Text;
use pointstage_plugin_api::{Error, Host, Progress, Result, Settings};
use pointstage_texels::{Material, NO_MATERIAL, Wrap, linear};

use crate::columns::Mesh;
use crate::mtl::{Materials, Texture};
use crate::obj_lines::{Corner, Event, NO_VERTEX, Piece, may_begin, read_lines};
use crate::textured::{Meets, Pictures, Textured, Textures};

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
        host: &Host,
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
        Text::new(Lines::new(file.bytes), "reading lines")
            .with_begin(may_begin)
            .read(host, progress, read_lines, |piece| {
                reader.add(piece, file, out);
                Ok(())
            })?;
        if reader.mesh.positions.is_empty() {
            return Err(Error::failed(
                "the file has no vertices (lines that begin with 'v'); there is nothing to show",
            ));
        }
        reader.finish(out, progress)?.write(out, progress)
    }
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
    /// What moves the texture coordinates of each of these materials.
    moves: Vec<Option<Texture>>,
    /// Indices of the materials that have been used.
    used: HashMap<Vec<u8>, u32>,
    /// The material in use.
    material: Option<u32>,
    /// Corners of which something comes later in the file, or never: their place among the corners, and their material.
    later: Vec<(usize, Corner, Option<u32>)>,
    lines_and_points: u64,
    unknown_materials: u64,
}

impl Reader {
    /// Adds the lines that follow.
    fn add(&mut self, mut piece: Piece, file: &SourceFile<'_>, out: &mut Output<'_>) {
        piece.resolve([
            self.mesh.positions.len(),
            self.uvs.len(),
            self.normals.len(),
        ]);
        self.lines_and_points += piece.lines_and_points;
        self.add_colours(&piece);
        self.mesh.positions.extend_from_slice(&piece.positions);
        self.uvs.extend_from_slice(&piece.uvs);
        self.normals.extend_from_slice(&piece.normals);
        let (mut face, mut corner) = (0, 0);
        for (end, event) in &piece.events {
            let lengths = &piece.lengths[face..*end];
            self.add_faces(lengths, &piece, &mut corner);
            face = *end;
            match event {
                Event::Library(name) if self.wants_materials => self.read_library(name, file, out),
                Event::Library(_) => {}
                Event::Material(name) => self.use_material(name, file, out),
            }
        }
        self.add_faces(&piece.lengths[face..], &piece, &mut corner);
    }

    /// Colours of the vertices that a piece adds; white for those without, once there are any.
    fn add_colours(&mut self, piece: &Piece) {
        let before = self.mesh.positions.len();
        self.has_colours |= !piece.colours.is_empty();
        if self.has_colours {
            self.mesh.colours.resize(before, [1.0; 3]);
            self.mesh.colours.extend_from_slice(&piece.colours);
            let count = before + piece.positions.len();
            self.mesh.colours.resize(count, [1.0; 3]);
        }
    }

    /// Adds faces of a piece, whose corners begin at `next`, with the material in use.
    fn add_faces(&mut self, lengths: &[u32], piece: &Piece, next: &mut usize) {
        let count: usize = lengths.iter().map(|length| *length as usize).sum();
        let own = *next..*next + count;
        *next = own.end;
        if let Some(material) = self.material {
            let faces = &mut self.textured.faces;
            faces.resize(self.mesh.lengths.len(), NO_MATERIAL);
            faces.resize(self.mesh.lengths.len() + lengths.len(), material);
        }
        let first = self.mesh.corners.len();
        self.mesh.lengths.extend_from_slice(lengths);
        self.mesh
            .corners
            .extend_from_slice(&piece.corners[own.clone()]);
        if piece.corner_uvs.is_empty() && piece.corner_normals.is_empty() {
            return;
        }
        for (place, index) in (first..).zip(own) {
            let corner = piece.corner(index);
            if self.is_known(&corner) {
                self.note_corner(place, &corner, self.material);
            } else {
                self.later.push((place, corner, self.material));
            }
        }
    }

    /// Whether all that a corner names has been read.
    fn is_known(&self, corner: &Corner) -> bool {
        let is_known = |index: u32, count: usize| index == NO_VERTEX || (index as usize) < count;
        is_known(corner.vertex, self.mesh.positions.len())
            && is_known(corner.uv, self.uvs.len())
            && is_known(corner.normal, self.normals.len())
    }

    /// What the corner at a place among all corners says of its vertex.
    fn note_corner(&mut self, place: usize, corner: &Corner, material: Option<u32>) {
        let (vertex, count) = (corner.vertex as usize, self.mesh.positions.len());
        if vertex >= count {
            return;
        }
        if let Some(normal) = self.normals.get(corner.normal as usize) {
            if self.mesh.normals.len() <= vertex {
                self.mesh.normals.resize(count, [0.0; 3]);
            }
            for (sum, value) in self.mesh.normals[vertex].iter_mut().zip(normal) {
                *sum += value;
            }
        }
        let Some(uv) = self.uvs.get(corner.uv as usize) else {
            return;
        };
        if self.mesh.uvs.len() <= vertex {
            self.mesh.uvs.resize(count, [f32::NAN; 2]);
        }
        if self.mesh.uvs[vertex][0].is_nan() {
            self.mesh.uvs[vertex] = *uv;
        }
        let texture = material.and_then(|material| self.moves.get(material as usize)?.as_ref());
        if let Some(texture) = texture {
            let uvs = &mut self.textured.uvs;
            if uvs.len() <= place {
                uvs.resize(place + 1, [f32::NAN; 2]);
            }
            uvs[place] = texture.place(*uv);
        }
    }

    /// Takes the material `name` for the faces that follow.
    fn use_material(&mut self, name: &[u8], file: &SourceFile<'_>, out: &mut Output<'_>) {
        if let Some(known) = self.used.get(name) {
            self.material = Some(*known);
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
            self.moves.push(texture);
            self.used.insert(name.to_vec(), index);
            Some(index)
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
        for (place, corner, material) in std::mem::take(&mut self.later) {
            self.note_corner(place, &corner, material);
        }
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
