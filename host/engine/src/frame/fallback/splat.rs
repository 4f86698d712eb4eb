//! The image of a surfel's disc: where it is on the screen, and how deep at each pixel.
//!
//! In perspective the ray through pixel offset (dx, dy) from the projected centre is `ray = ray₀ + (dx/sx, −dy/sy, 0)`, with
//! `ray.z = −1`. It meets the surfel's plane `n·q = n·p` at distance `1/inv`, where
//!
//! ```text
//! inv(dx, dy) = n·ray / n·p                        linear in dx and dy
//! |q − p| ≤ r   ⇔   |ray − p·inv| ≤ r·inv          both sides linear as well
//! ```
//!
//! so that a pixel costs a quadratic form and no division. In an orthographic view the right side is r itself. Depth is
//! linear on the screen too. This is the perspectively correct disc of Botsch et al., *High-Quality Surface Splatting on
//! Today's GPUs*, PBG 2005, with the division by `inv` left out.

use glam::{Mat4, Vec2, Vec3};
use pointstage_plugin_api::abi::FrameUniform;

/// Half of a splat's greatest width and height, px. Nearer to the eye surfels shrink: a surfel that fills the screen costs
/// as much as a million small ones.
pub const MAX_HALF_EXTENT_PX: f32 = 256.0;

/// Least |cosine| between normal and line of sight; discs seen more edge-on are turned up to here, since their planes
/// become steep beyond measure.
const MIN_COSINE: f32 = 0.05;

/// Splats whose radius is below this many px cover the centre's pixel and no other.
const SINGLE_PIXEL_RADIUS_PX: f32 = 0.5;

/// The frame's projection in the form that splatting needs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Screen {
    orthographic: bool,
    /// Size of the targets, px.
    pub(super) size_px: Vec2,
    /// px per unit of tangent (perspective) or per scene unit (orthographic); y counted upwards.
    scale: Vec2,
    /// Where the line of sight meets the picture, px.
    offset: Vec2,
    /// Depth = `depth_constant + depth_slope · inv`, orthographic `… · z_view`.
    depth_constant: f32,
    depth_slope: f32,
}

/// A splat, ready to be drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Splat {
    /// Centre, px from the upper left corner.
    pub(super) centre: Vec2,
    /// Half of its box, px; 0 covers the centre's pixel alone.
    pub(super) half_extent: Vec2,
    /// a·dx² + 2·b·dx·dy + c·dy², to be at most the square of the limit.
    quadratic: Vec3,
    /// Value at the centre, change per px in x and y.
    limit: Vec3,
    depth: Vec3,
}

impl Screen {
    /// For projections whose x and y depend on one axis each, as the host's do.
    pub(super) fn new(frame: &FrameUniform, size_px: [u32; 2]) -> Self {
        let m = Mat4::from_cols_array_2d(&frame.clip_from_view);
        let size_px = Vec2::new(size_px[0] as f32, size_px[1] as f32);
        let half = 0.5 * size_px;
        let orthographic = frame.is_orthographic != 0;
        // Clip x is m.x.x·x + m.z.x·z (perspective, z = −1 for rays) or m.x.x·x + m.w.x.
        let shift = if orthographic {
            Vec2::new(m.w_axis.x, m.w_axis.y)
        } else {
            -Vec2::new(m.z_axis.x, m.z_axis.y)
        };
        let (depth_constant, depth_slope) = if orthographic {
            (m.w_axis.z, m.z_axis.z)
        } else {
            (-m.z_axis.z, m.w_axis.z)
        };
        Self {
            orthographic,
            size_px,
            scale: half * Vec2::new(m.x_axis.x, m.y_axis.y),
            offset: half + half * Vec2::new(shift.x, -shift.y),
            depth_constant,
            depth_slope,
        }
    }

    /// What lies at this depth behind a place in the picture; view space.
    pub(super) fn position_view(&self, pixel: Vec2, depth: f32) -> Vec3 {
        let plane = (pixel - self.offset) / Vec2::new(self.scale.x, -self.scale.y);
        let term = (depth - self.depth_constant) / self.depth_slope;
        if self.orthographic {
            plane.extend(term)
        } else {
            plane.extend(-1.0) / term
        }
    }

