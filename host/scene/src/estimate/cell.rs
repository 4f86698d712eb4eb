//! How large a disk or an ellipse must be to cover what lies nearer to its point than to any other.
//!
//! In the plane, the points that are nearer to one point than to its neighbours form its Voronoi cell. Disks that reach
//! the farthest corner of their cells cover everything, whatever the sampling: no more than is needed where points form
//! a grid, and enough where they were strewn at random (disks of one size for a density leave exp(-n) of the plane open,
//! with n disks over each place on average: 4 of 100 with three of them). Ellipses that hold their cells cover everything
//! too, and reach less far beyond them where points lie denser along one direction than across it, as scan lines do.

use glam::DVec3;

/// Corners of a cell that are kept; 16 neighbours cut a square into fewer than 21, and of more than that few cut anything
/// off.
const MOST_CORNERS: usize = 24;

/// Neighbours farther off the plane than along it belong to another sheet of the surface, as in thin walls.
const STEEPEST: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Longest half-axis over shortest, at most: thinner splats would vanish between pixels.
const MOST_ASPECT: f64 = 8.0;

/// An ellipse in the plane of a surfel.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ellipse {
    /// Longer half-axis.
    pub(super) long: DVec3,
    /// Length of the shorter one, which is orthogonal to `long` and to the normal.
    pub(super) short_length: f64,
}

/// The corners of a convex polygon round the origin.
#[derive(Clone, Copy)]
struct Polygon {
    corners: [[f64; 2]; MOST_CORNERS],
    count: usize,
}

/// What lies nearer to a point of a surface than to its neighbours, in the tangent plane.
pub(super) struct Cell {
    polygon: Polygon,
    /// Axes of the plane, unit.
    u: DVec3,
    v: DVec3,
    greatest: f64,
}

impl Cell {
    /// The cell of a point.
    ///
    /// * `normal`: of the plane, unit.
    /// * `offsets`: from the point to its neighbours, nearest first.
    /// * `greatest`: where no neighbour is on one side, at the border of a scan, the cell has no end; it ends here.
    pub(super) fn new(normal: DVec3, offsets: impl Iterator<Item = DVec3>, greatest: f64) -> Self {
        let (u, v) = normal.any_orthonormal_pair();
        let mut polygon = Polygon::square(greatest);
        for offset in offsets {
            let squared = offset.length_squared();
            let reach = polygon.reach_squared();
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
                polygon = polygon.cut(flat.map(|along| along * scale));
            }
        }
        Self {
            polygon,
            u,
            v,
            greatest,
        }
    }

    /// Radius of the disk that holds the cell: the distance of its farthest corner, at most `greatest`.
    pub(super) fn radius(&self) -> f64 {
        self.polygon.reach_squared().sqrt().min(self.greatest)
    }

    /// The ellipse that holds the cell and has the shape of its covariance.
    ///
    /// ```text
    /// Σ = ∫ x xᵀ dx / ∫ dx   over the cell, x from the point;   Σ e₁ = λ₁ e₁,  Σ e₂ = λ₂ e₂
    /// ρ² = max over the corners c of cᵀ Σ⁻¹ c                   half-axes ρ √λ₁ e₁ and ρ √λ₂ e₂
    /// ```
    ///
    /// For a square cell it is the disk of [`radius`](Self::radius). No half-axis is longer than `greatest`, and none
    /// shorter than an eighth of the other.
    pub(super) fn ellipse(&self) -> Ellipse {
        let corners = &self.polygon.corners[..self.polygon.count];
        let (mut area, mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0, 0.0);
        for (at, &[ax, ay]) in corners.iter().enumerate() {
            let [bx, by] = corners[(at + 1) % corners.len()];
            // Twice the area of the triangle with the origin; 12 and 24 are those of its moments.
            let cross = ax * by - ay * bx;
            area += cross / 2.0;
            xx += cross * (ax * ax + ax * bx + bx * bx) / 12.0;
            yy += cross * (ay * ay + ay * by + by * by) / 12.0;
            xy += cross * (2.0 * ax * ay + ax * by + bx * ay + 2.0 * bx * by) / 24.0;
        }
        let radius = self.radius();
        let [xx, xy, yy] = [xx / area, xy / area, yy / area];
        let half_difference = 0.5 * (xx - yy);
        let spread = half_difference.hypot(xy);
        let long = 0.5 * (xx + yy) + spread;
        if !(long > 0.0 && long.is_finite()) {
            return Ellipse {
                long: self.u * radius,
                short_length: radius,
            };
        }
        let short = (long - 2.0 * spread).max(long / MOST_ASPECT.powi(2));
        let (sine, cosine) = (0.5 * xy.atan2(half_difference)).sin_cos();
        let reach_squared = corners
            .iter()
            .map(|[x, y]| {
                let (along, across) = (x * cosine + y * sine, y * cosine - x * sine);
                along * along / long + across * across / short
            })
            .fold(0.0, f64::max);
        let half = |variance: f64| (reach_squared * variance).sqrt().min(self.greatest);
        Ellipse {
            long: (self.u * cosine + self.v * sine) * half(long),
            short_length: half(short),
        }
    }
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

    fn covering_radius(normal: DVec3, offsets: impl Iterator<Item = DVec3>, greatest: f64) -> f64 {
        Cell::new(normal, offsets, greatest).radius()
    }

    #[test]
    fn the_ellipse_of_a_square_cell_is_its_disk() {
        let cross = [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y];
        let cell = Cell::new(DVec3::Z, cross.into_iter(), 5.0);
        let ellipse = cell.ellipse();
        assert!((ellipse.long.length() - cell.radius()).abs() < 1e-12);
        assert!((ellipse.short_length - cell.radius()).abs() < 1e-12);
    }

    #[test]
    fn the_ellipse_between_scan_lines_reaches_across_them() {
        // Points 1 apart on lines 4 apart, the lines turned by 30 degrees.
        let turn = glam::DQuat::from_rotation_z(std::f64::consts::FRAC_PI_6);
        let lines = (-5..=5)
            .flat_map(|x| (-1..=1).map(move |y| DVec3::new(x.into(), f64::from(y) * 4.0, 0.0)));
        let offsets = sorted(
            lines
                .filter(|offset| *offset != DVec3::ZERO)
                .map(|offset| turn * offset)
                .collect(),
        );
        let ellipse = Cell::new(DVec3::Z, offsets.into_iter(), 9.0).ellipse();
        // A rectangle of 1 by 4: √½ of each side.
        let (long, short) = (2.0 * 2.0_f64.sqrt(), 0.5_f64.sqrt());
        assert!((ellipse.long.length() - long).abs() < 1e-9, "{ellipse:?}");
        assert!((ellipse.short_length - short).abs() < 1e-9, "{ellipse:?}");
        let across = (turn * DVec3::Y).dot(ellipse.long).abs();
        assert!((across - long).abs() < 1e-9, "{ellipse:?}");
    }

    #[test]
    fn a_cell_of_nothing_has_some_ellipse() {
        for greatest in [0.0, 1.0] {
            let ellipse = Cell::new(DVec3::Z, std::iter::empty(), greatest).ellipse();
            assert!(
                ellipse.long.is_finite() && ellipse.short_length.is_finite(),
                "{ellipse:?}"
            );
        }
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
