//! Twin of `lib::ellipse`: perspective-correct ellipses, four at once.

use super::lanes::{LANES, Vec3x4, sqrt};
use pointstage_plugin_api::FrameUniform;
use pointstage_plugin_api::glam::{BVec4A, Vec2, Vec3, Vec3Swizzles as _, Vec4};

/// The numbers of a frame's camera that geometry needs.
///
/// Of the projection only what every view has: x and y of clip space do not mix, and z and w follow from the distance alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera4 {
    /// clip.x of view x, z and 1.
    x: [Vec4; 3],
    /// clip.y of view y, z and 1.
    y: [Vec4; 3],
    /// clip.z of view z and 1.
    z: [Vec4; 2],
    /// clip.w of view z and 1.
    w: [Vec4; 2],
    /// Size of the target, px.
    pub size_px: Vec2,
    /// Pixels that one scene unit covers at distance 1 (perspective) or everywhere (orthographic).
    pub pixels_per_unit: f32,
    /// Whether rays are parallel.
    pub is_orthographic: bool,
}

/// Four clip positions, or directions.
#[derive(Clone, Copy, Debug)]
pub struct Clip4 {
    /// x of all.
    pub x: Vec4,
    /// y of all.
    pub y: Vec4,
    /// z of all.
    pub z: Vec4,
    /// w of all.
    pub w: Vec4,
}

/// Two half-axes of each of four ellipses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes4 {
    /// First half-axes.
    pub u: Vec3x4,
    /// Second half-axes.
    pub v: Vec3x4,
}

/// The images of four ellipses, as `ProjectedEllipse` of the shader.
#[derive(Clone, Copy, Debug)]
pub struct Ellipses4 {
    /// Which ones have an image: part of them is in front of the near plane, and they are not seen edge-on.
    pub is_seen: BVec4A,
    /// Rectangles that hold the visible parts, px, within the target; without meaning for what is not seen.
    pub lower_px: [Vec4; 2],
    /// Their other corners.
    pub upper_px: [Vec4; 2],
    /// Pixel centres; offsets below are from here.
    pub origin_px: [Vec4; 2],
    /// (u, v, 1) / w of the plane's point that a pixel sees: the rows' dot products with (1, offset.x, offset.y).
    pub uv1_constant: Vec3x4,
    /// Its change with x.
    pub uv1_x: Vec3x4,
    /// Its change with y.
    pub uv1_y: Vec3x4,
    /// Depth, likewise: constant, change with x, change with y.
    pub depth: Vec3x4,
}

/// Where four spheres are seen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spheres4 {
    /// Corner of a rectangle that holds the image, within the target, px.
    pub(super) lower_px: [Vec4; 2],
    /// The other corner; 0 if nothing is to be seen.
    pub(super) upper_px: [Vec4; 2],
    /// No point is nearer than this depth.
    pub(super) depth: Vec4,
}

// The constants of the shader.
pub(super) const BOUNDS_MARGIN_PX: f32 = 1.0 / 64.0;
pub(super) const CUT_MARGIN_PX: f32 = 1.0;
pub(super) const EDGE_ON: f32 = 1e-6;

impl From<&FrameUniform> for Camera4 {
    fn from(frame: &FrameUniform) -> Self {
        let [x, y, z, w] = frame.clip_from_view;
        Self {
            x: [x[0], z[0], w[0]].map(Vec4::splat),
            y: [y[1], z[1], w[1]].map(Vec4::splat),
            z: [z[2], w[2]].map(Vec4::splat),
            w: [z[3], w[3]].map(Vec4::splat),
            size_px: Vec2::from_array(frame.tile_size_px),
            pixels_per_unit: frame.pixels_per_unit,
            is_orthographic: frame.is_orthographic != 0,
        }
    }
}

impl Camera4 {
    /// Clip space from view space, positions.
    #[inline]
    pub fn clip_from_view(&self, position_view: Vec3x4) -> Clip4 {
        let clip = self.clip_from_direction(position_view);
        Clip4 {
            x: clip.x + self.x[2],
            y: clip.y + self.y[2],
            z: clip.z + self.z[1],
            w: clip.w + self.w[1],
        }
    }

    /// Clip space from view space, directions.
    #[inline]
    pub fn clip_from_direction(&self, direction_view: Vec3x4) -> Clip4 {
        let Vec3x4 { x, y, z } = direction_view;
        Clip4 {
            x: x * self.x[0] + z * self.x[1],
            y: y * self.y[0] + z * self.y[1],
            z: z * self.z[0],
            w: z * self.w[0],
        }
    }

    /// Pixel positions from clip space; `clip.w` must not be 0.
    #[inline]
    pub fn pixel_from_clip(&self, clip: &Clip4) -> [Vec4; 2] {
        let half = Vec4::splat(0.5);
        let scale = half / clip.w;
        [
            (half + clip.x * scale) * self.size_px.x,
            (half - clip.y * scale) * self.size_px.y,
        ]
    }

