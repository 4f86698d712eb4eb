//! Scenes of glTF without colours and textures, as scanners and simulations write them: handed over from where they lie in the
//! file, in runs, so that memory holds the host's columns and no others.

use gltf::accessor::{DataType, Dimensions};
use gltf::mesh::{Mode, Semantic};
use pointstage_plugin_api::glam::{DMat4, DVec3};
use pointstage_plugin_api::loading::{Column, Output, bytes_of};
use pointstage_plugin_api::{Progress, Result};

use crate::gltf_buffers::Buffers;
use crate::gltf_nodes::{Part, Parts, world_normals};

/// Vertices, or triangles, handed over at once: what is made of them stays in the second-level cache.
const RUN: usize = 1 << 14;

/// A scene of more parts is read in the other way, which keeps none.
const MOST_PARTS: usize = 1 << 16;

/// Meshes that are nothing but positions, normals and triangles.
pub(crate) struct Plain<'b> {
    parts: Vec<PlainPart<'b>>,
}

/// One of them; all bytes are little-endian.
struct PlainPart<'b> {
    world_from_node: DMat4,
    positions: &'b [[u8; 12]],
    /// As many as positions.
    normals: Option<&'b [[u8; 12]]>,
    corners: Corners<'b>,
}

/// Corners of triangles, counted from the part's first vertex.
enum Corners<'b> {
    /// The part is points.
    None,
    /// Every three vertices are a triangle.
    InOrder,
    U16(&'b [[u8; 6]]),
    U32(&'b [[u8; 12]]),
}

impl<'b> Plain<'b> {
    /// The parts, if there is nothing else in them.
    pub(crate) fn of(all: Parts<'_>, buffers: &'b Buffers<'_>) -> Option<Self> {
        let mut parts = Vec::new();
        for part in all {
            parts.push(PlainPart::of(&part, buffers)?);
            if parts.len() > MOST_PARTS {
                return None;
            }
        }
        let has_vertices = parts.iter().any(|part| !part.positions.is_empty());
        has_vertices.then_some(Self { parts })
    }

    /// Hands everything over.
    pub(crate) fn write(&self, out: &mut Output<'_>, progress: &Progress<'_>) -> Result<()> {
        let total: usize = self.parts.iter().map(|part| part.positions.len()).sum();
        let has_normals = self.parts.iter().any(|part| part.normals.is_some());
        // What no node moves keeps its type.
        let is_moved = self
            .parts
            .iter()
            .any(|part| part.world_from_node != DMat4::IDENTITY);
        let mut columns = vec![if is_moved {
            Column::POSITION_F64
        } else {
            Column::POSITION_F32
        }];
        columns.extend(has_normals.then_some(Column::NORMAL_F32));
        out.columns(&columns, total as u64)?;
        let mut done = 0;
        for part in &self.parts {
            for start in (0..part.positions.len()).step_by(RUN) {
                progress.check()?;
                progress.set(
                    0.1 + 0.9 * (done + start) as f32 / total as f32,
                    "reading meshes",
                );
                part.write_run(start, is_moved, has_normals, out)?;
            }
            part.write_triangles(done, self.parts.len() == 1, out, progress)?;
            done += part.positions.len();
        }
        Ok(())
    }
}

impl<'b> PlainPart<'b> {
    fn of(part: &Part<'_>, buffers: &'b Buffers<'_>) -> Option<Self> {
        let primitive = &part.primitive;
        let pbr = primitive.material().pbr_metallic_roughness();
        let is_plain = primitive
            .attributes()
            .all(|(semantic, _)| !matches!(semantic, Semantic::Colors(_) | Semantic::TexCoords(_)));
        let [red, green, blue, _] = pbr.base_color_factor();
        if !is_plain || [red, green, blue] != [1.0; 3] {
            return None;
        }
        let three = |semantic: &Semantic| {
            let accessor = primitive.get(semantic)?;
            let bytes = buffers.packed(&accessor, DataType::F32, Dimensions::Vec3);
            Some(bytes.map(|bytes| bytes.as_chunks::<12>().0))
        };
        let positions = three(&Semantic::Positions)??;
        let normals = match three(&Semantic::Normals) {
            None => None,
            Some(normals) => Some(normals.filter(|normals| normals.len() == positions.len())?),
        };
        let corners = match (primitive.mode(), primitive.indices()) {
            (Mode::Points, _) => Corners::None,
            (Mode::Triangles, None) => Corners::InOrder,
            (Mode::Triangles, Some(indices)) => {
                let bytes = |of_type| buffers.packed(&indices, of_type, Dimensions::Scalar);
                match (bytes(DataType::U16), bytes(DataType::U32)) {
                    (Some(bytes), _) => Corners::U16(bytes.as_chunks().0),
                    (_, Some(bytes)) => Corners::U32(bytes.as_chunks().0),
                    (None, None) => return None,
                }
            }
            _ => return None,
        };
        Some(Self {
            world_from_node: part.world_from_node,
            positions,
            normals,
            corners,
        })
    }

    /// Hands over vertices from `start` on.
    fn write_run(
        &self,
        start: usize,
        is_moved: bool,
        has_normals: bool,
        out: &mut Output<'_>,
    ) -> Result<()> {
        let range = start..self.positions.len().min(start + RUN);
        let read = |bytes: &'b [[u8; 12]]| -> Vec<[f32; 3]> {
            bytes[range.clone()].iter().map(floats).collect()
        };
        let positions = read(self.positions);
        let in_world: Vec<[f64; 3]> = if is_moved {
            let place = |place: &[f32; 3]| {
                let place = DVec3::from_array(place.map(f64::from));
                self.world_from_node.transform_point3(place).to_array()
            };
            positions.iter().map(place).collect()
        } else {
            Vec::new()
        };
        let mut columns = vec![if is_moved {
            bytes_of(&in_world)
        } else {
            bytes_of(&positions)
        }];
        let normals = match self.normals {
            Some(normals) if self.world_from_node == DMat4::IDENTITY => read(normals),
            Some(normals) => {
                let in_node = read(normals).into_iter();
                world_normals(in_node, self.world_from_node).collect()
            }
            // The host replaces them.
            None if has_normals => vec![[0.0; 3]; range.len()],
            None => Vec::new(),
        };
        if has_normals {
            columns.push(bytes_of(&normals));
        }
        out.rows(range.len(), &columns)
    }

    /// Hands over the triangles of a part whose first vertex is `first`.
    fn write_triangles(
        &self,
        first: usize,
        is_only: bool,
        out: &mut Output<'_>,
        progress: &Progress<'_>,
    ) -> Result<()> {
        let count = self.positions.len();
        let vertex = |corner: u32| {
            let vertex = first + corner as usize;
            if (corner as usize) < count {
                u32::try_from(vertex).unwrap_or(u32::MAX)
            } else {
                u32::MAX
            }
        };
        let is_mirrored = self.world_from_node.determinant() < 0.0;
        let turned = |[a, b, c]: [u32; 3]| {
            let [b, c] = if is_mirrored { [c, b] } else { [b, c] };
            [a, b, c].map(vertex)
        };
        match self.corners {
            Corners::None => Ok(()),
            Corners::InOrder => {
                let triangle = |index: usize| {
                    let corner = 3 * index as u32;
                    turned([corner, corner + 1, corner + 2])
                };
                write_in_runs(count / 3, triangle, out, progress)
            }
            Corners::U16(corners) => {
                let triangle = |index: usize| turned(shorts(corners[index]).map(u32::from));
                write_in_runs(corners.len(), triangle, out, progress)
            }
            Corners::U32(corners) => {
                // Corners of the only part are those of the whole; what names no vertex does so as it is.
                if is_only
                    && !is_mirrored
                    && cfg!(target_endian = "little")
                    && let Ok(triangles) = bytemuck::try_cast_slice(corners)
                {
                    return out.triangles(triangles);
                }
                let triangle = |index: usize| turned(words(&corners[index]));
                write_in_runs(corners.len(), triangle, out, progress)
            }
        }
    }
}

fn write_in_runs(
    count: usize,
    triangle: impl Fn(usize) -> [u32; 3],
    out: &mut Output<'_>,
    progress: &Progress<'_>,
) -> Result<()> {
    for start in (0..count).step_by(RUN) {
        progress.check()?;
        let range = start..count.min(start + RUN);
        out.triangles(&range.map(&triangle).collect::<Vec<_>>())?;
    }
    Ok(())
}

fn floats(bytes: &[u8; 12]) -> [f32; 3] {
    words(bytes).map(f32::from_bits)
}

fn words(&[a, b, c, d, e, f, g, h, i, j, k, l]: &[u8; 12]) -> [u32; 3] {
    [[a, b, c, d], [e, f, g, h], [i, j, k, l]].map(u32::from_le_bytes)
}

fn shorts([a, b, c, d, e, f]: [u8; 6]) -> [u16; 3] {
    [[a, b], [c, d], [e, f]].map(u16::from_le_bytes)
}
