//! Halving a set of nodes at the median of the longest side of the box round their centres.

use bytemuck::{Pod, Zeroable};
use pointstage_plugin_api::glam::{UVec3, Vec4};

/// From so many records on, a median is sought in steps between which a cancelled build is noticed.
const LARGE: usize = 1 << 20;

/// Records between two looks at whether the build is cancelled.
const STRETCH: usize = 1 << 16;

/// Keys that a pivot is chosen from.
const SAMPLE: usize = 255;

/// A node's centre and its number in its level; what is moved about instead of the node.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Record {
    /// Centre on the grid, whole numbers: as floats they have the order of their bits.
    place: [f32; 3],
    /// Number in the level, in the order in which its nodes were made.
    pub(crate) node: u32,
}

impl Record {
    pub(crate) fn new(place: UVec3, node: u32) -> Self {
        Self {
            place: place.as_vec3().to_array(),
            node,
        }
    }

    /// Orders by the coordinate, then by number: no two are alike, so the halves do not depend on how they are found.
    #[inline]
    fn key<const AXIS: usize>(&self) -> u64 {
        u64::from(self.place[AXIS].to_bits()) << 32 | u64::from(self.node)
    }
}

/// Moves the records of the lesser half before the others, and says how many those are: half, rounded down.
///
/// Within the halves the order is arbitrary. Stops early, with the records in any order, once `cancelled` says so.
pub(crate) fn halve(records: &mut [Record], cancelled: &dyn Fn() -> bool) -> usize {
    let middle = records.len() / 2;
    match longest_axis(records, cancelled) {
        0 => select::<0>(records, middle, cancelled),
        1 => select::<1>(records, middle, cancelled),
        _ => select::<2>(records, middle, cancelled),
    }
    middle
}

/// The axis along which the records' centres are spread most; the first of equals.
fn longest_axis(records: &[Record], cancelled: &dyn Fn() -> bool) -> usize {
    let (mut least, mut greatest) = (Vec4::INFINITY, Vec4::NEG_INFINITY);
    for stretch in records.chunks(STRETCH) {
        if cancelled() {
            break;
        }
        for &Record {
            place: [x, y, z], ..
        } in stretch
        {
            let place = Vec4::new(x, y, z, 0.0);
            least = least.min(place);
            greatest = greatest.max(place);
        }
    }
    let extent = (greatest - least).truncate();
    if extent.x >= extent.y && extent.x >= extent.z {
        0
    } else if extent.y >= extent.z {
        1
    } else {
        2
    }
}

/// Moves the `middle` records of least keys to the front.
fn select<const AXIS: usize>(
    mut records: &mut [Record],
    mut middle: usize,
    cancelled: &dyn Fn() -> bool,
) {
    while records.len() > LARGE {
        let pivot = sampled_key::<AXIS>(records, middle);
        let Some(below) = partition::<AXIS>(records, pivot, cancelled) else {
            return;
        };
        if below == 0 {
            break;
        }
        if middle < below {
            records = &mut records[..below];
        } else {
            records = &mut records[below..];
            middle -= below;
        }
    }
    if middle < records.len() && !cancelled() {
        records.select_nth_unstable_by_key(middle, Record::key::<AXIS>);
    }
}

/// The key of one of the records, about as many below it as `middle`.
fn sampled_key<const AXIS: usize>(records: &[Record], middle: usize) -> u64 {
    let stride = records.len() / SAMPLE;
    let mut sample: [u64; SAMPLE] =
        core::array::from_fn(|place| records[place * stride].key::<AXIS>());
    let place = (middle * SAMPLE / records.len()).min(SAMPLE - 1);
    *sample.select_nth_unstable(place).1
}

/// Moves the records with keys below the pivot to the front and counts them; none once cancelled.
fn partition<const AXIS: usize>(
    records: &mut [Record],
    pivot: u64,
    cancelled: &dyn Fn() -> bool,
) -> Option<usize> {
    let mut below = 0;
    for start in (0..records.len()).step_by(STRETCH) {
        if cancelled() {
            return None;
        }
        for place in start..records.len().min(start + STRETCH) {
            let is_below = records[place].key::<AXIS>() < pivot;
            records.swap(place, below);
            below += usize::from(is_below);
        }
    }
    Some(below)
}

#[cfg(test)]
mod tests {
    use super::{LARGE, Record, halve, longest_axis, partition, select};
    use pointstage_plugin_api::glam::UVec3;

    fn scattered(count: u32, sides: UVec3) -> Vec<Record> {
        let spread = |node: u32, factor: u32, side: u32| {
            node.wrapping_mul(factor).rotate_left(7) % side.max(1)
        };
        (0..count)
            .map(|node| {
                let place = UVec3::new(
                    spread(node, 2_654_435_761, sides.x),
                    spread(node, 2_246_822_519, sides.y),
                    spread(node, 3_266_489_917, sides.z),
                );
                Record::new(place, node)
            })
            .collect()
    }

    #[test]
    fn halves_lie_to_each_side_of_the_median() {
        for count in [5, 8, 9, 1000] {
            let mut records = scattered(count, UVec3::new(50, 900, 3));
            let middle = halve(&mut records, &|| false);
            assert_eq!(middle, count as usize / 2);
            let (lower, upper) = records.split_at(middle);
            let greatest = lower.iter().map(Record::key::<1>).max();
            assert!(greatest < upper.iter().map(Record::key::<1>).min());
        }
    }

    #[test]
    fn the_longest_axis_is_found_and_equal_centres_have_one_too() {
        let axis = |sides: UVec3| longest_axis(&scattered(500, sides), &|| false);
        assert_eq!(axis(UVec3::new(900, 5, 5)), 0);
        assert_eq!(axis(UVec3::new(5, 5, 900)), 2);
        assert_eq!(axis(UVec3::ONE), 0);
    }

    #[test]
    fn large_sets_are_halved_as_small_ones_are() {
        let count = LARGE as u32 + 12_345;
        for sides in [UVec3::new(1 << 21, 1, 1), UVec3::ONE] {
            let mut records = scattered(count, sides);
            let middle = halve(&mut records, &|| false);
            let (lower, upper) = records.split_at(middle);
            assert!(
                lower.iter().map(Record::key::<0>).max() < upper.iter().map(Record::key::<0>).min()
            );
        }
    }

    #[test]
    fn a_cancelled_selection_stops() {
        let mut records = scattered(LARGE as u32 + 1, UVec3::splat(999));
        assert_eq!(partition::<0>(&mut records, 1 << 40, &|| true), None);
        select::<0>(&mut records, 7, &|| true);
    }
}
