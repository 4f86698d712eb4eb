//! Twin of `lib::clip`: which part of a surfel its clip lines leave.

use crate::clip::ClipLines;
use glam::{DVec2, DVec3, Vec3};

/// Farther than any edge, px.
const FAR_PX: f64 = 1e20;

/// The same lines where u and v count in units of so many half-axes.
pub fn scaled_clip_lines(lines: ClipLines, unit: f32) -> ClipLines {
    let scaled = |[a, b, c]: [f32; 3]| [a * unit, b * unit, c];
    ClipLines {
        first: scaled(lines.first),
        second: scaled(lines.second),
        ..lines
    }
}

/// The lesser of two values, or for a union the greater one.
fn clip_joined(is_union: f32, first: f64, second: f64) -> f64 {
    if is_union > 0.5 {
        first.max(second)
    } else {
        first.min(second)
    }
}

fn line(line: [f32; 3]) -> DVec3 {
    Vec3::from_array(line).as_dvec3()
}

/// Whether the lines leave the point.
///
/// * `uv1`: (u, v, 1) times any positive number.
pub fn clip_keeps(lines: &ClipLines, uv1: DVec3) -> bool {
    let [first, second] = [lines.first, lines.second].map(|its| line(its).dot(uv1));
    clip_joined(lines.is_union, first, second) >= 0.0
}

/// Distance of a pixel from a line on the screen, to first order; positive where the surfel stays, px.
fn clip_line_distance(line: DVec3, [uv1, uv1_x, uv1_y]: [DVec3; 3]) -> f64 {
    let value = line.dot(uv1) / uv1.z;
    let along = |change: DVec3| (line.dot(change) - value * change.z) / uv1.z;
    let change = DVec2::new(along(uv1_x), along(uv1_y)).length();
    (value / change.max(1.0 / FAR_PX)).clamp(-FAR_PX, FAR_PX)
}

/// Distance of a pixel from where the lines cut the surfel off, positive where it stays, px.
///
/// * `uv1`: of the pixel, and how it changes with x and y.
pub fn clip_distance(lines: &ClipLines, uv1: [DVec3; 3]) -> f64 {
    if uv1[0].z > 0.0 {
        let [first, second] =
            [lines.first, lines.second].map(|its| clip_line_distance(line(its), uv1));
        clip_joined(lines.is_union, first, second)
    } else {
        // Behind the eye is no part of it.
        -FAR_PX
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plane that faces the eye, 10 px a half-axis: u = x / 10, v = y / 10.
    fn uv1_at(x: f64, y: f64) -> [DVec3; 3] {
        [
            DVec3::new(0.1 * x, 0.1 * y, 1.0),
            DVec3::new(0.1, 0.0, 0.0),
            DVec3::new(0.0, 0.1, 0.0),
        ]
    }

    #[test]
    fn distances_are_those_on_the_screen() {
        // Leaves x <= 5 px and, by the second, y <= 2 px.
        let corner = [[-2.0, 0.0, 1.0], [0.0, -5.0, 1.0]];
        for (is_union, [x, y], expected) in [
            (false, [1.0, 1.0], 1.0),
            (false, [4.5, -3.0], 0.5),
            (false, [4.0, 5.0], -3.0),
            (true, [4.0, 5.0], 1.0),
            (true, [6.0, 5.0], -1.0),
        ] {
            let lines = ClipLines::new(corner, is_union);
            let found = clip_distance(&lines, uv1_at(x, y));
            assert!((found - expected).abs() < 1e-6, "{found}, {x}, {y}");
            assert_eq!(clip_keeps(&lines, uv1_at(x, y)[0]), expected >= 0.0);
        }
        assert!(clip_distance(&ClipLines::NONE, uv1_at(99.0, 99.0)) > 1e6);
        // In units of two half-axes the lines are as far away as before.
        let lines = scaled_clip_lines(ClipLines::new(corner, false), 2.0);
        let halved = uv1_at(1.0, 1.0).map(|it| DVec3::new(0.5 * it.x, 0.5 * it.y, it.z));
        assert!((clip_distance(&lines, halved) - 1.0).abs() < 1e-6);
    }
}
