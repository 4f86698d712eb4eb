//! Which surfels reach which band of rows.

use super::image::Rectangle;
use super::lanes::LANES;
use super::nearest::BAND_ROWS;
use super::surfels::{Numbers, Stage, Surfels};
use super::workers::share_out;
use core::ops::Range;
use pointstage_plugin_api::glam::Vec4;

/// Surfels that a thread sorts at a time.
const PART: u32 = 16_384;

/// Slices of the scene's depth: what is near is drawn first, so that most of what it hides is never computed.
const SLICES: usize = 16;
/// Beyond so many parts surfels are not sorted by depth: too many lists.
const MOST_PARTS: usize = 2_048;

/// Columns and rows of a large area.
const MOST_PIXELS: usize = 6;

/// The surfels of a selection by the bands of rows that their splats can reach, near ones first: so every band's pixels are drawn by
/// one thread, in the same order however many there are.
#[derive(Debug, Default)]
pub struct Bins {
    band_count: usize,
    slice_count: usize,
    parts: Vec<Part>,
}

/// Surfels of one draw that follow one another.
#[derive(Debug, Default)]
struct Part {
    draw: usize,
    range: Range<u32>,
    /// By slice and band.
    lists: Vec<Vec<Candidate>>,
}

/// A surfel that may be seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// The pixels that its splat can reach.
    pub area: Rectangle,
    /// No point of its splat is nearer than this depth; infinite if the area is large, where it does not pay to look whether all
    /// of it is hidden.
    pub depth: f32,
    /// Place in its block.
    pub number: u32,
}

/// How far splats reach beyond the surfels' own spheres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Factor on the half-axes.
    pub scale: f32,
    /// On the screen, px. Within it and the sphere depth is taken to change by no more than a radius' worth a reach.
    pub pad_px: f32,
}

impl Bins {
    /// Sorts the surfels of a stage, on so many threads.
    pub fn fill(&mut self, stage: &Stage<'_>, reach: Reach, thread_count: usize) {
        self.band_count = (stage.camera.size_px.y as u32).div_ceil(BAND_ROWS) as usize;
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
        let slice_count = if part_count > MOST_PARTS { 1 } else { SLICES };
        self.slice_count = slice_count;
        let sorter = Sorter {
            stage,
            reach,
            band_count: self.band_count,
            slice_count,
        };
        let mut states = vec![(); thread_count.clamp(1, part_count.max(1))];
        share_out(self.parts.iter_mut(), &mut states, |(), part| {
            let list_count = sorter.band_count * slice_count;
            part.lists.resize_with(list_count, Vec::new);
            part.lists.iter_mut().for_each(Vec::clear);
            if let Some(surfels) = stage.draws.get(part.draw) {
                sorter.fill(part, surfels);
            }
        });
    }

    /// The surfels of a band, with their draw's place in the stage.
    pub fn of_band(&self, band: usize) -> impl Iterator<Item = (usize, &[Candidate])> {
        let slices = 0..self.slice_count;
        slices.flat_map(move |slice| {
            self.parts.iter().filter_map(move |part| {
                let numbers = part.lists.get(slice * self.band_count + band)?;
                (!numbers.is_empty()).then_some((part.draw, numbers.as_slice()))
            })
        })
    }
}

/// How surfels are sorted.
struct Sorter<'a> {
    stage: &'a Stage<'a>,
    reach: Reach,
    band_count: usize,
    slice_count: usize,
}

impl Sorter<'_> {
    fn fill(&self, part: &mut Part, surfels: &Surfels<'_>) {
        let Range { start, end } = part.range;
        match &surfels.numbers {
            Numbers::Range { first, .. } => {
                let mut four = [0; LANES];
                for start in (start..end).step_by(LANES) {
                    let count = (end - start).min(LANES as u32) as usize;
                    for (number, next) in four.iter_mut().zip(first + start..) {
                        *number = next;
                    }
                    self.sort(part, surfels, &four[..count]);
                }
            }
            Numbers::List(list) => {
                let numbers = list.get(start as usize..end as usize).unwrap_or_default();
                for four in numbers.chunks(LANES) {
                    self.sort(part, surfels, four);
                }
            }
        }
    }

    #[inline]
    fn sort(&self, part: &mut Part, surfels: &Surfels<'_>, numbers: &[u32]) {
        let (stage, reach) = (self.stage, self.reach);
        let (centre_view, radius) = surfels.spheres(numbers);
        let radius = radius * reach.scale;
        let spheres = stage
            .camera
            .project_spheres(centre_view, radius, reach.pad_px);
        let areas = Rectangle::within_four(spheres.lower_px, spheres.upper_px);
        let depths = spheres.depth.to_array();
        let [nearest, farthest] = stage.distances;
        let scale = self.slice_count as f32 / (farthest - nearest).max(1e-30);
        let slices = ((-centre_view.z - Vec4::splat(nearest)) * scale).to_array();
        for (lane, number) in numbers.iter().enumerate().take(LANES) {
            let area = areas[lane];
            if area.is_empty() {
                continue;
            }
            let is_small = area.columns().len() <= MOST_PIXELS && area.rows().len() <= MOST_PIXELS;
            let candidate = Candidate {
                area,
                depth: if is_small {
                    depths[lane]
                } else {
                    f32::INFINITY
                },
                number: *number,
            };
            // What is no number or outside the range goes to the ends.
            let slice = (slices[lane] as usize).min(self.slice_count - 1);
            let rows = area.rows();
            let bands = rows.start / BAND_ROWS..rows.end.div_ceil(BAND_ROWS);
            let start = slice * self.band_count;
            let lists = start + bands.start as usize..start + bands.end as usize;
            for list in part.lists.get_mut(lists).unwrap_or_default() {
                list.push(candidate);
            }
        }
    }
}
