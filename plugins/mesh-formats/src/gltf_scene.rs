//! glTF 2.0, as one binary file or as JSON with buffers and pictures beside it.
//!
//! The default scene's nodes are walked; each mesh comes where its node puts it, as often as nodes name it. A vertex's colour
//! is its own times the material's base colour times the mean of the texels of the base-colour texture round it (of a point, the
//! texel that it lies in); all three are multiplied as linear light, and handed over as sRGB. Alpha weights texels where the
//! material says that it means something.

use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;

use gltf::mesh::Mode;
use gltf::texture::WrappingMode;
use gltf::{Primitive, material::AlphaMode};
use pointstage_plugin_api::glam::{DMat4, DVec2, DVec3};
use pointstage_plugin_api::loading::{Claim, FileStart, Loader, Output, SourceFile};
use pointstage_plugin_api::{Error, Host, Progress, Result, Settings};
use pointstage_texels::{Alpha, Material, NO_MATERIAL, Picture, Wrap, srgb};

use crate::columns::Mesh;
use crate::gltf_buffers::Buffers;
use crate::gltf_nodes::{Parts, world_normals};
use crate::gltf_pictures::{name_of, read_picture};
use crate::gltf_plain::Plain;
use crate::textured::{Meets, Textured, Textures};

/// Vertices of one accessor that may come of a few bytes: one without a buffer is all zeros.
const MOST_WITHOUT_BUFFER: usize = 1 << 20;

/// The loader of glTF files.
pub struct GltfLoader;

impl Loader for GltfLoader {
    fn claims(start: &FileStart<'_>) -> Claim {
        if start.bytes.starts_with(b"glTF") {
            return Claim::Certain;
        }
        let text = start.bytes.trim_ascii_start();
        let has_asset = text.windows(7).any(|word| word == b"\"asset\"");
        match (text.starts_with(b"{"), has_asset) {
            (true, true) => Claim::Likely,
            (true, false) => Claim::Possible,
            (false, _) => Claim::No,
        }
    }

    fn load(
        _host: &Host,
        file: &SourceFile<'_>,
        settings: Settings<'_>,
        out: &mut Output<'_>,
        progress: &Progress<'_>,
    ) -> Result<()> {
        let textures = Textures::of(settings)?;
        // The library takes some numbers of a damaged file as they are and stops in the middle, its own validation included.
        let read = catch_unwind(AssertUnwindSafe(|| read(file, textures, out, progress)));
        read.unwrap_or_else(|_| {
            Err(Error::failed(
                "the file is no sound glTF: numbers in it lead nowhere; it is damaged, export it again",
            ))
        })
    }
}

/// Hands over the meshes of the scene as one.
fn read(
    file: &SourceFile<'_>,
    textures: Textures,
    out: &mut Output<'_>,
    progress: &Progress<'_>,
) -> Result<()> {
    let (document, inside) = Buffers::of_file(file.bytes)
        .map_err(|error| Error::failed(format!("the file is no sound glTF: {error}")))?;
    progress.set(0.05, "reading buffers");
    let buffers = Buffers::import(document, inside, file.path)
        .map_err(|error| Error::failed(format!("a buffer cannot be read: {error}")))?;
    progress.check()?;
    if let Some(plain) = Plain::of(Parts::of(&buffers.document), &buffers) {
        return plain.write(out, progress);
    }
    let mut reader = Reader {
        buffers: &buffers,
        path: file.path,
        textures,
        pictures: HashMap::new(),
        textured: Textured::default(),
        mesh: Mesh::default(),
        left_out: 0,
        out,
    };
    let mut parts = Parts::of(&buffers.document);
    while let Some(part) = parts.next() {
        progress.check()?;
        progress.set(0.2 + 0.8 * parts.fraction(), "reading meshes");
        reader.read_primitive(&part.primitive, part.world_from_node)?;
    }
    let Reader {
        mut mesh,
        mut textured,
        left_out,
        ..
    } = reader;
    out.warn("a primitive of lines is left out", left_out);
    if mesh.positions.is_empty() {
        return Err(Error::failed(
            "the scene has no triangles and no points; there is nothing to show",
        ));
    }
    if !mesh.uvs.is_empty() {
        mesh.uvs.resize(mesh.positions.len(), [f32::NAN; 2]);
    }
    if textured.has_pictures() {
        textured.colour(&mut mesh, textures, Meets::Multiplies, out, progress)?;
    }
    mesh.write(out, progress)
}

