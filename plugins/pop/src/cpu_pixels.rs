//! Pixels that the CPU fills with splats: several times as fast as a software device, which does the same on the same cores.
//!
//! Each thread has pixels of its own, which are joined in the end: by the greatest number, or by a sum of whole ones. Neither depends
//! on the order, so the picture does not depend on the threads.

use crate::cpu_splats::{Footprint, Gift, REACH, Stage};
use core::ops::Range;
use pointstage_plugin_api::glam::{Vec2, Vec4};
use pointstage_visibility::cpu::{depth_of, packed, share_out};

/// Splats that a thread takes at a time.
const SHARE: usize = 8_192;
/// A whole weight in the sums; `UNIT` of `shaders/visibility/sums.wesl`.
pub(crate) const UNIT: f32 = 65_536.0;

/// Splats that are drawn: all of one shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Kind {
    pub(crate) is_disk: bool,
    /// Whether sums are wanted.
    pub(crate) is_blended: bool,
}

/// What splats gave a pixel, in 65,536ths: weight times colour, and weight; weight times (normal + 1)/2.
type Sum = [u32; 8];

/// What the CPU has drawn, rows from the top, as the buffers of the compute path hold it.
#[derive(Debug, Default)]
pub(crate) struct Pixels {
    size: [usize; 2],
    /// Primitive (lower half) and bits of the depth (upper half); 0 where nothing is. What is greater is nearer.
    nearest: Layer<u64>,
    sums: Layer<Sum>,
    /// See `shaders/visibility/sums.wesl`; of blended splats.
    colours: Vec<[u32; 4]>,
    normals: Vec<[u32; 4]>,
}

/// A value for each pixel.
#[derive(Debug, Default)]
struct Layer<T> {
    values: Vec<T>,
    /// Those of all threads but the first, until they are joined.
    others: Vec<Vec<T>>,
}

impl Pixels {
    /// The nearest splats of all pixels.
    pub(crate) fn nearest(&self) -> &[u64] {
        &self.nearest.values
    }

    /// Sums of colours and of normals.
    pub(crate) fn sums(&self) -> [&[[u32; 4]]; 2] {
        [&self.colours, &self.normals]
    }

