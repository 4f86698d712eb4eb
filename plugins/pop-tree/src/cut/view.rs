//! One view of a tree.

use super::judge::{Open, Verdict};
use crate::node::Grid;
use crate::tree::Tree;
use bytemuck::{Pod, Zeroable};
use core::f32::consts::FRAC_PI_2;
use pointstage_plugin_api::glam::{Mat3, Mat4, Vec3, Vec4};

/// Planes of the view frustum, at most.
pub(super) const PLANE_COUNT: usize = 6;

/// The camera, as a cut needs it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// View space from the tree's object space; affine.
    pub view_from_object: Mat4,
    /// Clip space of the picture, or of the tile of it that is drawn, from view space.
    pub clip_from_view: Mat4,
    /// Pixels of that picture or tile.
    pub size_px: [f32; 2],
    /// Pixels that one unit across the view covers, at distance 1 unless orthographic.
    pub pixels_per_unit: f32,
    /// Whether all rays are parallel.
    pub is_orthographic: bool,
    /// Above this width on the screen a node is not a splat; px, above 0.
    pub threshold_px: f32,
    /// Whether nodes that are turned away are left out.
    pub cull_backs: bool,
    /// Whether the nodes' normals point inward, so that what faces the eye by them is turned away.
    pub is_inward: bool,
}

/// One view of a tree.
#[derive(Clone, Debug)]
#[expect(clippy::struct_field_names, reason = "names say their space")]
pub struct View {
    pub(super) projection: Projection,
    pub(super) origin_view: Vec3,
    /// Columns: view space from steps of the grid.
    pub(super) view_from_grid: Mat3,
    pub(super) grid: Grid,
    /// The eye, or the unit direction to it if orthographic; object space.
    pub(super) eye_object: Vec3,
    /// Greatest factor of a length from object space to view space.
    pub(super) stretch: f32,
    /// A node is larger than the threshold if its radius times this exceeds its distance.
    pub(super) reach: f32,
    /// Unit inward normals and offsets; view space.
    pub(super) planes: [Vec4; PLANE_COUNT],
    /// A bit for each plane that there is.
    pub(super) plane_bits: u8,
    /// Cosine and sine of each code of a cone's half-angle.
    pub(super) cones: &'static [[f32; 2]; 256],
}

/// A view as `shaders/pop/judge.wesl` reads it, `JudgeUniform`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ViewWords {
    origin_view: [f32; 3],
    stretch: f32,
    x_view: [f32; 3],
    reach: f32,
    y_view: [f32; 3],
    step: f32,
    z_view: [f32; 3],
    normal_sign: f32,
    from_eye: [f32; 3],
    is_orthographic: u32,
    planes: [[f32; 4]; PLANE_COUNT],
    cones: [[f32; 2]; 256],
}

/// What becomes of a tree's root.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Root {
    /// Nothing of the tree can be seen.
    Culled,
    /// It is a splat.
    Splat,
    /// It is a leaf and large: this triangle.
    Triangle(u32),
    /// Its children decide; what is left open for them, as `shaders/pop/judge.wesl` has it.
    Open(u32),
}

impl View {
    /// A projection's view of a tree on this grid.
    pub fn new(projection: &Projection, grid: &Grid) -> Self {
        let matrix = projection.view_from_object;
        let linear = Mat3::from_mat4(matrix);
        let object_from_view = matrix.inverse();
        let k = projection.pixels_per_unit * 2.0 / projection.threshold_px;
        let (planes, plane_bits) = planes_of(projection);
        Self {
            projection: *projection,
            origin_view: matrix.transform_point3(Vec3::from_array(grid.origin)),
            view_from_grid: linear * grid.step,
            grid: *grid,
            eye_object: if projection.is_orthographic {
                object_from_view
                    .transform_vector3(Vec3::Z)
                    .normalize_or_zero()
            } else {
                object_from_view.transform_point3(Vec3::ZERO)
            },
            stretch: greatest_stretch(linear),
            reach: if projection.is_orthographic {
                k
            } else {
                k + 1.0
            },
            planes,
            plane_bits,
            cones: cone_table(),
        }
    }

    /// The projection that it was made of.
    pub fn projection(&self) -> &Projection {
        &self.projection
    }

    /// Greatest factor of a length from object space to view space.
    pub fn stretch(&self) -> f32 {
        self.stretch
    }

    /// The eye, or the unit direction to it if orthographic; object space.
    pub fn eye_object(&self) -> Vec3 {
        self.eye_object
    }

    /// The view as the device's selection reads it.
    pub fn words(&self) -> ViewWords {
        let from_eye = if self.projection.is_orthographic {
            -self.eye_object
        } else {
            Vec3::from_array(self.grid.origin) - self.eye_object
        };
        // A plane that there is not is never crossed.
        let planes = core::array::from_fn(|number| {
            let is_there = self.plane_bits >> number & 1 != 0;
            if is_there {
                self.planes[number].to_array()
            } else {
                [0.0; 4]
            }
        });
        ViewWords {
            origin_view: self.origin_view.to_array(),
            stretch: self.stretch,
            x_view: self.view_from_grid.x_axis.to_array(),
            reach: self.reach,
            y_view: self.view_from_grid.y_axis.to_array(),
            step: self.grid.step,
            z_view: self.view_from_grid.z_axis.to_array(),
            normal_sign: self.normal_sign(),
            from_eye: from_eye.to_array(),
            is_orthographic: self.projection.is_orthographic.into(),
            planes,
            cones: *self.cones,
        }
    }

