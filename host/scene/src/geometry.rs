//! Surfel columns of one object, in blocks, shared between threads.

use std::sync::{Arc, OnceLock};

use bytes::Bytes;
use glam::{DVec3, Vec3};
use pointstage_plugin_api::columns::{MAX_BLOCK_SURFELS, decode_normal};

use crate::bounds::Bounds;
use crate::framing::framed_bounds;
use crate::scene::Revision;
use crate::textures::Textures;

/// Everything that an object's surfels are made of. Columns sit behind `Arc`, so a clone is cheap and shares them.
#[derive(Clone, Debug)]
pub struct Geometry {
    /// Surfels, at most [`MAX_BLOCK_SURFELS`] each; only the last may be shorter. All have the same columns.
    pub blocks: Vec<Block>,
    /// Triangles; each names three surfels, counted over all blocks.
    pub triangles: Option<Arc<[[u32; 3]]>>,
    /// Pictures on the triangles, where the file had textures.
    pub textures: Option<Arc<Textures>>,
    /// Box around the centres, local: f32 values, relative to the object's origin.
    pub bounds: Bounds,
    /// Surfels in all blocks.
    pub surfel_count: usize,
    /// Where normals, radii and colours came from.
    pub origins: Origins,
    /// Changes with every change of the above.
    pub revision: Revision,
    /// The box to frame, once somebody asked for it.
    pub(crate) framed: OnceLock<Bounds>,
}

/// A run of surfels, column by column; all columns have the same length.
#[derive(Clone, Debug, Default)]
pub struct Block {
    /// Centre (xyz, relative to the object's origin) and radius (w), scene units. Radius 0 means: not known.
    pub position_radius: Arc<[[f32; 4]]>,
    /// Unit normals, packed by `pointstage_plugin_api::columns::encode_normal`.
    pub normal: Option<Arc<[u32]>>,
    /// sRGB with straight alpha, packed by `pointstage_plugin_api::columns::encode_colour`.
    pub colour: Option<Arc<[u32]>>,
    /// Tangent half-axes u.xyz, 0, v.xyz, 0, scene units.
    pub axes: Option<Arc<[[f32; 8]]>>,
    /// Whatever else the file had.
    pub named: Vec<NamedColumn>,
}

/// A column that has a name and a type of the file's own: intensity, confidence, time, opacity …
#[derive(Clone, Debug, PartialEq)]
pub struct NamedColumn {
    /// The file's name for it.
    pub name: Arc<str>,
    /// Type of one component.
    pub scalar: ScalarType,
    /// Components a surfel.
    pub components: u32,
    /// The values, native byte order, surfel by surfel. Columns that were loaded together share one piece of memory.
    pub bytes: Bytes,
}

/// Type of a scalar in a file or a named column.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ScalarType {
    /// Signed 8 bits.
    I8,
    /// Unsigned 8 bits.
    U8,
    /// Signed 16 bits.
    I16,
    /// Unsigned 16 bits.
    U16,
    /// Signed 32 bits.
    I32,
    /// Unsigned 32 bits.
    U32,
    /// IEEE 754, 32 bits.
    F32,
    /// IEEE 754, 64 bits.
    F64,
}

/// Where a column's values came from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Provenance {
    /// Nobody gave them; renderers take a default.
    #[default]
    Missing,
    /// The file held them.
    FromFile,
    /// Computed from the faces of the mesh.
    FromFaces,
    /// Estimated from neighbouring surfels; normals have an arbitrary sign and are lit from both sides.
    Estimated,
    /// Normals estimated from neighbouring surfels and brought to one side all over the object; lit from that side.
    Oriented,
}

/// Provenance of each column that may be missing or made up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Origins {
    /// Of [`Block::normal`].
    pub normals: Provenance,
    /// Of the radii in [`Block::position_radius`].
    pub radii: Provenance,
    /// Of [`Block::colour`].
    pub colours: Provenance,
    /// Of [`Block::axes`].
    pub axes: Provenance,
}