    /// Draws nodes of trees, on up to `thread_count` threads, in place of what was there.
    pub(crate) fn draw(
        &mut self,
        stages: &[(Stage<'_>, &[u32])],
        kind: Kind,
        size_px: [u32; 2],
        thread_count: usize,
    ) {
        self.size = size_px.map(|size| size as usize);
        let (size, count) = (self.size, self.size[0] * self.size[1]);
        let shares: Vec<(&Stage<'_>, &[u32])> = stages
            .iter()
            .flat_map(|(stage, nodes)| nodes.chunks(SHARE).map(move |share| (stage, share)))
            .collect();
        let draw = |pixels: &mut [u64], (stage, numbers): (&Stage<'_>, &[u32])| {
            for four in numbers.chunks(4) {
                for footprint in stage.footprints(four) {
                    let primitive = stage.primitive(footprint.number);
                    offer(&footprint, primitive, kind.is_disk, size, pixels);
                }
            }
        };
        let nearer = |own: &mut u64, other: &u64| *own = (*own).max(*other);
        self.nearest
            .fill(count, &shares, thread_count, draw, nearer);
        if !kind.is_blended {
            return;
        }

        let nearest = &self.nearest.values;
        let give = |sums: &mut [Sum], (stage, numbers): (&Stage<'_>, &[u32])| {
            for four in numbers.chunks(4) {
                for footprint in stage.footprints(four) {
                    give(stage, &footprint, size, nearest, sums);
                }
            }
        };
        let add = |own: &mut Sum, other: &Sum| {
            for (own, other) in own.iter_mut().zip(other) {
                *own = own.saturating_add(*other);
            }
        };
        self.sums.fill(count, &shares, thread_count, give, add);
        self.colours.resize(count, [0; 4]);
        self.normals.resize(count, [0; 4]);
        let targets = self.colours.iter_mut().zip(&mut self.normals);
        for ((colour, normal), sum) in targets.zip(&self.sums.values) {
            let [red, green, blue, weight, x, y, z, _] = *sum;
            *colour = [red, green, blue, weight];
            // The fourth is the coverage.
            *normal = [x, y, z, if weight > 0 { UNIT as u32 } else { 0 }];
        }
    }
}

impl<T: Clone + Copy + Default + Send + Sync> Layer<T> {
    /// Works on shares, on up to `thread_count` threads, from empty values on.
    fn fill<S: Copy + Send + Sync>(
        &mut self,
        count: usize,
        shares: &[S],
        thread_count: usize,
        work: impl Fn(&mut [T], S) + Sync,
        join: impl Fn(&mut T, &T),
    ) {
        let more_threads = thread_count.min(shares.len()).saturating_sub(1);
        self.others.resize(more_threads, Vec::new());
        let own = core::iter::once(&mut self.values);
        let mut states: Vec<_> = own.chain(&mut self.others).collect();
        for values in &mut states {
            values.clear();
        }
        share_out(shares.iter(), &mut states, |values, share| {
            // Only of a thread that has something to do.
            values.resize(count, T::default());
            work(values, *share);
        });
        self.values.resize(count, T::default());
        for other in &self.others {
            for (own, other) in self.values.iter_mut().zip(other) {
                join(own, other);
            }
        }
    }
}

/// Offers a splat to the pixels that it covers.
#[inline]
fn offer(
    footprint: &Footprint,
    primitive: u32,
    is_disk: bool,
    [width, height]: [usize; 2],
    pixels: &mut [u64],
) {
    let Footprint {
        centre,
        half,
        depth,
        fall,
        ..
    } = *footprint;
    let columns = pixels_within(centre.x, half.x, width as f32);
    let scale = Vec2::ONE / half;
    for row in pixels_within(centre.y, half.y, height as f32) {
        let down = (row as f32 + 0.5 - centre.y) * scale.y;
        let start = row * width;
        let Some(row) = pixels.get_mut(start + columns.start..start + columns.end) else {
            return;
        };
        for (column, pixel) in row.iter_mut().enumerate() {
            let across = ((columns.start + column) as f32 + 0.5 - centre.x) * scale.x;
            let share = across * across + down * down;
            if share <= 1.0 || !is_disk {
                let depth = if is_disk { depth - fall * share } else { depth };
                // What falls behind the far plane is not seen.
                *pixel = (*pixel).max(packed(depth.max(0.0), primitive));
            }
        }
    }
}

/// Adds a splat's share to the sums of the pixels round it.
#[inline]
fn give(
    stage: &Stage<'_>,
    footprint: &Footprint,
    [width, height]: [usize; 2],
    nearest: &[u64],
    sums: &mut [Sum],
) {
    let centre = footprint.centre;
    let half = REACH * footprint.half;
    let columns = pixels_within(centre.x, half.x, width as f32);
    let scale = Vec2::ONE / half;
    // Most splats are hidden: what they look like is not asked for.
    let mut gift: Option<Gift> = None;
    let limit = Stage::blends_until(footprint);
    for row in pixels_within(centre.y, half.y, height as f32) {
        let down = (row as f32 + 0.5 - centre.y) * scale.y;
        let places = row * width + columns.start..row * width + columns.end;
        let nearest = nearest.get(places.clone()).unwrap_or_default();
        let sums = sums.get_mut(places).unwrap_or_default();
        for (column, (nearest, sum)) in nearest.iter().zip(sums).enumerate() {
            let across = ((columns.start + column) as f32 + 0.5 - centre.x) * scale.x;
            let squared = across * across + down * down;
            if squared > 1.0 || limit < depth_of(*nearest) {
                continue;
            }
            let gift = gift.get_or_insert_with(|| stage.gift(footprint));
            let weight = gift.peak * UNIT * kernel(squared);
            let shares = [gift.colour, gift.normal].map(|value| value * weight + 0.5);
            for (sums, share) in sum.chunks_exact_mut(4).zip(shares) {
                for (sum, share) in sums.iter_mut().zip(Vec4::to_array(&share)) {
                    *sum = sum.saturating_add(share as i32 as u32);
                }
            }
        }
    }
}

/// exp(-2·x) for 0..1: off by at most 2e-6.
#[inline]
fn kernel(x: f32) -> f32 {
    let x = 0.25 * x;
    let part = 1.0 - x * (1.0 - x * (0.5 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x / 120.0))));
    let squared = part * part;
    let fourth = squared * squared;
    fourth * fourth
}

/// Pixels whose centres lie within; what is not finite ends at the bounds.
#[inline]
fn pixels_within(centre: f32, half: f32, size: f32) -> Range<usize> {
    let edge = centre - half - 0.5;
    let whole = edge as usize;
    let first = whole + usize::from(edge > whole as f32);
    let edge = centre + half - 0.5;
    let end = if edge >= 0.0 {
        (edge.min(size) as usize + 1).min(size as usize)
    } else {
        0
    };
    first..end.max(first)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kernel_is_the_gaussian_of_the_shader() {
        for step in 0..=1_000_u16 {
            let x = f32::from(step) / 1_000.0;
            let error = (kernel(x) - (-2.0 * x).exp()).abs();
            assert!(error < 2e-6, "{error} at {x}");
        }
    }

    #[test]
    fn rectangles_hold_the_pixels_whose_centres_lie_within() {
        assert_eq!(pixels_within(2.0, 1.5, 10.0), 0..4);
        assert!(pixels_within(2.0, 0.4, 10.0).is_empty());
        assert_eq!(pixels_within(9.0, 5.0, 10.0), 4..10);
        assert!(pixels_within(-9.0, 5.0, 10.0).is_empty());
        assert!(pixels_within(f32::NAN, 1.0, 10.0).is_empty());
        assert_eq!(pixels_within(5.0, f32::INFINITY, 10.0), 0..10);
    }
}
