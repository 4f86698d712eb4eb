//! One view of a tree, and what it makes of a node.

use crate::node::{Grid, NO_CONE, Node};
use core::f32::consts::FRAC_PI_2;
use pointstage_plugin_api::glam::{Mat3, Mat4, Vec3, Vec4};

/// Planes of the view frustum, at most.
const PLANE_COUNT: usize = 6;

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
}

/// One view of a tree.
#[derive(Clone, Debug)]
pub struct View {
    projection: Projection,
    origin_view: Vec3,
    /// Columns: view space from steps of the grid.
    view_from_grid: Mat3,
    grid: Grid,
    /// The eye, or the unit direction to it if orthographic; object space.
    eye_object: Vec3,
    /// Greatest factor of a length from object space to view space.
    stretch: f32,
    /// A node is larger than the threshold if its radius times this exceeds its distance.
    reach: f32,
    /// Unit inward normals and offsets; view space.
    planes: [Vec4; PLANE_COUNT],
    /// A bit for each plane that there is.
    plane_bits: u8,
    /// Cosine and sine of each code of a cone's half-angle.
    cones: &'static [[f32; 2]; 256],
}

/// What is asked of a node is less if an ancestor settled it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Open {
    /// Planes that the node may still cross.
    pub(crate) planes: u8,
    /// Whether it may still be turned away, in part or wholly.
    pub(crate) is_cone_open: bool,
}

/// What becomes of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Nothing of it can be seen.
    Culled,
    /// It is at most as wide as the threshold.
    Small,
    /// It is wider.
    Large,
}

/// How far the camera may move until a verdict may change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slack {
    /// Motion of points in view space; scene units.
    pub(crate) view: f32,
    /// Motion of the eye in object space; units of that space.
    pub(crate) eye: f32,
}

impl Slack {
    pub(crate) const ENDLESS: Self = Self {
        view: f32::INFINITY,
        eye: f32::INFINITY,
    };
}

/// The answer about a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Judged {
    pub(crate) verdict: Verdict,
    /// What its children still have to be asked.
    pub(crate) open: Open,
    /// [`Slack::ENDLESS`] unless asked for.
    pub(crate) slack: Slack,
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
                object_from_view.transform_vector3(Vec3::Z).normalize_or_zero()
            } else {
                object_from_view.transform_point3(Vec3::ZERO)
            },
            stretch: greatest_stretch(linear),
            reach: if projection.is_orthographic { k } else { k + 1.0 },
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

    /// See the field.
    pub(crate) fn eye_object(&self) -> Vec3 {
        self.eye_object
    }

    /// What the root is asked.
    pub(crate) fn all_open(&self) -> Open {
        Open {
            planes: self.plane_bits,
            is_cone_open: self.projection.cull_backs,
        }
    }

    /// What becomes of a node, given what its ancestors left open; with the slack of the answer if `SLACK`.
    ///
    /// A node's width on the screen is taken as 2·r·d / (z − r), r its radius, z its depth, d the pixels a unit covers at depth
    /// 1: for small spheres that is 2·r·d / z, the size of a splat in Chen and Nguyen's system. No child's is greater than its parent's, since a
    /// child's sphere lies inside.
    #[inline(always)]
    pub(crate) fn judge<const SLACK: bool>(&self, node: Node, open: Open) -> Judged {
        let place = node.place().as_vec3();
        let centre = self.origin_view + self.view_from_grid * place;
        let radius = node.radius() * self.stretch;
        let mut judged = Judged {
            verdict: Verdict::Large,
            open,
            slack: Slack::ENDLESS,
        };
        let mut left = open.planes;
        while left != 0 {
            let bit = left.trailing_zeros();
            left &= left - 1;
            let plane = self.planes[bit as usize];
            let distance = plane.truncate().dot(centre) + plane.w;
            if distance < -radius {
                judged.verdict = Verdict::Culled;
                if SLACK {
                    judged.slack = Slack {
                        view: -radius - distance,
                        eye: f32::INFINITY,
                    };
                }
                return judged;
            }
            let is_inside = distance >= radius;
            if is_inside {
                judged.open.planes &= !(1 << bit);
            }
            if SLACK {
                let to_inside = (distance - radius).abs();
                let to_outside = if is_inside { to_inside } else { distance + radius };
                judged.slack.view = judged.slack.view.min(to_inside.min(to_outside));
            }
        }
        if open.is_cone_open && node.cone_code() != NO_CONE {
            let [least, greatest] = self.facing(node, place);
            if least > 0.0 {
                judged.verdict = Verdict::Culled;
                if SLACK {
                    judged.slack = Slack {
                        view: f32::INFINITY,
                        eye: least,
                    };
                }
                return judged;
            }
            if greatest < 0.0 {
                judged.open.is_cone_open = false;
            }
            if SLACK {
                judged.slack.eye = least.abs().min(greatest.abs());
            }
        }
        let is_large = if self.projection.is_orthographic {
            self.reach * radius > 1.0
        } else {
            let excess = self.reach * radius + centre.z;
            if SLACK {
                judged.slack.view = judged.slack.view.min(excess.abs());
            }
            excess > 0.0
        };
        if !is_large {
            judged.verdict = Verdict::Small;
        }
        judged
    }

    /// Bounds of n·(x − eye) over the normals n of the cone and the points x of the sphere: all face away if the least is above
    /// 0, all face the eye if the greatest is below. Object space, where any affine transform leaves the signs as they are.
    #[inline(always)]
    fn facing(&self, node: Node, place: Vec3) -> [f32; 2] {
        let [cosine, sine] = self.cones[usize::from(node.cone_code())];
        let axis = node.normal();
        if self.projection.is_orthographic {
            // As seen from far away: only the direction counts.
            let from_eye = -self.eye_object;
            let along = axis.dot(from_eye);
            let across = (1.0 - along * along).max(0.0).sqrt();
            [along * cosine - across * sine, along * cosine + across * sine]
        } else {
            let from_eye = Vec3::from_array(self.grid.origin) - self.eye_object + place * self.grid.step;
            let along = axis.dot(from_eye);
            let across = (from_eye.length_squared() - along * along).max(0.0).sqrt();
            let radius = node.radius();
            [
                along * cosine - across * sine - radius,
                along * cosine + across * sine + radius,
            ]
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
    let [wide, high] = projection.size_px.map(|size| w * (1.0 + 2.0 * margin_px / size.max(1.0)));
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
    let square = linear.transpose() * linear;
    let mut direction = Vec3::new(0.6, 0.5, 0.62);
    for _ in 0..64 {
        direction = (square * direction).normalize_or_zero();
    }
    let stretch = (linear * direction).length();
    let columns = [linear.x_axis, linear.y_axis, linear.z_axis];
    let longest = columns.into_iter().map(Vec3::length).fold(stretch, f32::max);
    // The iteration comes from below.
    longest * (1.0 + 1e-5)
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
