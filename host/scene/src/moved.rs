//! Surfels brought into another space: by a transform, into a file or into another object.

use glam::{DAffine3, DMat3, DVec3, Vec3};

/// Brings columns into another space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moved {
    to: DAffine3,
    normals: DMat3,
    /// −1 where the map is a mirror: the axes' cross product must stay the normal.
    pub(crate) mirror: f64,
    radius_scale: f64,
}

impl Moved {
    /// By the map `to`; radii by the cube root of its determinant.
    pub(crate) fn new(to: DAffine3) -> Self {
        let determinant = to.matrix3.determinant();
        Self {
            to,
            normals: to.matrix3.inverse().transpose(),
            mirror: if determinant < 0.0 { -1.0 } else { 1.0 },
            radius_scale: determinant.abs().cbrt(),
        }
    }

    pub(crate) fn position(&self, position: DVec3) -> DVec3 {
        self.to.transform_point3(position)
    }

    pub(crate) fn normal(&self, normal: Vec3) -> Vec3 {
        let moved = self.normals * normal.as_dvec3();
        moved.normalize_or_zero().as_vec3()
    }

    pub(crate) fn axes(&self, [u, v]: [Vec3; 2]) -> [Vec3; 2] {
        let moved = |axis: Vec3| self.to.matrix3 * axis.as_dvec3();
        [moved(u).as_vec3(), (moved(v) * self.mirror).as_vec3()]
    }

    pub(crate) fn radius(&self, radius: f32) -> f32 {
        (f64::from(radius) * self.radius_scale) as f32
    }
}
