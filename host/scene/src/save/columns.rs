//! The columns of an object as writers take them.

use glam::Vec3;
use pointstage_plugin_api::columns::{NO_NORMAL, TangentAxes, decode_normal};

use crate::geometry::{Block, Geometry, NamedColumn, Provenance};

/// Which columns an object has.
#[derive(Clone, Debug)]
pub(super) struct Present<'a> {
    pub(super) normals: bool,
    pub(super) radii: bool,
    pub(super) colours: bool,
    pub(super) axes: bool,
    /// Those of the first block: all blocks have the same.
    pub(super) named: &'a [NamedColumn],
}

impl<'a> Present<'a> {
    pub(super) fn of(geometry: &'a Geometry) -> Self {
        let has = |column: fn(&Block) -> bool| {
            !geometry.blocks.is_empty() && geometry.blocks.iter().all(column)
        };
        Self {
            normals: has(|block| block.normal.is_some()),
            radii: geometry.origins.radii != Provenance::Missing,
            colours: has(|block| block.colour.is_some()),
            axes: has(|block| block.axes.is_some()),
            named: geometry
                .blocks
                .first()
                .map_or(&[], |block| block.named.as_slice()),
        }
    }
}

/// A normal as it is written; zero if it is not known.
pub(super) fn normal_of(block: &Block, surfel: usize) -> Vec3 {
    match block
        .normal
        .as_ref()
        .and_then(|normals| normals.get(surfel))
    {
        None | Some(&NO_NORMAL) => Vec3::ZERO,
        Some(&packed) => decode_normal(packed),
    }
}

/// Tangent half-axes; zero if there are none.
pub(super) fn axes_of(block: &Block, surfel: usize) -> [Vec3; 2] {
    let axes = block.axes.as_ref().and_then(|axes| axes.get(surfel));
    let axes = TangentAxes(axes.copied().unwrap_or_default());
    [axes.u(), axes.v()]
}

/// The bytes of a surfel in a named column.
pub(super) fn bytes_of(column: &NamedColumn, surfel: usize) -> &[u8] {
    let width = column.scalar.size() * column.components as usize;
    column
        .bytes
        .get(surfel * width..(surfel + 1) * width)
        .unwrap_or_default()
}
