//! How large a disk must be to cover what lies nearer to its point than to any other.
//!
//! In the plane, the points that are nearer to one point than to its neighbours form its Voronoi cell. Disks that reach
//! the farthest corner of their cells cover everything, whatever the sampling: no more than is needed where points form
//! a grid, and enough where they were strewn at random (disks of one size for a density leave exp(-n) of the plane open,
//! with n disks over each place on average: 4 of 100 with three of them).

use glam::DVec3;

/// Corners of a cell that are kept; 16 neighbours cut a square into fewer than 21.
const MOST_CORNERS: usize = 24;

/// Neighbours farther off the plane than along it belong to another sheet of the surface, as in thin walls.
const STEEPEST: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// The corners of a convex polygon round the origin.
#[derive(Clone, Copy)]
struct Polygon {
    corners: [[f64; 2]; MOST_CORNERS],
    count: usize,
}

/// Distance from a point to the farthest corner of its Voronoi cell, at most `greatest`; scene units.
///
/// * `normal`: of the plane, unit.
/// * `offsets`: from the point to its neighbours, nearest first.
/// * `greatest`: where no neighbour is on one side, at the border of a scan, the cell has no end.
pub(super) fn covering_radius(
    normal: DVec3,
    offsets: impl Iterator<Item = DVec3>,
    greatest: f64,
) -> f64 {
    let (u, v) = normal.any_orthonormal_pair();
    let mut cell = Polygon::square(greatest);
    for offset in offsets {
        let squared = offset.length_squared();
        let reach = cell.reach_squared();
        if squared >= 4.0 * reach {
            break; // this one and all that follow are too far to cut anything off
        }
        if offset.dot(normal).powi(2) > STEEPEST.powi(2) * squared {
            continue;
        }
        // Turned into the plane, so that a neighbour on a curved surface is as far as it is.
        let flat = [offset.dot(u), offset.dot(v)];
        let length = flat[0].hypot(flat[1]);
        if length > 0.0 {
            let scale = squared.sqrt() / length;
            cell = cell.cut(flat.map(|along| along * scale));
        }
    }
    cell.reach_squared().sqrt().min(greatest)
}

impl Polygon {
    /// A square with sides at distance `half` from the origin.
    fn square(half: f64) -> Self {
        let mut corners = [[0.0; 2]; MOST_CORNERS];
        let square = [[half, half], [-half, half], [-half, -half], [half, -half]];
        corners[..4].copy_from_slice(&square);
        Self { corners, count: 4 }
    }

    /// Square of the distance of the farthest corner.
    fn reach_squared(&self) -> f64 {
        let corners = self.corners[..self.count].iter();
        corners.map(|[x, y]| x * x + y * y).fold(0.0, f64::max)
    }

    /// The part that is nearer to the origin than to `other`.
    fn cut(&self, other: [f64; 2]) -> Self {
        let half = 0.5 * (other[0] * other[0] + other[1] * other[1]);
        let beyond = |corner: [f64; 2]| corner[0] * other[0] + corner[1] * other[1] - half;
        let mut kept = Self {
            corners: [[0.0; 2]; MOST_CORNERS],
            count: 0,
        };
        for at in 0..self.count {
            let from = self.corners[at];
            let to = self.corners[(at + 1) % self.count];
            let (from_beyond, to_beyond) = (beyond(from), beyond(to));
            if from_beyond <= 0.0 {
                kept.push(from);
            }
            if (from_beyond <= 0.0) != (to_beyond <= 0.0) {
                let part = from_beyond / (from_beyond - to_beyond);
                kept.push([0, 1].map(|axis| from[axis] + part * (to[axis] - from[axis])));
            }
        }
        kept
    }

    /// Adds a corner; a cell of more than any 16 neighbours make keeps its first ones.
    fn push(&mut self, corner: [f64; 2]) {
        if let Some(place) = self.corners.get_mut(self.count) {
            *place = corner;
            self.count += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Offsets to points of a plane, nearest first.
    fn sorted(mut offsets: Vec<DVec3>) -> Vec<DVec3> {
        offsets.sort_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
        offsets
    }

    #[test]
    fn in_a_grid_the_disk_reaches_the_middle_of_a_square() {
        let grid =
            (-2..=2).flat_map(|x| (-2..=2).map(move |y| DVec3::new(x.into(), y.into(), 0.0)));
        let offsets = sorted(grid.filter(|offset| *offset != DVec3::ZERO).collect());
        let radius = covering_radius(DVec3::Z, offsets.into_iter(), 5.0);
        assert!((radius - 0.5_f64.sqrt()).abs() < 1e-12, "{radius}");
    }

    #[test]
    fn a_gap_on_one_side_makes_the_disk_larger() {
        let offsets = [
            DVec3::new(1.0, 0.0, 0.0),
            DVec3::new(0.0, 1.0, 0.0),
            DVec3::new(0.0, -1.0, 0.0),
            DVec3::new(-3.0, 0.0, 0.0),
        ];
        let radius = covering_radius(DVec3::Z, offsets.into_iter(), 5.0);
        // The corner (-1.5, 0.5).
        assert!((radius - 2.5_f64.sqrt()).abs() < 1e-12, "{radius}");
        let none = covering_radius(DVec3::Z, std::iter::empty(), 5.0);
        assert_eq!(none, 5.0);
    }

    #[test]
    fn the_other_side_of_a_thin_wall_cuts_nothing_off() {
        let wall = DVec3::new(0.05, 0.0, -0.1);
        let offsets = [wall, DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y];
        let radius = covering_radius(DVec3::Z, offsets.into_iter(), 5.0);
        assert!((radius - 0.5_f64.sqrt()).abs() < 1e-12, "{radius}");
    }
}
