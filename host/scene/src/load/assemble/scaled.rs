//! Positions that come as whole numbers with a scale and an offset.
//!
//! The numbers of the box's corners are the corners' numbers: scaling keeps order, also rounded. So the box, and the origin
//! that follows from it, are known before any number has been scaled, and positions can be made of them where they lie.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use super::place::usable;
use crate::bounds::Bounds;
use crate::job::{Cancelled, Job};
use crate::load::fill::{Column, TASK_SURFELS};

/// What whole numbers of positions stand for: `value = scale · number + offset`, axis by axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositionScale {
    /// Of one step.
    pub scale: DVec3,
    /// Of number 0, scene units.
    pub offset: DVec3,
}

impl PositionScale {
    /// The box of positions of which the box of numbers is known; `None` if some of them cannot be placed.
    pub(in crate::load) fn bounds(&self, numbers: &NumberBox) -> Option<Bounds> {
        let NumberBox { low, high } = *numbers;
        let corner = |numbers: [i32; 3]| {
            self.scale * DVec3::from_array(numbers.map(f64::from)) + self.offset
        };
        let (a, b) = (corner(low), corner(high));
        let is_empty = low[0] > high[0];
        let fits = usable(a.to_array()) && usable(b.to_array()) && !is_empty;
        // A scale may be negative.
        fits.then(|| Bounds::new(a.min(b), a.max(b)))
    }

    /// Makes positions, less `origin`, and radii of 0 of the bits of three numbers and a 0 each, in their own memory.
    pub(in crate::load) fn place(
        &self,
        numbers: Column<[u32; 4]>,
        origin: DVec3,
        job: &Job,
    ) -> Result<Column<[f32; 4]>, Cancelled> {
        let four = |axes: DVec3| [axes.x, axes.y, axes.z, 0.0];
        let (scale, offset, origin) = (four(self.scale), four(self.offset), four(origin));
        let place = |slots: &mut [[u32; 4]]| {
            job.check()?;
            for slot in slots {
                *slot = std::array::from_fn(|axis| {
                    let number = f64::from(slot[axis].cast_signed());
                    let local = scale[axis] * number + offset[axis] - origin[axis];
                    (local as f32).to_bits()
                });
            }
            Ok(())
        };
        let blocks = numbers.into_iter().map(|mut block| {
            Arc::make_mut(&mut block)
                .par_chunks_mut(TASK_SURFELS)
                .try_for_each(place)?;
            Ok(bytemuck::cast_slice_arc(block))
        });
        blocks.collect()
    }
}

/// Smallest and largest number of each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::load) struct NumberBox {
    low: [i32; 3],
    high: [i32; 3],
}

impl Default for NumberBox {
    /// The box of nothing.
    fn default() -> Self {
        Self {
            low: [i32::MAX; 3],
            high: [i32::MIN; 3],
        }
    }
}

impl NumberBox {
    /// The smallest box that holds both.
    pub(in crate::load) fn union(self, other: Self) -> Self {
        Self {
            low: std::array::from_fn(|axis| self.low[axis].min(other.low[axis])),
            high: std::array::from_fn(|axis| self.high[axis].max(other.high[axis])),
        }
    }

    /// Of positions of three `i32` each, native byte order.
    pub(in crate::load) fn of(positions: &[[u8; 12]]) -> Self {
        /// Numbers that are compared at once: whole positions, and whole vectors of the processor.
        const LANES: usize = 24;
        let mut low = [i32::MAX; LANES];
        let mut high = [i32::MIN; LANES];
        let (rows, rest) = positions.as_flattened().as_chunks::<{ 4 * LANES }>();
        for row in rows {
            let numbers = row.as_chunks::<4>().0;
            let row: [i32; LANES] = std::array::from_fn(|lane| i32::from_ne_bytes(numbers[lane]));
            low = std::array::from_fn(|lane| low[lane].min(row[lane]));
            high = std::array::from_fn(|lane| high[lane].max(row[lane]));
        }
        let rest = rest.as_chunks::<4>().0;
        for ((number, low), high) in rest.iter().zip(&mut low).zip(&mut high) {
            let number = i32::from_ne_bytes(*number);
            *low = number.min(*low);
            *high = number.max(*high);
        }
        let boxes = low.as_chunks::<3>().0.iter().zip(high.as_chunks::<3>().0);
        let boxes = boxes.map(|(low, high)| Self {
            low: *low,
            high: *high,
        });
        boxes.fold(Self::default(), Self::union)
    }

    /// Of many positions, on all cores.
    pub(in crate::load) fn of_many(positions: &[[u8; 12]]) -> Self {
        let parts = positions.par_chunks(TASK_SURFELS).map(Self::of);
        parts.reduce(Self::default, Self::union)
    }
}

/// The numbers of a position.
pub(in crate::load) fn numbers_of(position: &[u8; 12]) -> [i32; 3] {
    let numbers = position.as_chunks::<4>().0;
    std::array::from_fn(|axis| i32::from_ne_bytes(numbers[axis]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_of_numbers_is_that_of_their_values() {
        let by = PositionScale {
            scale: DVec3::new(0.5, -2.0, 1.0),
            offset: DVec3::new(0.0, 10.0, -1.0),
        };
        for count in [1_usize, 7, 8, 9, 40_000] {
            let numbers: Vec<[i32; 3]> = (0..count as i32)
                .map(|row| [row.wrapping_mul(0x0101_4567), 3 - row, i32::MIN + row])
                .collect();
            let expected = numbers.iter().fold(Bounds::EMPTY, |bounds, row| {
                let numbers = DVec3::from_array(row.map(f64::from));
                bounds.with_point(by.scale * numbers + by.offset)
            });
            let found = NumberBox::of_many(bytemuck::cast_slice(&numbers));
            assert_eq!(by.bounds(&found), Some(expected), "{count}");
        }
        assert_eq!(by.bounds(&NumberBox::default()), None);
        let endless = PositionScale {
            scale: DVec3::new(1.0, f64::INFINITY, 1.0),
            ..by
        };
        assert_eq!(endless.bounds(&NumberBox::of(&[[1; 12]; 2])), None);
    }
}
