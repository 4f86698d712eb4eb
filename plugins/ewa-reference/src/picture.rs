//! The picture while it is being drawn: tile by tile, first with one sample a pixel, then with all.

use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::time::{Duration, Instant};

use pointstage_plugin_api::glam::{DVec2, DVec4};
use pointstage_plugin_api::targets::{self, NO_LEVEL};
use pointstage_plugin_api::{
    Frame, FrameChanges, FrameUniform, Interaction, Outcome, Purpose, Result,
};

use crate::bins::{Bins, CHUNK, Chunk, Grid};
use crate::parts::Parts;
use crate::samples::{average, margin};
use crate::settings::Wanted;
use crate::tile::{COVERAGE_REACH, Region, Renderer, Shaded};
use crate::work;

/// Side of a tile, px.
const TILE_PX: u32 = 16;
/// How long one call draws before it shows what there is.
const SLICE: Duration = Duration::from_millis(100);
/// The same where nobody watches.
const LONG_SLICE: Duration = Duration::from_millis(500);

/// All that the picture depends on, as one number: if it changes, drawing starts anew.
fn key_of(frame: &Frame<'_>, wanted: &Wanted) -> u64 {
    let mut hasher = DefaultHasher::new();
    let uniform = FrameUniform {
        frame_index: 0,
        sample_index: 0,
        seed: 0,
        interaction: 0,
        ..*frame.uniform()
    };
    bytemuck::bytes_of(&uniform).hash(&mut hasher);
    frame.size_px().hash(&mut hasher);
    frame.scene().revision().hash(&mut hasher);
    format!("{wanted:?}").hash(&mut hasher);
    for draw in frame.selection() {
        bytemuck::bytes_of(draw.uniform()).hash(&mut hasher);
        draw.block().position_radius().as_ptr().hash(&mut hasher);
        if draw
            .flags()
            .contains(pointstage_plugin_api::DrawFlags::INDEXED)
        {
            draw.surfels().for_each(|number| number.hash(&mut hasher));
        }
    }
    hasher.finish()
}

/// What is left to do with one number of samples a pixel.
struct Level {
    /// Along each side of a pixel.
    samples: u32,
    chunks: Vec<Option<Chunk>>,
    bins: Option<Bins>,
    /// Tiles that are not drawn yet, the next one last.
    tiles: Vec<u32>,
}

/// The picture of one viewport.
#[derive(Default)]
pub(crate) struct Picture {
    key: Option<u64>,
    size_px: [u32; 2],
    /// The present one last.
    levels: Vec<Level>,
    /// Samples that were drawn, and that there are.
    done: f64,
    total: f64,
    colour: Vec<[f32; 4]>,
    depth: Vec<f32>,
    normal: Vec<[f32; 4]>,
    id: Vec<u32>,
    kind: Vec<u32>,
    lod: Vec<u32>,
    weight: Vec<f32>,
}

impl Picture {
    /// Draws for a while, and fills the frame's planes with what there is.
    pub(crate) fn render(&mut self, frame: &mut Frame<'_>, wanted: &Wanted) -> Result<Outcome> {
        let key = key_of(frame, wanted);
        let changes = frame.changes();
        let is_other = changes.contains(FrameChanges::SCENE)
            || changes.contains(FrameChanges::SELECTION)
            || self.key != Some(key);
        if is_other {
            self.start(frame, wanted);
            self.key = Some(key);
        }
        let start = Instant::now();
        let slice = match frame.purpose() {
            Purpose::INTERACTIVE => SLICE,
            _ => LONG_SLICE,
        };
        let until = start + slice;
        let is_still = frame.interaction() == Interaction::STILL;
        let mut splats = 0;
        while Instant::now() < until && !frame.should_stop() {
            let Some(level) = self.levels.last() else {
                break;
            };
            // While something moves the first picture is all that there is time for.
            if level.samples > 1 && !is_still {
                break;
            }
            splats = self.step(frame, wanted, until)?;
        }
        self.fill(frame);
        frame.report("samples", f64::from(wanted.samples.pow(2)));
        if splats > 0 {
            frame.report("primitives", f64::from(splats));
        }
        Ok(if self.levels.is_empty() {
            Outcome::Done
        } else {
            Outcome::Refining((self.done / self.total.max(1.0)) as f32)
        })
    }