struct Reader<'r, 'o> {
    buffers: &'r Buffers<'r>,
    path: &'r Path,
    textures: Textures,
    /// Pictures that were read, by their index and use; none in place of one that cannot be read, which was a warning.
    pictures: HashMap<(usize, Alpha), Option<Arc<Picture>>>,
    textured: Textured,
    mesh: Mesh,
    left_out: u64,
    out: &'r mut Output<'o>,
}

impl Reader<'_, '_> {
    fn read_primitive(&mut self, primitive: &Primitive<'_>, world_from_node: DMat4) -> Result<()> {
        let mode = primitive.mode();
        if matches!(mode, Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
            self.left_out += 1;
            return Ok(());
        }
        let sizes = primitive.attributes().map(|(_, accessor)| accessor);
        for accessor in sizes.chain(primitive.indices()) {
            if accessor.view().is_none() && accessor.count() > MOST_WITHOUT_BUFFER {
                return Err(Error::failed(format!(
                    "accessor {} has {} values and no buffer to hold them; the file is damaged",
                    accessor.index(),
                    accessor.count()
                )));
            }
        }
        let reader = primitive.reader(|buffer| self.buffers.get(buffer.index()));
        let Some(positions) = reader.read_positions() else {
            self.out.warn(
                "a primitive without positions that can be read is left out",
                1,
            );
            return Ok(());
        };
        let first = self.mesh.positions.len();
        self.mesh.positions.extend(positions.map(|position| {
            let position = DVec3::from_array(position.map(f64::from));
            world_from_node.transform_point3(position).to_array()
        }));
        let count = self.mesh.positions.len() - first;
        self.add_normals(reader.read_normals(), first, world_from_node);
        let own: Vec<[f32; 4]> = reader
            .read_colors(0)
            .map(|colours| colours.into_rgba_f32().take(count).collect())
            .unwrap_or_default();
        let pbr = primitive.material().pbr_metallic_roughness();
        let texture = pbr.base_color_texture();
        let set = texture.as_ref().map_or(0, gltf::texture::Info::tex_coord);
        let uvs: Vec<[f32; 2]> = reader
            .read_tex_coords(set)
            .map(|uvs| uvs.into_f32().take(count).collect())
            .unwrap_or_default();
        self.add_uvs(&uvs, first);
        let factor = pbr.base_color_factor();
        let material = texture
            .filter(|_| !uvs.is_empty() && self.textures != Textures::None)
            .and_then(|texture| self.material(&primitive.material(), &texture));
        match &material {
            // The texture brings the factor along.
            Some(material) => {
                let mut own = own;
                if mode == Mode::Points {
                    colour_points(&mut own, &uvs, material);
                }
                self.add_colours(first, &own, [1.0; 4]);
            }
            None => self.add_colours(first, &own, factor),
        }
        let corners: Vec<u32> = match reader.read_indices() {
            Some(indices) => indices.into_u32().collect(),
            None => (0..count as u32).collect(),
        };
        let is_mirrored = world_from_node.determinant() < 0.0;
        let first_corner = self.mesh.corners.len();
        self.add_triangles(mode, &corners, first, count, is_mirrored);
        if let Some(material) = material {
            let textured = &mut self.textured;
            let index = textured.materials.len() as u32;
            textured.materials.push(material);
            textured.uvs.resize(first_corner, [f32::NAN; 2]);
            let own = &self.mesh.corners[first_corner..];
            textured.uvs.extend(own.iter().map(|corner| {
                let uv = uvs.get((*corner as usize).wrapping_sub(first));
                uv.copied().unwrap_or([f32::NAN; 2])
            }));
            textured.faces.resize(first_corner / 3, NO_MATERIAL);
            textured.faces.resize(self.mesh.lengths.len(), index);
        }
        Ok(())
    }

    /// The material, if its picture can be read.
    fn material(
        &mut self,
        material: &gltf::Material<'_>,
        texture: &gltf::texture::Info<'_>,
    ) -> Option<Material> {
        let alpha = if material.alpha_mode() == AlphaMode::Opaque {
            Alpha::Ignored
        } else {
            Alpha::Respected
        };
        let source = texture.texture().source();
        let key = (source.index(), alpha);
        if !self.pictures.contains_key(&key) {
            let source = source.source();
            let picture = match read_picture(&source, self.path, self.buffers, alpha) {
                Ok(picture) => Some(Arc::new(picture)),
                Err(error) => {
                    let name = name_of(&source);
                    let text = format!(
                        "the texture {name} cannot be read ({error}): its colours are left out"
                    );
                    self.out.warn(&text, 1);
                    None
                }
            };
            self.pictures.insert(key, picture);
        }
        let picture = self.pictures.get(&key)?.clone()?;
        let [red, green, blue, _] = material.pbr_metallic_roughness().base_color_factor();
        let factor = [red, green, blue, 1.0];
        let sampler = texture.texture().sampler();
        let wrap = [sampler.wrap_s(), sampler.wrap_t()].map(|mode| match mode {
            WrappingMode::ClampToEdge => Wrap::Clamp,
            WrappingMode::MirroredRepeat => Wrap::Mirror,
            WrappingMode::Repeat => Wrap::Repeat,
        });
        Some(Material {
            factor,
            wrap,
            plain: Some(factor),
            ..Material::of_picture(picture)
        })
    }

