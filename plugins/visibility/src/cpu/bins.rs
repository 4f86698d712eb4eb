//! Which surfels reach which band of rows.

use super::lanes::LANES;
use super::nearest::BAND_ROWS;
use super::surfels::{Numbers, Stage, Surfels};
use super::workers::share_out;
use core::ops::Range;

/// Surfels that a thread sorts at a time.
const PART: u32 = 16_384;

/// The surfels of a selection by the bands of rows that their splats can reach, in the order of the draws: so every band's
/// pixels are drawn by one thread, in the same order however many there are.
#[derive(Debug, Default)]
pub struct Bins {
    parts: Vec<Part>,
}

/// Surfels of one draw that follow one another.
#[derive(Debug, Default)]
struct Part {
    draw: usize,
    range: Range<u32>,
    /// Numbers in the block, by band.
    bands: Vec<Vec<u32>>,
}

/// How far splats reach beyond the surfels' own spheres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Factor on the half-axes.
    pub scale: f32,
    /// On the screen, px.
    pub pad_px: f32,
}

impl Bins {
    /// Sorts the surfels of a stage, on so many threads.
    pub fn fill(&mut self, stage: &Stage<'_>, reach: Reach, thread_count: usize) {
        let band_count = (stage.camera.size_px.y as u32).div_ceil(BAND_ROWS) as usize;
        let mut part_count = 0;
        for (draw, surfels) in stage.draws.iter().enumerate() {
            let count = surfels.len() as u32;
            for first in (0..count).step_by(PART as usize) {
                if part_count == self.parts.len() {
                    self.parts.push(Part::default());
                }
                let part = &mut self.parts[part_count];
                part.draw = draw;
                part.range = first..count.min(first.saturating_add(PART));
                part_count += 1;
            }
        }
        self.parts.truncate(part_count);
        let mut states = vec![(); thread_count.clamp(1, part_count.max(1))];
        share_out(self.parts.iter_mut(), &mut states, |(), part| {
            part.bands.resize_with(band_count, Vec::new);
            part.bands.iter_mut().for_each(Vec::clear);
            if let Some(surfels) = stage.draws.get(part.draw) {
                part.fill(stage, surfels, reach);
            }
        });
    }

    /// The surfels of a band: their draw's place in the stage, and numbers in its block.
    pub fn of_band(&self, band: usize) -> impl Iterator<Item = (usize, &[u32])> {
        self.parts.iter().filter_map(move |part| {
            let numbers = part.bands.get(band)?;
            Some((part.draw, numbers.as_slice()))
        })
    }
}

impl Part {
    fn fill(&mut self, stage: &Stage<'_>, surfels: &Surfels<'_>, reach: Reach) {
        let Range { start, end } = self.range;
        match &surfels.numbers {
            Numbers::Range { first, .. } => {
                let mut four = [0; LANES];
                for start in (start..end).step_by(LANES) {
                    let count = (end - start).min(LANES as u32) as usize;
                    for (number, next) in four.iter_mut().zip(first + start..) {
                        *number = next;
                    }
                    self.sort(stage, surfels, reach, &four[..count]);
                }
            }
            Numbers::List(list) => {
                let numbers = list.get(start as usize..end as usize).unwrap_or_default();
                for four in numbers.chunks(LANES) {
                    self.sort(stage, surfels, reach, four);
                }
            }
        }
    }

    #[inline]
    fn sort(&mut self, stage: &Stage<'_>, surfels: &Surfels<'_>, reach: Reach, numbers: &[u32]) {
        let (centre_view, radius) = surfels.spheres(numbers);
        let [first, end] =
            stage
                .camera
                .rows_of_spheres(centre_view, radius * reach.scale, reach.pad_px);
        for (lane, number) in numbers.iter().enumerate().take(LANES) {
            let [first, end] = [first[lane], end[lane]].map(u32::from);
            if first >= end {
                continue;
            }
            let bands = first / BAND_ROWS..end.div_ceil(BAND_ROWS);
            let bands = self.bands.get_mut(bands.start as usize..bands.end as usize);
            for band in bands.unwrap_or_default() {
                band.push(*number);
            }
        }
    }
}