    /// The splat of a surfel; `None` if it is before the near plane, behind the far one, beside the picture, or not finite.
    ///
    /// * `radius`: view space. One that is not above 0 covers one pixel.
    /// * `normal_view`: called for what is larger than a pixel; any length; `None` faces the eye.
    #[inline]
    pub(super) fn splat(
        &self,
        centre_view: Vec3,
        radius: f32,
        normal_view: impl FnOnce() -> Option<Vec3>,
    ) -> Option<Splat> {
        let inv = if self.orthographic {
            1.0
        } else {
            -1.0 / centre_view.z
        };
        let depth = self.depth_constant
            + self.depth_slope
                * if self.orthographic {
                    centre_view.z
                } else {
                    inv
                };
        // Guards are written so that NaN fails them.
        if !(inv > 0.0 && depth > 0.0 && depth <= 1.0) {
            return None;
        }
        let plane = centre_view.truncate() * inv;
        let centre = self.offset + plane * Vec2::new(self.scale.x, -self.scale.y);
        let radius_px = radius * inv * self.scale.max_element();
        // The sphere around the surfel, seen from as near as its nearest point.
        let reach = if self.orthographic {
            radius_px
        } else {
            let shrunk = 1.0 - radius * inv;
            if shrunk > 0.0 {
                radius_px / shrunk
            } else {
                MAX_HALF_EXTENT_PX
            }
        };
        let reach = reach.min(MAX_HALF_EXTENT_PX);
        let margin = Vec2::splat(reach.max(0.0));
        let beside = (centre + margin).cmplt(Vec2::ZERO) | (centre - margin).cmpge(self.size_px);
        if beside.any() || !centre.is_finite() {
            return None;
        }
        let has_extent = radius_px > SINGLE_PIXEL_RADIUS_PX;
        if !has_extent {
            return Some(Splat {
                centre,
                half_extent: Vec2::ZERO,
                quadratic: Vec3::ZERO,
                limit: Vec3::ZERO,
                depth: Vec3::new(depth, 0.0, 0.0),
            });
        }
        let towards_eye = if self.orthographic {
            Vec3::Z
        } else {
            (-centre_view).normalize()
        };
        let normal = turned_up(normal_view(), towards_eye);
        let step = Vec2::new(1.0 / self.scale.x, -1.0 / self.scale.y);
        let [right, down] = [Vec3::new(step.x, 0.0, 0.0), Vec3::new(0.0, step.y, 0.0)];
        let (offset_right, offset_down, limit, slope) = if self.orthographic {
            let rise = -normal.truncate() / normal.z * step;
            let offset = [right + Vec3::Z * rise.x, down + Vec3::Z * rise.y];
            (offset[0], offset[1], Vec3::new(radius, 0.0, 0.0), rise)
        } else {
            let rise = normal.truncate() / normal.dot(centre_view) * step;
            let offset = [right - centre_view * rise.x, down - centre_view * rise.y];
            (
                offset[0],
                offset[1],
                Vec3::new(inv, rise.x, rise.y) * radius,
                rise,
            )
        };
        let quadratic = Vec3::new(
            offset_right.length_squared(),
            offset_right.dot(offset_down),
            offset_down.length_squared(),
        );
        let determinant = quadratic.x * quadratic.z - quadratic.y * quadratic.y;
        // The ellipse's box for the greatest limit on the disc, r·inv at its nearest point.
        let greatest = reach * step.x.abs().min(step.y.abs());
        let extent = Vec2::new(quadratic.z, quadratic.x) / determinant;
        let half_extent = Vec2::new(extent.x.sqrt(), extent.y.sqrt()) * greatest;
        let splat = Splat {
            centre,
            half_extent: half_extent.min(Vec2::splat(MAX_HALF_EXTENT_PX)),
            quadratic,
            limit,
            depth: Vec3::new(
                depth,
                slope.x * self.depth_slope,
                slope.y * self.depth_slope,
            ),
        };
        half_extent.is_finite().then_some(splat)
    }
}

/// The normal with at least [`MIN_COSINE`] to the line of sight, unit; without one, the direction towards the eye.
fn turned_up(normal: Option<Vec3>, towards_eye: Vec3) -> Vec3 {
    let Some(normal) = normal.and_then(Vec3::try_normalize) else {
        return towards_eye;
    };
    let cosine = normal.dot(towards_eye);
    if cosine.abs() >= MIN_COSINE {
        return normal;
    }
    let tangential = normal - cosine * towards_eye;
    (tangential + MIN_COSINE * towards_eye).normalize()
}

impl Splat {
    /// Columns `x.0 .. x.1` and rows `y.0 .. y.1` of its box within the picture.
    #[inline]
    pub(super) fn pixel_box(&self, size_px: Vec2) -> ([i32; 2], [i32; 2]) {
        // Pixels whose centres, at .5, lie in the box; never without the pixel of the centre.
        let least = (self.centre - self.half_extent - 0.5)
            .ceil()
            .min(self.centre.floor());
        let greatest = (self.centre + self.half_extent - 0.5)
            .floor()
            .max(self.centre.floor());
        let first = least.max(Vec2::ZERO);
        let end = (greatest + 1.0).min(size_px);
        (
            [first.x as i32, end.x as i32],
            [first.y as i32, end.y as i32],
        )
    }

    /// Depth at an offset from the centre, if the disc covers it.
    #[inline]
    pub(super) fn depth_at(&self, offset: Vec2) -> Option<f32> {
        let Vec2 { x, y } = offset;
        let Vec3 { x: a, y: b, z: c } = self.quadratic;
        let limit = self.limit.x + self.limit.y * x + self.limit.z * y;
        let depth = self.depth.x + self.depth.y * x + self.depth.z * y;
        let inside = limit > 0.0
            && a * x * x + 2.0 * b * x * y + c * y * y <= limit * limit
            && depth > 0.0
            && depth <= 1.0;
        inside.then_some(depth)
    }

    /// Depth for a pixel that the disc does not cover: that of the disc's edge on the way there.
    #[inline]
    pub(super) fn nearest_depth(&self, offset: Vec2) -> f32 {
        let Vec2 { x, y } = offset;
        let Vec3 { x: a, y: b, z: c } = self.quadratic;
        let length = (a * x * x + 2.0 * b * x * y + c * y * y).sqrt();
        // A splat of one pixel has no extent at all.
        let reached = if length > self.limit.x {
            self.limit.x / length
        } else {
            0.0
        };
        let depth = self.depth.x + (self.depth.y * x + self.depth.z * y) * reached;
        if depth > 0.0 && depth <= 1.0 {
            depth
        } else {
            self.depth.x
        }
    }
}
