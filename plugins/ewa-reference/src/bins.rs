//! Which primitives may reach which tile.

use pointstage_plugin_api::glam::DVec2;

use crate::parts::{Parts, Shape};

/// Primitives that one job sorts.
pub(crate) const CHUNK: u32 = 16_384;
/// What reaches more tiles than this is looked at for every tile: lists stay small whatever the radii.
const MOST_TILES: i64 = 256;

/// The tiles of a picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    /// Tiles across and down.
    pub(crate) counts: [u32; 2],
    /// Side of a tile, samples.
    pub(crate) side: f64,
    /// How far beyond its edges a tile looks, samples.
    pub(crate) margin: f64,
}

/// What one job found, by ordinal upwards.
#[derive(Debug, Default)]
pub(crate) struct Chunk {
    /// Tile, ordinal.
    in_tiles: Vec<(u32, u32)>,
    everywhere: Vec<u32>,
}

/// The lists of all tiles.
#[derive(Debug, Default)]
pub(crate) struct Bins {
    /// Where each tile's list starts, and at the end the number of all.
    starts: Vec<usize>,
    ordinals: Vec<u32>,
    everywhere: Vec<u32>,
}

impl Grid {
    pub(crate) fn tile_count(&self) -> u32 {
        self.counts[0] * self.counts[1]
    }

    /// First and last tile along an axis that sees something between two sample positions; none if none does.
    fn tiles(&self, lower: f64, upper: f64, axis: usize) -> Option<[i64; 2]> {
        let last = i64::from(self.counts[axis]) - 1;
        let first = ((lower - self.margin) / self.side).floor() as i64;
        let end = ((upper + self.margin) / self.side).floor() as i64;
        (first <= last && end >= 0).then(|| [first.max(0), end.min(last)])
    }

    /// Sorts the primitives of chunk `number`.
    pub(crate) fn sort(&self, parts: &Parts<'_>, number: u32) -> Chunk {
        let mut chunk = Chunk::default();
        let first = number * CHUNK;
        for ordinal in first..parts.count().min(first.saturating_add(CHUNK)) {
            let Some([lower, upper]) = parts.shape(ordinal).map(|shape| bounds(&shape)) else {
                continue;
            };
            let columns = self.tiles(lower.x, upper.x, 0);
            let rows = self.tiles(lower.y, upper.y, 1);
            let (Some([left, right]), Some([top, bottom])) = (columns, rows) else {
                continue;
            };
            if (right - left + 1) * (bottom - top + 1) > MOST_TILES {
                chunk.everywhere.push(ordinal);
                continue;
            }
            for row in top..=bottom {
                for column in left..=right {
                    let tile = row * i64::from(self.counts[0]) + column;
                    chunk.in_tiles.push((tile as u32, ordinal));
                }
            }
        }
        chunk
    }
}

fn bounds(shape: &Shape) -> [DVec2; 2] {
    match shape {
        Shape::Splat(footprint) => [footprint.lower, footprint.upper],
        Shape::Triangle(triangle) => [triangle.lower, triangle.upper],
    }
}

impl Bins {
    /// Joins all chunks, in order.
    pub(crate) fn new(tile_count: u32, chunks: &[Chunk]) -> Self {
        let mut starts = vec![0; tile_count as usize + 1];
        let all = || chunks.iter().flat_map(|chunk| &chunk.in_tiles);
        for (tile, _) in all() {
            starts[*tile as usize + 1] += 1;
        }
        for tile in 1..starts.len() {
            starts[tile] += starts[tile - 1];
        }
        let mut next = starts.clone();
        let mut ordinals = vec![0; starts[tile_count as usize]];
        for (tile, ordinal) in all() {
            ordinals[next[*tile as usize]] = *ordinal;
            next[*tile as usize] += 1;
        }
        let everywhere = chunks.iter().flat_map(|chunk| &chunk.everywhere).copied();
        Self {
            starts,
            ordinals,
            everywhere: everywhere.collect(),
        }
    }

    /// Ordinals of what may reach the tile, upwards.
    pub(crate) fn list(&self, tile: u32) -> Vec<u32> {
        let tile = tile as usize;
        let own = &self.ordinals[self.starts[tile]..self.starts[tile + 1]];
        let mut list = [own, &self.everywhere].concat();
        // Both halves are sorted.
        list.sort_unstable();
        list
    }
}
