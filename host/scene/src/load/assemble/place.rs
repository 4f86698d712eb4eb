//! Positions and radii of vertices, around an origin that keeps them precise.

use std::ops::Range;

use glam::DVec3;

use super::roles::Roles;
use super::table::{Piece, RowSelection};
use super::triples::Triples;
use crate::bounds::Bounds;
use crate::job::{Cancelled, Job};
use crate::load::fill::{Column, PIECE_SURFELS, fill_blocks};

/// Largest coordinate taken for one: squares of larger ones leave the range of f32.
pub(in crate::load) const MAX_COORDINATE: f64 = 1e18;

/// Positions get an origin of their own when they are farther from 0 than this many times their box is large: f32 then
/// keeps less than a millionth of the box, 16 · 2⁻²⁴.
const FAR_FROM_ORIGIN: f64 = 16.0;

/// What placing the vertices found.
#[derive(Clone, Copy, Debug)]
pub(in crate::load) struct Placed {
    pub(in crate::load) bounds: Bounds,
    pub(in crate::load) not_finite: usize,
    pub(in crate::load) without_radius: usize,
}

impl Default for Placed {
    fn default() -> Self {
        Self {
            bounds: Bounds::EMPTY,
            not_finite: 0,
            without_radius: 0,
        }
    }
}

impl Placed {
    /// Both together.
    pub(in crate::load) fn merge(self, other: Self) -> Self {
        Self {
            bounds: self.bounds.union(other.bounds),
            not_finite: self.not_finite + other.not_finite,
            without_radius: self.without_radius + other.without_radius,
        }
    }
}

/// The origin for a box: 0, or a round number near its centre when it is far from 0 for its size.
///
/// The number is a multiple of a power of two close to the box's size, so that subtracting it from an f32 is exact.
pub(crate) fn origin_for(bounds: &Bounds) -> DVec3 {
    if bounds.is_empty() {
        return DVec3::ZERO;
    }
    let farthest = bounds.min.abs().max(bounds.max.abs()).max_element();
    let size = bounds.size().max_element();
    if farthest <= FAR_FROM_ORIGIN * size || farthest == 0.0 {
        return DVec3::ZERO;
    }
    // What is smaller has no size in f32, and no power of two beside it.
    if size < f64::from(f32::MIN_POSITIVE) {
        return bounds.centre();
    }
    let step = size.log2().floor().exp2();
    (bounds.centre() / step).round() * step
}

/// A box as seen from `origin`, with the precision of positions.
pub(in crate::load) fn relative(bounds: &Bounds, origin: DVec3) -> Bounds {
    let local = |corner: DVec3| (corner - origin).as_vec3().as_dvec3();
    Bounds::new(local(bounds.min), local(bounds.max))
}

/// Whether a surfel can stand there.
#[inline]
pub(in crate::load) fn usable([x, y, z]: [f64; 3]) -> bool {
    // Written so that NaN fails.
    x.abs() <= MAX_COORDINATE && y.abs() <= MAX_COORDINATE && z.abs() <= MAX_COORDINATE
}

/// Centres (less `origin`) and radii of the selected rows.
pub(in crate::load) fn place(
    roles: &Roles<'_>,
    rows: &RowSelection,
    origin: DVec3,
    job: &Job,
) -> Result<(Column<[f32; 4]>, Placed), Cancelled> {
    let fields = [Some(roles.x), Some(roles.y), roles.z, roles.radius];
    let place_one = |placed: &mut Placed, centre: DVec3, radius: f64, slot: &mut [f32; 4]| {
        if !usable(centre.to_array()) {
            placed.not_finite += 1;
            return;
        }
        placed.bounds = placed.bounds.with_point(centre);
        let local = (centre - origin).as_vec3();
        let radius = if radius > 0.0 && radius <= MAX_COORDINATE {
            radius as f32
        } else {
            0.0
        };
        placed.without_radius += usize::from(radius <= 0.0);
        *slot = [local.x, local.y, local.z, radius];
    };
    let triples = roles.z.and_then(|z| Triples::of([roles.x, roles.y, z]));
    let is_plain = matches!(rows, RowSelection::All(_)) && roles.radius.is_none();
    let convert = |range: Range<usize>, slots: &mut [[f32; 4]]| {
        let mut placed = Placed::default();
        if let Some(triples) = triples.filter(|_| is_plain) {
            triples.each(&range, slots, |centre, slot| {
                place_one(&mut placed, centre, 0.0, slot);
            });
            return placed;
        }
        let piece = Piece::read(&fields, rows, &range);
        let [xs, ys, zs, radii] = &piece.values;
        for (index, slot) in slots.iter_mut().enumerate() {
            let centre = DVec3::new(xs[index], ys[index], zs[index]);
            place_one(&mut placed, centre, radii[index], slot);
        }
        placed
    };
    fill_blocks(rows.len(), 1, job, convert, Placed::merge)
}

/// New index of each row: rows that cannot be placed get `u32::MAX`, the others count on.
pub(in crate::load) fn new_indices(roles: &Roles<'_>, row_count: usize) -> Vec<u32> {
    let fields = [Some(roles.x), Some(roles.y), roles.z];
    let rows = RowSelection::All(row_count);
    let mut next = 0;
    let mut indices = Vec::with_capacity(row_count);
    for start in (0..row_count).step_by(PIECE_SURFELS) {
        let range = start..row_count.min(start + PIECE_SURFELS);
        let piece = Piece::read(&fields, &rows, &range);
        let [xs, ys, zs] = &piece.values;
        indices.extend((0..range.len()).map(|index| {
            if !usable([xs[index], ys[index], zs[index]]) {
                return u32::MAX;
            }
            next += 1;
            next - 1
        }));
    }
    indices
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_far_boxes_get_an_origin() {
        let near = Bounds::new(DVec3::splat(-1.0), DVec3::splat(10.0));
        assert_eq!(origin_for(&near), DVec3::ZERO);
        assert_eq!(origin_for(&Bounds::EMPTY), DVec3::ZERO);
        let smallest = Bounds::new(DVec3::splat(-4e-300), DVec3::new(5e-324, -4e-300, -4e-300));
        assert!(origin_for(&smallest).is_finite());
        let point_like = Bounds::new(DVec3::ONE, DVec3::new(1.0, 1.0 + 1e-315, 1.0));
        assert!(origin_for(&point_like).is_finite());
        let far = Bounds::new(
            DVec3::new(500_000.1, 0.0, 0.0),
            DVec3::new(500_100.1, 80.0, 30.0),
        );
        assert_eq!(origin_for(&far), DVec3::new(500_032.0, 64.0, 0.0));
        let point = Bounds::new(DVec3::splat(7.5), DVec3::splat(7.5));
        assert_eq!(origin_for(&point), DVec3::splat(7.5));
    }

    #[test]
    fn an_origin_is_subtracted_exactly_from_f32() {
        let bounds = Bounds::new(DVec3::splat(4_900_000.0), DVec3::splat(4_900_123.25));
        let origin = origin_for(&bounds);
        for value in [4_900_000.0_f32, 4_900_123.0, 4_900_077.5] {
            let local = (f64::from(value) - origin.x) as f32;
            assert_eq!(f64::from(local) + origin.x, f64::from(value));
        }
    }
}
