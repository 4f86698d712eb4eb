//! The part of a point set that a picture should show: all of it, but for points that lie far from everything.
//!
//! One stray point of a scan, a kilometre away, would make the scan a dot. The box that is framed is found so:
//!
//! 1. At most 16,384 points, evenly strewn over the file's order, give the box from the 1st to the 99th percentile along
//!    each axis.
//! 2. If the box of all points is no more than 4 times as large (their diagonals), nothing strays: all is framed.
//! 3. Else the box of the points within three times the percentiles' box is framed (as much again on each side).
//!
//! Meshes are framed as a whole: a far vertex is the corner of a face that is seen.

use glam::Vec3;

use crate::bounds::Bounds;
use crate::geometry::Geometry;

/// Points that are looked at for percentiles, at most.
const SAMPLE_POINTS: usize = 1 << 14;

/// Part of the points on each side of an axis that may stray.
const STRAY_PART: f64 = 0.01;

/// The whole is this many times as large as most of it before anything counts as straying.
const CLEAN_RATIO: f64 = 4.0;

/// The box to frame, in the geometry's own space.
pub(crate) fn framed_bounds(geometry: &Geometry) -> Bounds {
    let whole = geometry.bounds;
    if geometry.triangles.is_some() || whole.is_empty() {
        return whole;
    }
    let most = percentiles(geometry);
    let most_size = most.size().length();
    // Where most points are at one place, all others would stray.
    if !(most_size > 0.0 && whole.size().length() > CLEAN_RATIO * most_size) {
        return whole;
    }
    let near = Bounds::new(most.min - most.size(), most.max + most.size());
    centres(geometry)
        .map(Vec3::as_dvec3)
        .filter(|centre| near.min.cmple(*centre).all() && centre.cmple(near.max).all())
        .fold(Bounds::EMPTY, Bounds::with_point)
}

fn centres(geometry: &Geometry) -> impl Iterator<Item = Vec3> {
    let slots = geometry
        .blocks
        .iter()
        .flat_map(|block| block.position_radius.iter());
    slots.map(|&[x, y, z, _]| Vec3::new(x, y, z))
}

/// The box between the percentiles of a sample.
fn percentiles(geometry: &Geometry) -> Bounds {
    let step = geometry.surfel_count.div_ceil(SAMPLE_POINTS).max(1);
    let sample: Vec<Vec3> = (0..geometry.surfel_count)
        .step_by(step)
        .filter_map(|surfel| geometry.locate(surfel))
        .map(|(block, inside)| block.centre(inside))
        .collect();
    if sample.is_empty() {
        return Bounds::EMPTY;
    }
    let last = sample.len() - 1;
    let stray = (last as f64 * STRAY_PART) as usize;
    let (mut low, mut high) = (Vec3::ZERO, Vec3::ZERO);
    for axis in 0..3 {
        let mut values: Vec<f32> = sample.iter().map(|centre| centre[axis]).collect();
        low[axis] = *values.select_nth_unstable_by(stray, f32::total_cmp).1;
        high[axis] = *values
            .select_nth_unstable_by(last - stray, f32::total_cmp)
            .1;
    }
    Bounds::new(low.as_dvec3(), high.as_dvec3())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DVec3;

    use super::*;
    use crate::geometry::{Block, Origins};

    fn points(centres: impl IntoIterator<Item = [f32; 3]>) -> Geometry {
        let slots = centres.into_iter().map(|[x, y, z]| [x, y, z, 0.1]);
        let block = Block {
            position_radius: slots.collect(),
            ..Block::default()
        };
        Geometry::new(vec![block], None, Origins::default())
    }

    /// A spiral up a cylinder of radius 1 and height 2.
    fn spiral(count: u16) -> impl Iterator<Item = [f32; 3]> {
        (0..count).map(move |number| {
            let turn = f32::from(number) * 0.1;
            [
                turn.cos(),
                2.0 * f32::from(number) / f32::from(count),
                turn.sin(),
            ]
        })
    }

    #[test]
    fn clean_points_are_framed_as_a_whole() {
        for geometry in [
            points(spiral(30_000)),
            points(spiral(3)),
            // A line, and a tail that thins out.
            points((0..1000_u16).map(|x| [f32::from(x), 0.0, 0.0])),
            points((0..1000_u16).map(|x| [f32::from(x).powi(2), 0.0, 0.0])),
        ] {
            assert_eq!(framed_bounds(&geometry), geometry.bounds);
        }
    }

    #[test]
    fn points_that_stray_are_left_out_and_the_others_framed_to_the_last() {
        let stray = [[1e5, 0.0, 0.0], [0.0, -3e4, 0.0], [20.0, 20.0, 20.0]];
        let geometry = points(spiral(30_000).chain(stray));
        assert_eq!(framed_bounds(&geometry), points(spiral(30_000)).bounds);
        assert!(geometry.bounds.max.x == 1e5, "the true box stays");
    }

    #[test]
    fn a_mesh_is_framed_as_a_whole() {
        let mut mesh = points(spiral(30_000).chain([[1e5, 0.0, 0.0]]));
        mesh.triangles = Some(Arc::from([[0, 1, 30_000]]));
        assert_eq!(framed_bounds(&mesh), mesh.bounds);
    }

    #[test]
    fn nothing_and_one_place_are_no_trouble() {
        assert!(framed_bounds(&points([])).is_empty());
        let same = points(std::iter::repeat_n([2.0; 3], 500).chain([[9.0; 3]]));
        assert_eq!(
            framed_bounds(&same),
            Bounds::new(DVec3::splat(2.0), DVec3::splat(9.0))
        );
    }
}