    /// Pixels that one scene unit across the view covers at the view positions.
    #[inline]
    pub fn pixels_per_unit_at(&self, position_view: Vec3x4) -> Vec4 {
        let pixels_per_unit = Vec4::splat(self.pixels_per_unit);
        if self.is_orthographic {
            pixels_per_unit
        } else {
            pixels_per_unit / -position_view.z
        }
    }

    /// Unit directions from view positions towards the eye; view space.
    #[inline]
    pub fn towards_eye(&self, position_view: Vec3x4) -> Vec3x4 {
        if self.is_orthographic {
            Vec3x4::splat(Vec3::Z)
        } else {
            -position_view.normalize()
        }
    }

    /// Depths from distances from the eye's plane.
    #[inline]
    pub fn depth_from_eye_distance(&self, distance: Vec4) -> Vec4 {
        (self.z[1] - self.z[0] * distance) / (self.w[1] - self.w[0] * distance)
    }

    /// Where on the screen four spheres can be, never too little.
    ///
    /// * `pad_px`: how far splats reach beyond the spheres' images.
    #[inline]
    pub(super) fn project_spheres(
        &self,
        centre_view: Vec3x4,
        radius: Vec4,
        pad_px: f32,
    ) -> Spheres4 {
        let clip = self.clip_from_view(centre_view);
        let distance = -centre_view.z;
        let scale = Vec4::ONE / clip.w;
        let half = self.size_px * 0.5;
        let [half_x, half_y] = [Vec4::splat(half.x), Vec4::splat(half.y)];
        let [x, y] = [
            half_x + half_x * (clip.x * scale),
            half_y - half_y * (clip.y * scale),
        ];
        let pixels = (self.x[0] * half.x).abs().max((self.y[0] * half.y).abs());
        // A little more, for rounding.
        let mut sphere_px = radius * pixels * 1.001;
        let mut is_whole = BVec4A::FALSE;
        let mut is_ahead = radius.cmpge(Vec4::ZERO);
        if !self.is_orthographic {
            // Any point of a sphere is on the screen within r·sqrt(1 + slope²) / (distance - r) of the centre.
            let [slope_x, slope_y] = [centre_view.x * scale, centre_view.y * scale];
            let slope_squared = (slope_x * slope_x).max(slope_y * slope_y);
            let nearest = distance - radius;
            sphere_px *= sqrt(Vec4::ONE + slope_squared) / nearest;
            is_whole = nearest.cmple(radius * 1e-6);
            is_ahead &= (distance + radius).cmpgt(Vec4::ZERO);
        }
        let reach = sphere_px + Vec4::splat(pad_px + 0.02);
        let mut depth = self.depth_from_eye_distance(distance - radius);
        if pad_px > 0.0 {
            let change = clip.z * scale - self.depth_from_eye_distance(distance + radius);
            // 1.42: to the corners.
            depth = depth.max(clip.z * scale + change * (reach * (1.42 / pad_px)));
        }
        let lower = |centre: Vec4| {
            let lower = Vec4::select(is_whole, Vec4::ZERO, centre - reach);
            lower.max(Vec4::ZERO)
        };
        // NaN ends at 0, before the first pixel.
        let upper = |centre: Vec4, size: f32| {
            let size = Vec4::splat(size);
            let upper = Vec4::select(is_whole, size, (centre + reach).min(size));
            Vec4::select(is_ahead & upper.cmpgt(Vec4::ZERO), upper, Vec4::ZERO)
        };
        Spheres4 {
            lower_px: [lower(x), lower(y)],
            upper_px: [upper(x, self.size_px.x), upper(y, self.size_px.y)],
            // Rounding of single precision.
            depth: Vec4::select(is_whole, Vec4::INFINITY, depth * 1.000_01),
        }
    }

