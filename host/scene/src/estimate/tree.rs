//! A tree over points that finds the nearest neighbours of each.
//!
//! The points are sorted so that the half of any run that is farther along its longest side comes second; a run of at
//! most [`LEAF_POINTS`] is a leaf. So a node is a range of points, its children are the halves, and of the tree itself only
//! where each cut lies is stored. Cutting the longest side at the median is the prescription of Friedman, Bentley and Finkel
//! (Best Matches 1977).
//!
//! The crates of such trees build in one call that cannot be cancelled: for 12 M points it took 13 s here. This one looks at
//! the cancel flag before each cut; the longest takes a tenth of a second. On a million points of a closed surface in
//! random order it is built three times and searched twice as fast as that of kiddo 6.3.

use std::sync::atomic::{AtomicUsize, Ordering};

use crate::job::{Cancelled, Job};

/// Points in a leaf, at most.
const LEAF_POINTS: usize = 16;

/// Points from a cut to the next, at least: the smallest run that is cut has one more than a leaf.
const CUT_POINTS: usize = LEAF_POINTS.div_ceil(2);

/// Runs below this are sorted by one thread, without a look at the cancel flag.
const RUN_POINTS: usize = 1 << 14;

/// A point and its place before sorting.
#[derive(Clone, Copy, Debug)]
pub(super) struct TreePoint {
    pub(super) centre: [f32; 3],
    /// Index in the order of the points given.
    pub(super) index: u32,
}

/// Sorted points.
#[derive(Debug)]
pub(super) struct Tree {
    points: Vec<TreePoint>,
    /// The cut before point `i` at `i / CUT_POINTS`, which no other cut shares.
    cuts: Vec<Cut>,
}

/// Where a run is cut in two.
#[derive(Clone, Copy, Debug, Default)]
struct Cut {
    axis: u8,
    /// No coordinate before is larger, none after is smaller.
    at: f32,
}

/// The nearest points found so far, nearest first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest<const N: usize> {
    /// Squared distances; infinite where nothing was found.
    pub(super) squared: [f32; N],
    /// Where the points are in [`Tree::points`].
    pub(super) places: [u32; N],
}

impl Tree {
    /// Sorts the points; reports its progress through `part` of the job.
    pub(super) fn build(
        mut points: Vec<TreePoint>,
        part: &std::ops::Range<f32>,
        job: &Job,
    ) -> Result<Self, Cancelled> {
        let mut cuts = vec![Cut::default(); points.len() / CUT_POINTS + 1];
        let levels = (points.len().div_ceil(LEAF_POINTS)).max(2).ilog2() as usize + 1;
        let progress = Progress {
            job,
            part,
            sorted: AtomicUsize::new(0),
            total: levels * points.len(),
        };
        Run {
            start: 0,
            points: &mut points,
            cuts: &mut cuts,
        }
        .sort(levels, &progress)?;
        Ok(Self { points, cuts })
    }

    /// The points in the order of the tree: neighbours are near each other in memory too.
    pub(super) fn points(&self) -> &[TreePoint] {
        &self.points
    }

    /// The `N` nearest points to `centre`, one of the points among them.
    pub(super) fn nearest<const N: usize>(&self, centre: [f32; 3]) -> Nearest<N> {
        let mut nearest = Nearest {
            squared: [f32::INFINITY; N],
            places: [0; N],
        };
        self.search(0..self.points.len(), centre, [0.0; 3], &mut nearest);
        nearest
    }

    /// Searches a run; `beyond` is how far its box is away along each axis, as far as the cuts above tell.
    fn search<const N: usize>(
        &self,
        run: std::ops::Range<usize>,
        centre: [f32; 3],
        beyond: [f32; 3],
        nearest: &mut Nearest<N>,
    ) {
        if run.len() <= LEAF_POINTS {
            for (place, point) in (run.start as u32..).zip(&self.points[run]) {
                nearest.offer(squared_distance(point.centre, centre), place);
            }
            return;
        }
        let middle = run.start + run.len() / 2;
        let Cut { axis, at } = self.cuts[middle / CUT_POINTS];
        let axis = usize::from(axis);
        let offset = centre[axis] - at;
        let (near, far) = if offset < 0.0 {
            (run.start..middle, middle..run.end)
        } else {
            (middle..run.end, run.start..middle)
        };
        self.search(near, centre, beyond, nearest);
        let mut beyond = beyond;
        beyond[axis] = offset;
        let [x, y, z] = beyond;
        if x * x + y * y + z * z < nearest.squared[N - 1] {
            self.search(far, centre, beyond, nearest);
        }
    }
}

impl<const N: usize> Nearest<N> {
    /// Takes a point in if it is nearer than the farthest so far; one at no distance, NaN, is not.
    #[inline]
    fn offer(&mut self, squared: f32, place: u32) {
        if squared < self.squared[N - 1] {
            let mut slot = N - 1;
            while slot > 0 && squared < self.squared[slot - 1] {
                self.squared[slot] = self.squared[slot - 1];
                self.places[slot] = self.places[slot - 1];
                slot -= 1;
            }
            self.squared[slot] = squared;
            self.places[slot] = place;
        }
    }