    fn start(&mut self, frame: &Frame<'_>, wanted: &Wanted) {
        self.size_px = frame.size_px();
        let count = self.size_px[0] as usize * self.size_px[1] as usize;
        self.colour = vec![[0.0; 4]; count];
        self.depth = vec![0.0; count];
        self.normal = vec![[0.0; 4]; count];
        self.id = vec![0; count];
        self.kind = vec![0; count];
        self.lod = vec![NO_LEVEL; count];
        self.weight = vec![0.0; count];
        self.levels.clear();
        let pixels = f64::from(self.size_px[0]) * f64::from(self.size_px[1]);
        (self.done, self.total) = (0.0, 0.0);
        let tiles = from_the_middle(tile_counts(self.size_px));
        let numbers = [Some(wanted.samples).filter(|samples| *samples > 1), Some(1)];
        for samples in numbers.into_iter().flatten() {
            self.total += pixels * f64::from(samples).powi(2);
            self.levels.push(Level {
                samples,
                chunks: Vec::new(),
                bins: None,
                tiles: tiles.clone(),
            });
        }
    }

    /// Goes on with the present level until the time is over; returns how many primitives there are.
    fn step(&mut self, frame: &Frame<'_>, wanted: &Wanted, until: Instant) -> Result<u32> {
        let Some(mut level) = self.levels.pop() else {
            return Ok(0);
        };
        let parts = Parts::new(frame, wanted, level.samples)?;
        let margin = margin(wanted.sample_filter, level.samples);
        let grid = Grid {
            counts: tile_counts(self.size_px),
            side: f64::from(TILE_PX * level.samples),
            margin: f64::from(margin + COVERAGE_REACH),
        };
        if level.bins.is_none() {
            level.sort(frame, &parts, &grid, until)?;
        }
        if let Some(bins) = &level.bins {
            let renderer = Renderer {
                parts: &parts,
                uniform: frame.uniform(),
                view_from_clip: parts.camera.clip_from_view.inverse(),
                shows: wanted.shows,
                lights_splats: wanted.lights_splats,
            };
            let tiles = level.tiles.clone();
            let count = tiles.len();
            let tile_of = |job: usize| tiles[count - 1 - job];
            let size_px = self.size_px;
            let mut drawn = Vec::new();
            work::run(
                frame,
                count,
                until,
                |job, stop| {
                    let tile = tile_of(job);
                    let region = region_of(tile, size_px).scaled(level.samples);
                    let shaded = renderer.render(region.grown(margin), &bins.list(tile), stop)?;
                    Some(if level.samples == 1 {
                        Drawn::First(shaded)
                    } else {
                        Drawn::Colours(average(
                            wanted.sample_filter,
                            level.samples,
                            region,
                            &shaded,
                        ))
                    })
                },
                |job, found| {
                    let tile = tile_of(job);
                    self.take(region_of(tile, size_px), &found);
                    self.done +=
                        f64::from(level.samples).powi(2) * region_of(tile, size_px).pixel_count();
                    drawn.push(tile);
                },
            )?;
            level.tiles.retain(|tile| !drawn.contains(tile));
        }
        let count = parts.count();
        if level.bins.is_none() || !level.tiles.is_empty() {
            self.levels.push(level);
        }
        Ok(count)
    }

    fn take(&mut self, region: Region, drawn: &Drawn) {
        let width = self.size_px[0] as usize;
        let row_of = |row: usize| {
            (region.y as usize + row) * width + region.x as usize
                ..(region.y as usize + row) * width + (region.x + region.width) as usize
        };
        for row in 0..region.height as usize {
            let start = row * region.width as usize;
            for (place, index) in (start..).zip(row_of(row)) {
                match drawn {
                    Drawn::Colours(colours) => {
                        self.colour[index] = colours[place].as_vec4().to_array();
                    }
                    Drawn::First(samples) => self.put(index, &samples[place]),
                }
            }
        }
    }

