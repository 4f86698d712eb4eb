//! glTF 2.0, as one binary file or as JSON with buffers and pictures beside it.
//!
//! The default scene's nodes are walked; each mesh comes where its node puts it, as often as nodes name it. A vertex's colour
//! is its own times the material's base colour times the nearest texel of the base-colour texture; all three are multiplied
//! as linear light, and handed over as sRGB.

use std::collections::HashSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use gltf::image::Data as Picture;
use gltf::mesh::Mode;
use gltf::{Document, Gltf, Node, Primitive, buffer, image};
use pointstage_plugin_api::glam::{DMat4, DVec3, Mat3, Vec3};
use pointstage_plugin_api::loading::{Claim, FileStart, Loader, Output, SourceFile};
use pointstage_plugin_api::{Error, Host, Progress, Result, Settings};

use crate::columns::Mesh;
use crate::texel::{srgb, texel};

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
        _settings: Settings<'_>,
        out: &mut Output<'_>,
        progress: &Progress<'_>,
    ) -> Result<()> {
        // The library takes some numbers of a damaged file as they are and stops in the middle, its own validation included.
        let read = catch_unwind(AssertUnwindSafe(|| read(file, out, progress)));
        let mesh = read.unwrap_or_else(|_| {
            Err(Error::failed(
                "the file is no sound glTF: numbers in it lead nowhere; it is damaged, export it again",
            ))
        })?;
        mesh.write(out, progress)
    }
}

/// The meshes of the scene as one.
fn read(file: &SourceFile<'_>, out: &mut Output<'_>, progress: &Progress<'_>) -> Result<Mesh> {
    let Gltf { document, blob } = Gltf::from_slice(file.bytes)
        .map_err(|error| Error::failed(format!("the file is no sound glTF: {error}")))?;
    let folder = file.path.parent();
    progress.set(0.05, "reading buffers");
    let buffers = gltf::import_buffers(&document, folder, blob)
        .map_err(|error| Error::failed(format!("a buffer cannot be read: {error}")))?;
    progress.check()?;
    let pictures = read_pictures(&document, folder, &buffers, out, progress)?;
    let mut reader = Reader {
        buffers: &buffers,
        pictures: &pictures,
        mesh: Mesh::default(),
        left_out: 0,
        out,
        progress,
    };
    reader.read_scene(&document)?;
    let Reader { mesh, left_out, .. } = reader;
    out.warn("a primitive of lines is left out", left_out);
    if mesh.positions.is_empty() {
        return Err(Error::failed(
            "the scene has no triangles and no points; there is nothing to show",
        ));
    }
    Ok(mesh)
}

/// The pictures that base colours take; none in place of one that cannot be read, which is a warning.
fn read_pictures(
    document: &Document,
    folder: Option<&Path>,
    buffers: &[buffer::Data],
    out: &mut Output<'_>,
    progress: &Progress<'_>,
) -> Result<Vec<Option<Picture>>> {
    let used: HashSet<usize> = document
        .materials()
        .filter_map(|material| material.pbr_metallic_roughness().base_color_texture())
        .map(|texture| texture.texture().source().index())
        .collect();
    let mut pictures = Vec::new();
    for picture in document.images() {
        progress.check()?;
        if !used.contains(&picture.index()) {
            pictures.push(None);
            continue;
        }
        match read_picture(picture.source(), folder, buffers) {
            Ok(picture) => pictures.push(Some(picture)),
            Err(error) => {
                out.warn(
                    &format!("a texture cannot be read ({error}): its colours are left out"),
                    1,
                );
                pictures.push(None);
            }
        }
    }
    Ok(pictures)
}

fn read_picture(
    source: image::Source<'_>,
    folder: Option<&Path>,
    buffers: &[buffer::Data],
) -> std::result::Result<Picture, String> {
    if let image::Source::View { view, .. } = &source {
        // The library takes a view's place in its buffer as given.
        let end = view.offset().checked_add(view.length());
        let buffer = buffers.get(view.buffer().index());
        let fits = buffer.is_some_and(|buffer| end.is_some_and(|end| end <= buffer.len()));
        if !fits {
            return Err("it lies outside its buffer".to_owned());
        }
    }
    Picture::from_source(source, folder, buffers).map_err(|error| error.to_string())
}

struct Reader<'r, 'o> {
    buffers: &'r [buffer::Data],
    pictures: &'r [Option<Picture>],
    mesh: Mesh,
    left_out: u64,
    out: &'r mut Output<'o>,
    progress: &'r Progress<'r>,
}