impl Origins {
    /// Of columns that are all in the file.
    pub const FROM_FILE: Self = Self {
        normals: Provenance::FromFile,
        radii: Provenance::FromFile,
        colours: Provenance::FromFile,
        axes: Provenance::FromFile,
    };
}

impl ScalarType {
    /// Bytes of one value.
    pub const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// Short name: `u8` … `f64`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::I8 => "i8",
            Self::U8 => "u8",
            Self::I16 => "i16",
            Self::U16 => "u16",
            Self::I32 => "i32",
            Self::U32 => "u32",
            Self::F32 => "f32",
            Self::F64 => "f64",
        }
    }

    /// One value from the start of `bytes`, native byte order; `None` if there are too few bytes.
    pub fn read(self, bytes: &[u8]) -> Option<f64> {
        Some(match self {
            Self::I8 => f64::from(i8::from_ne_bytes(*bytes.first_chunk()?)),
            Self::U8 => f64::from(u8::from_ne_bytes(*bytes.first_chunk()?)),
            Self::I16 => f64::from(i16::from_ne_bytes(*bytes.first_chunk()?)),
            Self::U16 => f64::from(u16::from_ne_bytes(*bytes.first_chunk()?)),
            Self::I32 => f64::from(i32::from_ne_bytes(*bytes.first_chunk()?)),
            Self::U32 => f64::from(u32::from_ne_bytes(*bytes.first_chunk()?)),
            Self::F32 => f64::from(f32::from_ne_bytes(*bytes.first_chunk()?)),
            Self::F64 => f64::from_ne_bytes(*bytes.first_chunk()?),
        })
    }
}

impl NamedColumn {
    /// Component `component` of surfel `surfel_index`; `None` outside the column.
    pub fn value(&self, surfel_index: usize, component: u32) -> Option<f64> {
        if component >= self.components {
            return None;
        }
        let start =
            (surfel_index * self.components as usize + component as usize) * self.scalar.size();
        self.scalar.read(self.bytes.get(start..)?)
    }
}

impl Block {
    /// Surfels in the block.
    pub fn len(&self) -> usize {
        self.position_radius.len()
    }

    /// True when the block holds no surfel.
    pub fn is_empty(&self) -> bool {
        self.position_radius.is_empty()
    }

    /// Centre of a surfel, relative to the object's origin.
    ///
    /// # Panics
    /// If `surfel_index` is not below [`len`](Self::len).
    pub fn centre(&self, surfel_index: usize) -> Vec3 {
        let [x, y, z, _] = self.position_radius[surfel_index];
        Vec3::new(x, y, z)
    }

    /// Normal of a surfel, if the block has normals.
    pub fn normal_at(&self, surfel_index: usize) -> Option<Vec3> {
        Some(decode_normal(*self.normal.as_ref()?.get(surfel_index)?))
    }
}

impl Geometry {
    /// Geometry of `blocks`; counts the surfels and measures the box.
    pub fn new(blocks: Vec<Block>, triangles: Option<Arc<[[u32; 3]]>>, origins: Origins) -> Self {
        let bounds = blocks
            .iter()
            .flat_map(|block| block.position_radius.iter())
            .fold(
                (Vec3::INFINITY, Vec3::NEG_INFINITY),
                |(min, max), &[x, y, z, _]| {
                    let centre = Vec3::new(x, y, z);
                    (min.min(centre), max.max(centre))
                },
            );
        let surfel_count = blocks.iter().map(Block::len).sum();
        let bounds = Bounds::new(bounds.0.as_dvec3(), bounds.1.as_dvec3());
        Self {
            blocks,
            triangles,
            textures: None,
            bounds,
            surfel_count,
            origins,
            revision: Revision::next(),
            framed: OnceLock::new(),
        }
    }

    /// Box around the centres that a picture should show, local: all of them, but for points of a point set that stray far
    /// from all others (see `framing`).
    pub fn framed_bounds(&self) -> Bounds {
        *self.framed.get_or_init(|| framed_bounds(self))
    }