    /// How many were found: `N` unless there are fewer points.
    pub(super) fn count(&self) -> usize {
        self.squared.partition_point(|squared| squared.is_finite())
    }
}

fn squared_distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    let (x, y, z) = (a[0] - b[0], a[1] - b[1], a[2] - b[2]);
    x * x + y * y + z * z
}

/// How far sorting is: points times levels.
struct Progress<'a> {
    job: &'a Job,
    part: &'a std::ops::Range<f32>,
    sorted: AtomicUsize,
    total: usize,
}

impl Progress<'_> {
    fn add(&self, points: usize) {
        let sorted = self.sorted.fetch_add(points, Ordering::Relaxed) + points;
        self.job.set_progress_within(self.part, sorted, self.total);
    }
}

/// Points to sort, and the cuts to make there.
struct Run<'a> {
    /// Place of the first point.
    start: usize,
    points: &'a mut [TreePoint],
    /// From that of `start` on.
    cuts: &'a mut [Cut],
}

impl Run<'_> {
    /// Sorts with `levels` of cuts to make.
    fn sort(self, levels: usize, progress: &Progress<'_>) -> Result<(), Cancelled> {
        progress.job.check()?;
        let points = self.points.len();
        if points <= RUN_POINTS {
            self.sort_small();
            progress.add(points * levels);
            return Ok(());
        }
        let (before, after) = self.cut();
        progress.add(points);
        let below = levels.saturating_sub(1);
        let (before, after) = rayon::join(
            || before.sort(below, progress),
            || after.sort(below, progress),
        );
        before.and(after)
    }

    fn sort_small(self) {
        if self.points.len() > LEAF_POINTS {
            let (before, after) = self.cut();
            before.sort_small();
            after.sort_small();
        }
    }

    /// Cuts in halves across the longest side.
    fn cut(self) -> (Self, Self) {
        let Self {
            start,
            points,
            cuts,
        } = self;
        let (low, high) = points.iter().fold(
            ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]),
            |(low, high), point| {
                let low = std::array::from_fn(|axis| f32::min(low[axis], point.centre[axis]));
                let high = std::array::from_fn(|axis| f32::max(high[axis], point.centre[axis]));
                (low, high)
            },
        );
        let side = |axis: usize| high[axis] - low[axis];
        let axis = (0..3_u8)
            .max_by(|a, b| side(usize::from(*a)).total_cmp(&side(usize::from(*b))))
            .unwrap_or(0);
        let coordinate = |point: &TreePoint| point.centre[usize::from(axis)];
        let half = points.len() / 2;
        let (_, first_after, _) =
            points.select_nth_unstable_by(half, |a, b| coordinate(a).total_cmp(&coordinate(b)));
        let at = coordinate(first_after);
        let slot = (start + half) / CUT_POINTS - start / CUT_POINTS;
        let (points_before, points_after) = points.split_at_mut(half);
        let (cuts_before, cuts_after) = cuts.split_at_mut(slot);
        cuts_after[0] = Cut { axis, at };
        let before = Self {
            start,
            points: points_before,
            cuts: cuts_before,
        };
        let after = Self {
            start: start + half,
            points: points_after,
            cuts: cuts_after,
        };
        (before, after)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn tree_of(centres: &[[f32; 3]]) -> Tree {
        let points = (0..).zip(centres);
        let points = points.map(|(index, &centre)| TreePoint { centre, index });
        Tree::build(points.collect(), &(0.0..1.0), &Job::new()).unwrap()
    }

    proptest! {
        #[test]
        fn the_nearest_are_those_of_a_full_search(
            centres in proptest::collection::vec(proptest::array::uniform3((-20..20_i8).prop_map(|value| f32::from(value) * 0.3)), 1..300),
        ) {
            let tree = tree_of(&centres);
            for &centre in centres.iter().step_by(7) {
                let found = tree.nearest::<17>(centre);
                let mut expected: Vec<f32> = centres.iter().map(|&other| squared_distance(other, centre)).collect();
                expected.sort_by(f32::total_cmp);
                expected.truncate(17);
                prop_assert_eq!(&found.squared[..found.count()], &expected);
                for (squared, place) in found.squared.iter().zip(found.places).take(found.count()) {
                    let point = tree.points()[place as usize];
                    prop_assert_eq!(point.centre, centres[point.index as usize]);
                    prop_assert_eq!(squared_distance(point.centre, centre), *squared);
                }
            }
        }
    }

    #[test]
    fn progress_ends_where_it_should() {
        for count in [1, 100, RUN_POINTS * 5 + 3] {
            let job = Job::new();
            let points = (0..count as u32).map(|index| TreePoint {
                centre: [
                    (index as f32).sin(),
                    (index as f32).cos(),
                    index as f32 * 1e-4,
                ],
                index,
            });
            Tree::build(points.collect(), &(0.25..0.5), &job).unwrap();
            assert!(
                (job.progress() - 0.5).abs() < 1e-6,
                "{count}: {}",
                job.progress()
            );
        }
    }
}