    fn put(&mut self, index: usize, sample: &Shaded) {
        let is_there = sample.depth > 0.0;
        self.colour[index] = sample.colour.as_vec4().to_array();
        self.depth[index] = sample.depth as f32;
        self.normal[index] = sample
            .normal
            .as_vec3()
            .extend(f32::from(u8::from(is_there)))
            .to_array();
        self.id[index] = sample.id;
        self.kind[index] = sample.kind;
        self.lod[index] = sample.level.unwrap_or(NO_LEVEL);
        self.weight[index] = sample.weight as f32;
    }

    fn fill(&self, frame: &mut Frame<'_>) {
        let width = (self.size_px[0] as usize).max(1);
        copy(frame, targets::COLOUR, &self.colour, width);
        copy(frame, targets::DEPTH, &self.depth, width);
        copy(frame, targets::NORMAL, &self.normal, width);
        copy(frame, targets::ID, &self.id, width);
        copy(frame, targets::KIND, &self.kind, width);
        copy(frame, targets::LOD, &self.lod, width);
        copy(frame, targets::WEIGHT, &self.weight, width);
    }
}

/// What a tile gives.
enum Drawn {
    /// Everything, with one sample a pixel.
    First(Vec<Shaded>),
    /// Means of many.
    Colours(Vec<DVec4>),
}

impl Level {
    /// Sorts primitives into tiles; what was begun is gone on with.
    fn sort(
        &mut self,
        frame: &Frame<'_>,
        parts: &Parts<'_>,
        grid: &Grid,
        until: Instant,
    ) -> Result<()> {
        let count = parts.count().div_ceil(CHUNK) as usize;
        self.chunks.resize_with(count, || None);
        let open: Vec<usize> = (0..count)
            .filter(|number| self.chunks[*number].is_none())
            .collect();
        let chunks = &mut self.chunks;
        work::run(
            frame,
            open.len(),
            until,
            |job, _| Some(grid.sort(parts, open[job] as u32)),
            |job, chunk| chunks[open[job]] = Some(chunk),
        )?;
        if self.chunks.iter().all(Option::is_some) {
            let chunks: Vec<Chunk> = self.chunks.drain(..).flatten().collect();
            self.bins = Some(Bins::new(grid.tile_count(), &chunks));
        }
        Ok(())
    }
}

impl Region {
    /// The same in samples.
    fn scaled(self, samples: u32) -> Self {
        let samples = samples as i32;
        Self {
            x: self.x * samples,
            y: self.y * samples,
            width: self.width * samples,
            height: self.height * samples,
        }
    }

    fn pixel_count(self) -> f64 {
        f64::from(self.width) * f64::from(self.height)
    }
}

fn tile_counts(size_px: [u32; 2]) -> [u32; 2] {
    size_px.map(|length| length.div_ceil(TILE_PX))
}

/// The tile's pixels.
fn region_of(tile: u32, size_px: [u32; 2]) -> Region {
    let [columns, _] = tile_counts(size_px);
    let [x, y] = [tile % columns * TILE_PX, tile / columns * TILE_PX];
    Region {
        x: x as i32,
        y: y as i32,
        width: TILE_PX.min(size_px[0] - x) as i32,
        height: TILE_PX.min(size_px[1] - y) as i32,
    }
}

/// All tiles, the one in the middle last.
fn from_the_middle(counts: [u32; 2]) -> Vec<u32> {
    let middle = DVec2::from(counts.map(f64::from)) / 2.0;
    let distance = |tile: &u32| {
        let place = DVec2::new(f64::from(tile % counts[0]), f64::from(tile / counts[0]));
        (place + 0.5).distance_squared(middle)
    };
    let mut tiles: Vec<u32> = (0..counts[0] * counts[1]).collect();
    tiles.sort_by(|a, b| distance(b).total_cmp(&distance(a)));
    tiles
}

/// Fills the plane of this key, if it was asked for.
fn copy<T: bytemuck::Pod>(frame: &mut Frame<'_>, key: &str, values: &[T], width: usize) {
    let Some(mut plane) = frame.take_plane(key) else {
        return;
    };
    for (row, values) in plane.rows::<T>().zip(values.chunks_exact(width)) {
        let length = row.len().min(width);
        row[..length].copy_from_slice(&values[..length]);
    }
}