impl Reader<'_, '_> {
    fn read_scene(&mut self, document: &Document) -> Result<()> {
        let scene = document
            .default_scene()
            .or_else(|| document.scenes().next());
        let roots: Vec<Node<'_>> = match scene {
            Some(scene) => scene.nodes().collect(),
            None => document.nodes().collect(),
        };
        let total = document.nodes().count().max(1);
        // A node has one parent; a file that says otherwise is not walked in circles.
        let mut seen = HashSet::new();
        let mut open: Vec<(Node<'_>, DMat4)> = roots
            .into_iter()
            .map(|node| (node, DMat4::IDENTITY))
            .collect();
        while let Some((node, world_from_parent)) = open.pop() {
            if !seen.insert(node.index()) {
                continue;
            }
            self.progress.check()?;
            self.progress.set(
                0.2 + 0.8 * seen.len() as f32 / total as f32,
                "reading meshes",
            );
            let columns = node.transform().matrix();
            let local = DMat4::from_cols_array_2d(&columns.map(|column| column.map(f64::from)));
            let world_from_node = world_from_parent * local;
            for primitive in node.mesh().iter().flat_map(gltf::Mesh::primitives) {
                self.read_primitive(&primitive, world_from_node)?;
            }
            open.extend(node.children().map(|child| (child, world_from_node)));
        }
        Ok(())
    }

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
        let reader =
            primitive.reader(|buffer| self.buffers.get(buffer.index()).map(|data| &**data));
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
        let uvs: Vec<[f32; 2]> = texture
            .as_ref()
            .and_then(|texture| reader.read_tex_coords(texture.tex_coord()))
            .map(|uvs| uvs.into_f32().take(count).collect())
            .unwrap_or_default();
        let picture = texture
            .as_ref()
            .and_then(|texture| self.pictures.get(texture.texture().source().index()))
            .and_then(Option::as_ref)
            .filter(|_| !uvs.is_empty());
        let factor = pbr.base_color_factor();
        self.add_colours(first, &own, factor, picture, &uvs);
        let corners: Vec<u32> = match reader.read_indices() {
            Some(indices) => indices.into_u32().collect(),
            None => (0..count as u32).collect(),
        };
        let is_mirrored = world_from_node.determinant() < 0.0;
        self.add_triangles(mode, &corners, first, count, is_mirrored);
        Ok(())
    }

    /// Normals in the world; zeros for vertices without one, which the host replaces.
    fn add_normals(
        &mut self,
        normals: Option<impl Iterator<Item = [f32; 3]>>,
        first: usize,
        world_from_node: DMat4,
    ) {
        let count = self.mesh.positions.len();
        let normals = normals.into_iter().flatten();
        let linear = Mat3::from_mat4(world_from_node.as_mat4());
        let to_world = linear.inverse().transpose();
        // A matrix that flattens has no inverse: those normals are for the host to find.
        let transformed = normals.take(count - first).map(|normal| {
            let normal = to_world * Vec3::from_array(normal);
            normal.try_normalize().unwrap_or(Vec3::ZERO).to_array()
        });
        let mut transformed = transformed.peekable();
        if transformed.peek().is_some() || !self.mesh.normals.is_empty() {
            self.mesh.normals.resize(first, [0.0; 3]);
            self.mesh.normals.extend(transformed);
            self.mesh.normals.resize(count, [0.0; 3]);
        }
    }

    fn add_colours(
        &mut self,
        first: usize,
        own: &[[f32; 4]],
        factor: [f32; 4],
        picture: Option<&Picture>,
        uvs: &[[f32; 2]],
    ) {
        let count = self.mesh.positions.len();
        let is_plain = own.is_empty() && picture.is_none() && factor[..3] == [1.0; 3];
        if is_plain && self.mesh.colours.is_empty() {
            return;
        }
        self.mesh.colours.resize(first, [1.0; 3]);
        self.mesh.colours.extend((0..count - first).map(|vertex| {
            let own = own.get(vertex).copied().unwrap_or([1.0; 4]);
            let texel = picture
                .zip(uvs.get(vertex))
                .map(|(picture, uv)| texel(picture, *uv));
            let texel = texel.unwrap_or([1.0; 3]);
            std::array::from_fn(|channel| srgb(own[channel] * factor[channel] * texel[channel]))
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
