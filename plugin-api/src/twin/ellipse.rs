//! Twin of `lib::ellipse`: exact bounds of perspective-correct ellipses, and the point of the ellipse that a pixel sees.
//!
//! The derivation is in the shader's header. Bounds here have no margin and are not cut to the target.

use super::camera::Camera;
use glam::{DVec2, DVec3, DVec4, Vec3Swizzles as _};

/// Two half-axes of an ellipse: any pair of conjugate ones, not only the principal pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    /// First half-axis.
    pub u: DVec3,
    /// Second half-axis.
    pub v: DVec3,
}

/// The image of an ellipse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProjectedEllipse {
    /// Least pixel position of the visible part.
    pub lower_px: DVec2,
    /// Greatest pixel position of the visible part.
    pub upper_px: DVec2,
    /// Whether the near plane cuts the disk.
    pub is_cut: bool,
    origin_px: DVec2,
    uv1_constant: DVec3,
    uv1_x: DVec3,
    uv1_y: DVec3,
    depth: DVec3,
}

// Below this share of its greatest possible value the determinant is rounding: the ellipse is seen edge-on.
const EDGE_ON: f64 = 1e-12;

/// Least and greatest value of `row·p / w·p` over the visible part of the disk; none if there is none.
fn ellipse_extremes(row: DVec3, w: DVec3, z: DVec3) -> Option<(f64, f64)> {
    let in_front = w - z;
    let in_front_squared = in_front.xy().length_squared();
    let chord = in_front_squared - in_front.z * in_front.z;
    let is_cut = chord > 0.0;
    let g = row.cross(w);
    let g_squared = g.xy().length_squared();
    let discriminant = g_squared - g.z * g.z;
    let mut candidates = [None; 4];
    if discriminant > 0.0 {
        let across = DVec2::new(-g.y, g.x) * discriminant.sqrt();
        for (candidate, side) in candidates.iter_mut().zip([across, -across]) {
            let p = ((g.xy() * g.z + side) / g_squared).extend(1.0);
            *candidate = (!is_cut || in_front.dot(p) >= 0.0).then(|| row.dot(p) / w.dot(p));
        }
    }
    if is_cut {
        let across = DVec2::new(-in_front.y, in_front.x) * chord.sqrt();
        for (candidate, side) in candidates[2..].iter_mut().zip([across, -across]) {
            let p = ((side - in_front.xy() * in_front.z) / in_front_squared).extend(1.0);
            // On the chord w is z, which has fewer roundings.
            *candidate = Some(row.dot(p) / z.dot(p));
        }
    }
    candidates.into_iter().flatten().fold(None, |bounds, x| {
        let (least, greatest) = bounds.unwrap_or((x, x));
        Some((least.min(x), greatest.max(x)))
    })
}

/// The image of the ellipse with half-axes `axes` round `centre_view`; view space. `None` if nothing of it is in front of
/// the near plane, if it is seen edge-on, or if an input is not finite.
pub fn project_ellipse(
    camera: &Camera,
    centre_view: DVec3,
    axes: Axes,
) -> Option<ProjectedEllipse> {
    let rows = [
        camera.clip_from_view * axes.u.extend(0.0),
        camera.clip_from_view * axes.v.extend(0.0),
        camera.clip_from_view(centre_view),
    ];
    let row = |component: fn(DVec4) -> f64| DVec3::from(rows.map(component));
    let w = row(|clip| clip.w);
    let z = row(|clip| clip.z);
    let in_front = w - z;
    let visible = in_front.z > -in_front.xy().length();
    if !visible {
        return None;
    }

    let size = camera.tile_size_px;
    let origin_px = if w.z > 0.0 {
        camera.pixel_from_clip(rows[2]).clamp(DVec2::ZERO, size)
    } else {
        0.5 * size
    };
    let origin_px = origin_px.floor() + 0.5;
    let half = 0.5 * size;
    let x = half.x * row(|clip| clip.x) + (half.x - origin_px.x) * w;
    let y = -half.y * row(|clip| clip.y) + (half.y - origin_px.y) * w;

    let constant = x.cross(y);
    let determinant = w.dot(constant);
    let faces = determinant.abs() > EDGE_ON * w.length() * x.xy().length() * y.xy().length();
    if !faces {
        return None;
    }
    let (left, right) = ellipse_extremes(x, w, z)?;
    let (top, bottom) = ellipse_extremes(y, w, z)?;
    let uv1_constant = constant / determinant;
    let uv1_x = y.cross(w) / determinant;
    let uv1_y = w.cross(x) / determinant;
    Some(ProjectedEllipse {
        lower_px: origin_px + DVec2::new(left, top),
        upper_px: origin_px + DVec2::new(right, bottom),
        is_cut: in_front.z < in_front.xy().length(),
        origin_px,
        uv1_constant,
        uv1_x,
        uv1_y,
        depth: DVec3::new(z.dot(uv1_constant), z.dot(uv1_x), z.dot(uv1_y)),
    })
}

impl ProjectedEllipse {
    /// (u, v, 1) / w of the plane's point that the pixel position sees; the third is negative behind the eye.
    pub fn ellipse_uv1(&self, pixel: DVec2) -> DVec3 {
        let offset = pixel - self.origin_px;
        self.uv1_constant + offset.x * self.uv1_x + offset.y * self.uv1_y
    }

    /// Depth of the plane's point that the pixel position sees; outside 0..1 it is not visible.
    pub fn ellipse_depth(&self, pixel: DVec2) -> f64 {
        let offset = pixel - self.origin_px;
        self.depth.x + offset.x * self.depth.y + offset.y * self.depth.z
    }

    /// Depth of the disk at a pixel position, if the pixel sees it.
    pub fn hit(&self, pixel: DVec2) -> Option<f64> {
        let depth = self.ellipse_depth(pixel);
        (ellipse_covers(self.ellipse_uv1(pixel)) && (0.0..=1.0).contains(&depth)).then_some(depth)
    }
}

/// Whether a value of [`ProjectedEllipse::ellipse_uv1`] is a point of the disk, in front of the eye.
pub fn ellipse_covers(uv1: DVec3) -> bool {
    uv1.z > 0.0 && uv1.xy().length_squared() <= uv1.z * uv1.z
}
