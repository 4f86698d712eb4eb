//! Polygons into triangles: a fan when convex, clipped ears otherwise.

use glam::{DVec2, DVec3};

/// How a polygon was cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cut {
    /// Three corners, or a convex polygon.
    Fan,
    /// Not convex: ear by ear.
    Ears,
}

/// Polygons of more corners are fanned without looking: clipping takes the square of their number.
const MOST_CORNERS_CLIPPED: usize = 4096;

/// Cuts a polygon of three or more corners into triangles of indices into `corners`, one less than two per corner.
///
/// Convexity is judged in the plane of the polygon's mean normal (Newell's); a polygon without a plane is fanned.
pub fn triangulate(corners: &[DVec3], triangles: &mut Vec<[usize; 3]>) -> Cut {
    let fan = |triangles: &mut Vec<[usize; 3]>| {
        triangles.extend((1..corners.len() - 1).map(|index| [0, index, index + 1]));
        Cut::Fan
    };
    if corners.len() == 3 || corners.len() > MOST_CORNERS_CLIPPED {
        return fan(triangles);
    }
    let Some(normal) = newell_normal(corners).try_normalize() else {
        return fan(triangles);
    };
    let (right, up) = normal.any_orthonormal_pair();
    let flat: Vec<DVec2> = corners
        .iter()
        .map(|&corner| {
            DVec2::new(
                (corner - corners[0]).dot(right),
                (corner - corners[0]).dot(up),
            )
        })
        .collect();
    if is_convex(&flat) {
        return fan(triangles);
    }
    clip_ears(&flat, triangles);
    Cut::Ears
}

/// Twice the area vector of a closed polygon: the sum of cross products of successive corners, seen from the first one.
pub fn newell_normal(corners: &[DVec3]) -> DVec3 {
    corners
        .windows(2)
        .map(|pair| (pair[0] - corners[0]).cross(pair[1] - corners[0]))
        .sum()
}

/// Twice the signed area of a triangle; positive when counter-clockwise.
fn area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

fn is_convex(flat: &[DVec2]) -> bool {
    let count = flat.len();
    let size = flat
        .iter()
        .fold(0.0_f64, |size, corner| size.max(corner.length_squared()));
    // Corners on a straight edge may turn the wrong way by rounding.
    (0..count).all(|index| {
        area(
            flat[index],
            flat[(index + 1) % count],
            flat[(index + 2) % count],
        ) >= -1e-9 * size
    })
}

fn clip_ears(flat: &[DVec2], triangles: &mut Vec<[usize; 3]>) {
    let mut left: Vec<usize> = (0..flat.len()).collect();
    while left.len() > 3 {
        let count = left.len();
        let neighbours = |index: usize| {
            [
                left[(index + count - 1) % count],
                left[index],
                left[(index + 1) % count],
            ]
        };
        // A crossing polygon may have no ear; then any corner goes, so that the loop ends.
        let ear = (0..count)
            .find(|&index| is_ear(flat, &left, neighbours(index)))
            .unwrap_or(0);
        triangles.push(neighbours(ear));
        left.remove(ear);
    }
    triangles.push([left[0], left[1], left[2]]);
}

fn is_ear(flat: &[DVec2], left: &[usize], [a, b, c]: [usize; 3]) -> bool {
    let (pa, pb, pc) = (flat[a], flat[b], flat[c]);
    if area(pa, pb, pc) <= 0.0 {
        return false;
    }
    let inside = |&index: &usize| {
        let point = flat[index];
        let is_corner = point == pa || point == pb || point == pc;
        !is_corner
            && area(pa, pb, point) >= 0.0
            && area(pb, pc, point) >= 0.0
            && area(pc, pa, point) >= 0.0
    };
    !left.iter().any(inside)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn total_area(corners: &[DVec3], triangles: &[[usize; 3]]) -> f64 {
        let of = |[a, b, c]: &[usize; 3]| {
            0.5 * (corners[*b] - corners[*a])
                .cross(corners[*c] - corners[*a])
                .z
        };
        assert!(
            triangles.iter().all(|triangle| of(triangle) >= 0.0),
            "a triangle is turned over"
        );
        triangles.iter().map(of).sum()
    }

    #[test]
    fn a_convex_polygon_is_a_fan() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::ONE.with_z(0.0), DVec3::Y];
        let mut triangles = Vec::new();
        assert_eq!(triangulate(&corners, &mut triangles), Cut::Fan);
        assert_eq!(triangles, [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn a_comb_keeps_its_area() {
        // Teeth of height 1 on a bar of height 1: a fan would cover the gaps.
        let mut corners = vec![DVec3::ZERO, DVec3::new(9.0, 0.0, 0.0)];
        for tooth in (0..5).rev() {
            let x = f64::from(tooth) * 2.0;
            corners.extend(
                [(x + 1.0, 2.0), (x, 2.0), (x, 1.0), (x - 1.0, 1.0)]
                    .map(|(x, y)| DVec3::new(x, y, 0.0)),
            );
        }
        corners.truncate(corners.len() - 2);
        let mut triangles = Vec::new();
        assert_eq!(triangulate(&corners, &mut triangles), Cut::Ears);
        assert_eq!(triangles.len(), corners.len() - 2);
        let area = total_area(&corners, &triangles);
        assert!(
            (area - 14.0).abs() < 1e-9,
            "bar 9 and five teeth, got {area}"
        );
    }

    #[test]
    fn hopeless_polygons_end() {
        let bow_tie = [
            DVec3::ZERO,
            DVec3::new(1.0, 1.0, 0.0),
            DVec3::X,
            DVec3::Y,
            DVec3::new(0.5, 0.1, 0.0),
        ];
        let equal = [DVec3::ONE; 6];
        for corners in [&bow_tie[..], &equal[..], &[DVec3::NAN; 5][..]] {
            let mut triangles = Vec::new();
            triangulate(corners, &mut triangles);
            assert_eq!(triangles.len(), corners.len() - 2);
        }
    }
}