    /// The images of four ellipses round view positions.
    #[inline]
    pub fn project_ellipses(&self, centre_view: Vec3x4, axes: &Axes4) -> Ellipses4 {
        let u = self.clip_from_direction(axes.u);
        let v = self.clip_from_direction(axes.v);
        let c = self.clip_from_view(centre_view);
        let w = Vec3x4::new(u.w, v.w, c.w);
        let z = Vec3x4::new(u.z, v.z, c.z);
        let in_front = w - z;
        let across_squared = in_front.x * in_front.x + in_front.y * in_front.y;
        let is_whole =
            in_front.z.cmpge(Vec4::ZERO) & (in_front.z * in_front.z).cmpge(across_squared);
        let is_ahead =
            in_front.z.cmpgt(Vec4::ZERO) | (in_front.z * in_front.z).cmplt(across_squared);

        let half = self.size_px * 0.5;
        let size = [self.size_px.x, self.size_px.y].map(Vec4::splat);
        let centre_px = self.pixel_from_clip(&c);
        let has_centre = c.w.cmpgt(Vec4::ZERO);
        let origin = |axis: usize| {
            let clamped = centre_px[axis].max(Vec4::ZERO).min(size[axis]);
            let origin = Vec4::select(has_centre, clamped, size[axis] * 0.5);
            origin.floor() + Vec4::splat(0.5)
        };
        let origin_px = [origin(0), origin(1)];
        let [half_x, half_y] = [Vec4::splat(half.x), Vec4::splat(half.y)];
        let [left, up] = [half_x - origin_px[0], half_y - origin_px[1]];
        let x = Vec3x4::new(u.x, v.x, c.x) * half_x + w * left;
        let y = w * up - Vec3x4::new(u.y, v.y, c.y) * half_y;

        let constant = x.cross(y);
        let determinant = w.dot(constant);
        let squared = (x.x * x.x + x.y * x.y) * (y.x * y.x + y.y * y.y);
        let greatest = sqrt(w.length_squared()) * sqrt(squared);
        let is_seen = is_ahead & determinant.abs().cmpgt(greatest * EDGE_ON);
        let inverse = Vec4::ONE / determinant;

        // x = X.p / W.p is extreme on the unit circle where the line through p and (X, W) touches it; with the form
        // a*b = a.x b.x + a.y b.y - a.z b.z: x W*W - X*W = ± sqrt((X*W)² - X*X W*W).
        let form = |a: Vec3x4, b: Vec3x4| a.x * b.x + a.y * b.y - a.z * b.z;
        let w_w = form(w, w);
        let scale = Vec4::ONE / w_w;
        let extent = |row: Vec3x4| {
            let row_w = form(row, w);
            let across = sqrt((row_w * row_w - form(row, row) * w_w).max(Vec4::ZERO));
            let [middle, reach] = [row_w * scale, (across * scale).abs()];
            let margin = Vec4::splat(BOUNDS_MARGIN_PX);
            [middle - reach - margin, middle + reach + margin]
        };
        let mut extents = [extent(x), extent(y)];
        let cut = (!is_whole & is_seen).bitmask();
        if cut != 0 {
            for lane in (0..LANES).filter(|lane| cut & 1 << lane != 0) {
                let [w, z] = [w.lane(lane), z.lane(lane)];
                for (extent, row) in extents.iter_mut().zip([x, y]) {
                    let [least, greatest] = ellipse_extremes(row.lane(lane), w, z);
                    extent[0][lane] = least;
                    extent[1][lane] = greatest;
                }
            }
        }
        let corner = |side: usize, axis: usize| extents[axis][side] + origin_px[axis];
        let lower = |axis: usize| corner(0, axis).max(Vec4::ZERO);
        let upper = |axis: usize| corner(1, axis).min(size[axis]);
        let uv1_constant = constant * inverse;
        let uv1_x = y.cross(w) * inverse;
        let uv1_y = w.cross(x) * inverse;
        Ellipses4 {
            is_seen,
            lower_px: [lower(0), lower(1)],
            upper_px: [upper(0), upper(1)],
            origin_px,
            uv1_constant,
            uv1_x,
            uv1_y,
            depth: Vec3x4::new(z.dot(uv1_constant), z.dot(uv1_x), z.dot(uv1_y)),
        }
    }
}

/// Least and greatest value of row.p / w.p over the visible part of a disk that the near plane cuts, with a margin; the twin of
/// the shader's function. The least is greater than the other if nothing is visible.
fn ellipse_extremes(row: Vec3, w: Vec3, z: Vec3) -> [f32; 2] {
    let (mut least, mut greatest) = (f32::MAX, f32::MIN);
    let mut take = |x: f32| {
        least = least.min(x);
        greatest = greatest.max(x);
    };
    let in_front = w - z;
    let in_front_squared = in_front.xy().length_squared();
    let chord = in_front_squared - in_front.z * in_front.z;
    let g = row.cross(w);
    let g_squared = g.xy().length_squared();
    let discriminant = g_squared - g.z * g.z;
    if discriminant > 0.0 {
        let across = Vec2::new(-g.y, g.x) * discriminant.sqrt();
        for side in [across, -across] {
            let p = ((g.xy() * g.z + side) / g_squared).extend(1.0);
            if in_front.dot(p) >= 0.0 {
                take(row.dot(p) / w.dot(p));
            }
        }
    }
    let across = Vec2::new(-in_front.y, in_front.x) * chord.max(0.0).sqrt();
    for side in [across, -across] {
        let p = ((side - in_front.xy() * in_front.z) / in_front_squared).extend(1.0);
        // On the chord w is z, which has fewer roundings.
        take(row.dot(p) / z.dot(p));
    }
    [
        least - CUT_MARGIN_PX - BOUNDS_MARGIN_PX,
        greatest + CUT_MARGIN_PX + BOUNDS_MARGIN_PX,
    ]
}

#[cfg(test)]
#[path = "ellipse_tests.rs"]
mod tests;