    /// What becomes of the tree's root; the tree is on the view's grid.
    pub fn root(&self, tree: &Tree) -> Root {
        let Some(root) = tree.nodes.first() else {
            return Root::Culled;
        };
        let answers = self.judge::<false>(core::slice::from_ref(root), self.all_open());
        match answers.of(0) {
            (Verdict::Culled, _) => Root::Culled,
            (Verdict::Small, _) => Root::Splat,
            (Verdict::Large, _) if tree.first_leaf() == 0 => Root::Triangle(root.link()),
            (Verdict::Large, open) => {
                Root::Open(u32::from(open.planes) | u32::from(open.is_cone_open) << PLANE_COUNT)
            }
        }
    }

    /// 1, or -1 where normals point inward.
    pub(super) fn normal_sign(&self) -> f32 {
        if self.projection.is_inward { -1.0 } else { 1.0 }
    }

    /// What the root is asked.
    pub(crate) fn all_open(&self) -> Open {
        Open {
            planes: self.plane_bits,
            is_cone_open: self.projection.cull_backs,
        }
    }
}

/// Planes of the frustum: left, right, bottom, top, near, far; and a bit for each that there is.
///
/// The four sides stand off, so that the splat of a node outside never reaches the picture.
fn planes_of(projection: &Projection) -> ([Vec4; PLANE_COUNT], u8) {
    let rows = projection.clip_from_view.transpose();
    let [x, y, z, w] = [rows.x_axis, rows.y_axis, rows.z_axis, rows.w_axis];
    let margin_px = 2.0 * projection.threshold_px + 1.0;
    let [wide, high] = projection
        .size_px
        .map(|size| w * (1.0 + 2.0 * margin_px / size.max(1.0)));
    // Depth is reversed: the near plane is at 1, the far plane at 0.
    let planes = [wide + x, wide - x, high + y, high - y, w - z, z];
    let mut bits = 0;
    let unit = core::array::from_fn(|number| {
        let plane: Vec4 = planes[number];
        let length = plane.truncate().length();
        // An infinite far plane has no direction.
        if length > 1e-12 {
            bits |= 1 << number;
            plane / length
        } else {
            Vec4::ZERO
        }
    });
    (unit, bits)
}

/// The greatest singular value, never too small.
fn greatest_stretch(linear: Mat3) -> f32 {
    // A high power of the matrix leaves of any vector the direction that is stretched most.
    let mut power = linear.transpose() * linear;
    for _ in 0..12 {
        let greatest = power
            .to_cols_array()
            .into_iter()
            .fold(0.0, |a: f32, b| a.max(b.abs()));
        power *= 1.0 / greatest.max(f32::MIN_POSITIVE);
        power *= power;
    }
    let columns = [linear.x_axis, linear.y_axis, linear.z_axis];
    let longest = columns.into_iter().map(Vec3::length).fold(0.0, f32::max);
    let along = |start: Vec3| (linear * (power * start).normalize_or_zero()).length();
    let stretch = [Vec3::X, Vec3::Y, Vec3::Z]
        .map(along)
        .into_iter()
        .fold(longest, f32::max);
    // The power comes from below.
    stretch * (1.0 + 1e-5)
}

/// Cosine and sine of every code.
fn cone_table() -> &'static [[f32; 2]; 256] {
    static TABLE: std::sync::OnceLock<[[f32; 2]; 256]> = std::sync::OnceLock::new();
    TABLE.get_or_init(|| {
        core::array::from_fn(|code| {
            let half_angle = crate::node::decode_half_angle(code as u8).min(FRAC_PI_2);
            let (sine, cosine) = half_angle.sin_cos();
            [cosine, sine]
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use pointstage_plugin_api::glam::Quat;

    #[test]
    fn the_stretch_is_the_longest_half_axis_of_the_unit_spheres_image() {
        for (scale, turn) in [
            (Vec3::new(1.0, 1.0, 1.0), 0.3),
            (Vec3::new(2.0, 1.99, 1.98), 0.7),
            (Vec3::new(-0.3, 0.2, 0.35), 1.1),
            (Vec3::new(1e-6, 3e-6, 2e-6), 0.1),
            (Vec3::new(4e5, 1.0, 1e-3), 2.0),
        ] {
            let turn = Mat3::from_quat(Quat::from_euler(
                pointstage_plugin_api::glam::EulerRot::XYZ,
                turn,
                0.4,
                0.9,
            ));
            let linear = turn * Mat3::from_diagonal(scale) * turn.transpose();
            let expected = scale.abs().max_element();
            let found = greatest_stretch(linear);
            assert!((found / expected - 1.0).abs() < 1e-4, "{found}, {expected}");
            assert!(found >= expected * (1.0 - 1e-6), "{found}, {expected}");
        }
    }
}