    /// Keeps texture coordinates; NaN for vertices without.
    fn add_uvs(&mut self, uvs: &[[f32; 2]], first: usize) {
        if !uvs.is_empty() {
            self.mesh.uvs.resize(first, [f32::NAN; 2]);
            self.mesh.uvs.extend(uvs);
        }
    }

    /// Normals in the world; zeros for vertices without one, which the host replaces.
    fn add_normals(
        &mut self,
        normals: Option<impl Iterator<Item = [f32; 3]>>,
        first: usize,
        world_from_node: DMat4,
    ) {
        let count = self.mesh.positions.len();
        let normals = normals.into_iter().flatten().take(count - first);
        let transformed = world_normals(normals, world_from_node);
        let mut transformed = transformed.peekable();
        if transformed.peek().is_some() || !self.mesh.normals.is_empty() {
            self.mesh.normals.resize(first, [0.0; 3]);
            self.mesh.normals.extend(transformed);
            self.mesh.normals.resize(count, [0.0; 3]);
        }
    }

    /// Colours of vertices, linear, times a factor.
    fn add_colours(&mut self, first: usize, own: &[[f32; 4]], factor: [f32; 4]) {
        let count = self.mesh.positions.len();
        let is_plain = own.is_empty() && factor[..3] == [1.0; 3];
        if is_plain && self.mesh.colours.is_empty() {
            return;
        }
        self.mesh.colours.resize(first, [1.0; 3]);
        self.mesh.colours.extend((0..count - first).map(|vertex| {
            let own = own.get(vertex).copied().unwrap_or([1.0; 4]);
            std::array::from_fn(|channel| srgb(own[channel] * factor[channel]))
        }));
    }

    /// Triangles of corners that count from the primitive's first vertex; a corner beyond its last names no vertex.
    fn add_triangles(
        &mut self,
        mode: Mode,
        corners: &[u32],
        first: usize,
        count: usize,
        is_mirrored: bool,
    ) {
        let vertex = |corner: u32| {
            if (corner as usize) < count {
                u32::try_from(first + corner as usize).unwrap_or(u32::MAX)
            } else {
                u32::MAX
            }
        };
        let mut add = |[a, b, c]: [u32; 3]| {
            let [b, c] = if is_mirrored { [c, b] } else { [b, c] };
            self.mesh.corners.extend([a, b, c].map(vertex));
            self.mesh.lengths.push(3);
        };
        match mode {
            Mode::Triangles => corners.as_chunks::<3>().0.iter().copied().for_each(add),
            Mode::TriangleStrip => {
                for (index, window) in corners.windows(3).enumerate() {
                    let [a, b, c] = [window[0], window[1], window[2]];
                    // Strips repeat corners to turn; such triangles are no faces.
                    if a != b && b != c && a != c {
                        add(if index % 2 == 0 { [a, b, c] } else { [b, a, c] });
                    }
                }
            }
            Mode::TriangleFan => {
                for pair in corners.get(1..).unwrap_or_default().windows(2) {
                    add([corners[0], pair[0], pair[1]]);
                }
            }
            Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => {}
        }
    }
}

/// Multiplies colours of points, linear, by the texels that they lie in.
fn colour_points(own: &mut Vec<[f32; 4]>, uvs: &[[f32; 2]], material: &Material) {
    own.resize(uvs.len().max(own.len()), [1.0; 4]);
    for (colour, [u, v]) in own.iter_mut().zip(uvs) {
        let place = DVec2::new(f64::from(*u), f64::from(*v));
        let light = material.light([place; 4]);
        // What is not covered has no colour; alpha is not kept.
        if let Some([red, green, blue, alpha]) = light.filter(|light| light[3] > 0.0) {
            for (own, value) in colour.iter_mut().zip([red, green, blue]) {
                *own *= value / alpha;
            }
        }
    }
}
