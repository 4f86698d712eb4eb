//! Twin of `lib::clip`, four at once: which pixels of a surfel its clip lines leave.

use super::lanes::sqrt;
use pointstage_plugin_api::clip::ClipLines;
use pointstage_plugin_api::glam::{BVec4A, Vec3, Vec4};

/// Farther than any edge, px.
pub(super) const FAR_PX: f32 = 1e20;

/// Whether the lines leave four points.
///
/// * `uv1`: (u, v, 1) times any positive number.
#[inline]
pub fn clip_keeps(lines: &ClipLines, uv1: [Vec4; 3]) -> BVec4A {
    let first = value(lines.first, uv1);
    let second = value(lines.second, uv1);
    joined(lines, first, second).cmpge(Vec4::ZERO)
}

/// Distances of four pixels from where the lines cut the surfel off, positive where it stays, px; without meaning behind the eye.
///
/// * `uv1`: of the pixels; `uv1_x`, `uv1_y`: how it changes from pixel to pixel.
#[inline]
pub fn clip_distance(lines: &ClipLines, uv1: [Vec4; 3], uv1_x: Vec3, uv1_y: Vec3) -> Vec4 {
    let inverse = Vec4::ONE / uv1[2];
    let distance = |line: [f32; 3]| {
        let value = value(line, uv1) * inverse;
        let along = |change: Vec3| {
            let change_of = Vec4::splat(Vec3::from_array(line).dot(change));
            (change_of - value * change.z) * inverse
        };
        let [x, y] = [along(uv1_x), along(uv1_y)];
        let change = sqrt(x * x + y * y).max(Vec4::splat(1.0 / FAR_PX));
        (value / change).clamp(Vec4::splat(-FAR_PX), Vec4::splat(FAR_PX))
    };
    joined(lines, distance(lines.first), distance(lines.second))
}

#[inline]
fn value([a, b, c]: [f32; 3], [u, v, one]: [Vec4; 3]) -> Vec4 {
    u * a + v * b + one * c
}

/// The lesser of two values, or for a union the greater one.
#[inline]
fn joined(lines: &ClipLines, first: Vec4, second: Vec4) -> Vec4 {
    if lines.is_union > 0.5 {
        first.max(second)
    } else {
        first.min(second)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pointstage_plugin_api::glam::DVec3;
    use pointstage_plugin_api::twin::clip;

    #[test]
    fn four_at_once_are_what_the_twin_says_of_each() {
        let uv1 = |lane: usize| {
            let at = lane as f32;
            Vec3::new(0.3 * at - 0.4, 0.5 - 0.2 * at, 1.0 + 0.1 * at)
        };
        let (uv1_x, uv1_y) = (Vec3::new(0.1, 0.02, 0.01), Vec3::new(-0.03, 0.12, 0.0));
        let all = [0, 1, 2].map(|part| Vec4::from_array([0, 1, 2, 3].map(|lane| uv1(lane)[part])));
        for is_union in [false, true] {
            let lines = ClipLines::new([[-1.0, 0.2, 0.3], [0.4, 2.0, -0.1]], is_union);
            let found = clip_distance(&lines, all, uv1_x, uv1_y);
            let keeps = clip_keeps(&lines, all).bitmask();
            for lane in 0..4 {
                let planes = [uv1(lane), uv1_x, uv1_y].map(Vec3::as_dvec3);
                let expected = clip::clip_distance(&lines, planes);
                assert!((f64::from(found[lane]) - expected).abs() < 1e-4);
                let is_kept = clip::clip_keeps(&lines, planes[0]);
                assert_eq!(keeps & 1 << lane != 0, is_kept);
                assert!(planes[0] != DVec3::ZERO);
            }
        }
    }
}