    /// Block and index in it of a surfel counted over all blocks.
    pub fn locate(&self, surfel_index: usize) -> Option<(&Block, usize)> {
        let block = self.blocks.get(surfel_index / MAX_BLOCK_SURFELS)?;
        let inside = surfel_index % MAX_BLOCK_SURFELS;
        (inside < block.len()).then_some((block, inside))
    }

    /// Centre of a surfel counted over all blocks, relative to the object's origin.
    pub fn centre(&self, surfel_index: usize) -> Option<DVec3> {
        self.locate(surfel_index)
            .map(|(block, inside)| block.centre(inside).as_dvec3())
    }

    /// Triangles, 0 for a point set.
    pub fn triangle_count(&self) -> usize {
        self.triangles
            .as_ref()
            .map_or(0, |triangles| triangles.len())
    }

    /// Bytes of all columns, triangles and textures.
    pub fn byte_count(&self) -> usize {
        self.columns().map(|(_, bytes)| bytes).sum()
    }

    /// Address and size in bytes of every column, of the triangles and of their textures. Geometries that share a column give the same
    /// address for it.
    pub fn columns(&self) -> impl Iterator<Item = (usize, usize)> {
        fn part<T>(column: &[T]) -> (usize, usize) {
            (column.as_ptr().addr(), size_of_val(column))
        }
        let of_block = |block: &Block| {
            let Block {
                position_radius,
                normal,
                colour,
                axes,
                named,
            } = block;
            let standard = [
                Some(part(position_radius)),
                normal.as_deref().map(part),
                colour.as_deref().map(part),
                axes.as_deref().map(part),
            ];
            let named: Vec<_> = named.iter().map(|column| part(&column.bytes)).collect();
            standard.into_iter().flatten().chain(named)
        };
        let textures = self.textures.iter().flat_map(|textures| {
            let on_triangles = [part(&textures.of_triangle), part(&textures.uvs)];
            let files = textures.pictures.iter().map(|picture| part(&picture.bytes));
            on_triangles.into_iter().chain(files)
        });
        self.blocks
            .iter()
            .flat_map(of_block)
            .chain(self.triangles.as_deref().map(part))
            .chain(textures)
    }

    /// Takes a new revision; call after changing anything.
    pub fn touch(&mut self) {
        self.revision = Revision::next();
        self.framed = OnceLock::new();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(centres: &[[f32; 3]]) -> Block {
        Block {
            position_radius: centres.iter().map(|&[x, y, z]| [x, y, z, 1.0]).collect(),
            ..Block::default()
        }
    }

    #[test]
    fn counts_and_bounds_run_over_all_blocks() {
        let blocks = vec![
            block(&[[0.0, 1.0, 2.0], [-1.0, 0.0, 0.0]]),
            block(&[[5.0, 5.0, 5.0]]),
        ];
        let geometry = Geometry::new(blocks, None, Origins::default());
        assert_eq!(
            (
                geometry.surfel_count,
                geometry.triangle_count(),
                geometry.byte_count()
            ),
            (3, 0, 48)
        );
        assert_eq!(
            geometry.bounds,
            Bounds::new(DVec3::new(-1.0, 0.0, 0.0), DVec3::splat(5.0))
        );
    }

    #[test]
    fn geometry_of_nothing_is_empty() {
        let geometry = Geometry::new(Vec::new(), None, Origins::default());
        assert!(geometry.bounds.is_empty() && geometry.locate(0).is_none());
    }

    #[test]
    fn named_values_read_by_surfel_and_component() {
        let bytes: Vec<u8> = [1_i16, -2, 3, -4]
            .iter()
            .flat_map(|value| value.to_ne_bytes())
            .collect();
        let column = NamedColumn {
            name: "pair".into(),
            scalar: ScalarType::I16,
            components: 2,
            bytes: bytes.into(),
        };
        assert_eq!(column.value(1, 1), Some(-4.0));
        assert_eq!((column.value(2, 0), column.value(0, 2)), (None, None));
    }
}
