//! The columns of an object as writers take them.

use glam::{DAffine3, DMat3, DVec3, Vec3};
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

/// Brings columns into another space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moved {
    to: DAffine3,
    normals: DMat3,
    /// −1 where the map is a mirror: the axes' cross product must stay the normal.
    pub(super) mirror: f64,
    radius_scale: f64,
}

impl Moved {
    /// By the map `to`; radii by the cube root of its determinant.
    pub(super) fn new(to: DAffine3) -> Self {
        let determinant = to.matrix3.determinant();
        Self {
            to,
            normals: to.matrix3.inverse().transpose(),
            mirror: if determinant < 0.0 { -1.0 } else { 1.0 },
            radius_scale: determinant.abs().cbrt(),
        }
    }

    pub(super) fn position(&self, position: DVec3) -> DVec3 {
        self.to.transform_point3(position)
    }

    pub(super) fn normal(&self, normal: Vec3) -> Vec3 {
        let moved = self.normals * normal.as_dvec3();
        moved.normalize_or_zero().as_vec3()
    }

    pub(super) fn axes(&self, [u, v]: [Vec3; 2]) -> [Vec3; 2] {
        let moved = |axis: Vec3| self.to.matrix3 * axis.as_dvec3();
        [moved(u).as_vec3(), (moved(v) * self.mirror).as_vec3()]
    }

    pub(super) fn radius(&self, radius: f32) -> f32 {
        (f64::from(radius) * self.radius_scale) as f32
    }
}
