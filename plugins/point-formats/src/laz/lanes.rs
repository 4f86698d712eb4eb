//! Chunks in lockstep: two at once on each thread.

use std::fmt;
use std::slice::ChunksExactMut;
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::chunked::ChunkedLane;
use super::layered::LayeredLane;
use super::layout::Layout;

/// A chunk that ends before its records do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Incomplete;

impl fmt::Display for Incomplete {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("a chunk ends before its points do")
    }
}

/// A compressed chunk and where its records go.
pub(crate) struct Chunk<'a> {
    pub(crate) input: &'a [u8],
    /// A whole number of records, at least one.
    pub(crate) output: &'a mut [u8],
}

/// A chunk that is being decompressed.
pub(super) trait Lane<'a>: Sized {
    /// Begins a chunk and writes its first record.
    fn begin(layout: Layout, input: &'a [u8], first: &mut [u8]) -> Result<Self, Incomplete>;

    /// Writes the next record of each lane.
    fn next<const LANES: usize>(lanes: &mut [Self; LANES], records: [&mut [u8]; LANES]);

    /// Whether nothing was read from behind the chunk's end.
    fn is_whole(&self) -> bool;
}

/// Decompresses chunks, on all threads.
///
/// # Errors
/// [`Incomplete`]: one of them is damaged or cut off.
pub(crate) fn decompress(layout: Layout, chunks: Vec<Chunk<'_>>) -> Result<(), Incomplete> {
    if layout.is_layered {
        share::<LayeredLane<'_>>(layout, chunks)
    } else {
        share::<ChunkedLane<'_>>(layout, chunks)
    }
}

fn share<'a, L: Lane<'a> + Send>(
    layout: Layout,
    mut chunks: Vec<Chunk<'a>>,
) -> Result<(), Incomplete> {
    // The longest are begun first, so that all threads end at about the same time.
    chunks.sort_by_key(|chunk| std::cmp::Reverse(chunk.output.len()));
    let queue = Queue {
        layout,
        chunks: Mutex::new(chunks.into_iter()),
    };
    (0..rayon::current_num_threads())
        .into_par_iter()
        .try_for_each(|_| work::<L>(&queue))
}

/// Chunks that no thread has begun yet.
struct Queue<'a> {
    layout: Layout,
    chunks: Mutex<std::vec::IntoIter<Chunk<'a>>>,
}

impl<'a> Queue<'a> {
    /// Begins the next chunk; `None` when there are no more.
    fn next<L: Lane<'a>>(&self) -> Result<Option<(L, ChunksExactMut<'a, u8>)>, Incomplete> {
        let chunk = self
            .chunks
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .next();
        let Some(chunk) = chunk else {
            return Ok(None);
        };
        let mut records = chunk.output.chunks_exact_mut(self.layout.stride());
        let first = records.next().ok_or(Incomplete)?;
        let lane = L::begin(self.layout, chunk.input, first)?;
        Ok(Some((lane, records)))
    }
}

/// What one thread does: two chunks at once as long as there are.
fn work<'a, L: Lane<'a>>(queue: &Queue<'a>) -> Result<(), Incomplete> {
    let Some((lane, mut records)) = queue.next::<L>()? else {
        return Ok(());
    };
    let mut single = [lane];
    if let Some((other, mut other_records)) = queue.next::<L>()? {
        let [lane] = single;
        let mut lanes = [lane, other];
        loop {
            both(&mut lanes, &mut records, &mut other_records);
            let ended = usize::from(records.len() > 0);
            if !lanes[ended].is_whole() {
                return Err(Incomplete);
            }
            let next = queue.next::<L>()?;
            let [lane, other] = &mut lanes;
            match (next, ended) {
                (Some((next, next_records)), 0) => (*lane, records) = (next, next_records),
                (Some((next, next_records)), _) => (*other, other_records) = (next, next_records),
                (None, 0) => {
                    let [_, other] = lanes;
                    (single, records) = ([other], other_records);
                    break;
                }
                (None, _) => {
                    let [lane, _] = lanes;
                    single = [lane];
                    break;
                }
            }
        }
    }
    for record in records {
        L::next(&mut single, [record]);
    }
    let [lane] = &single;
    if lane.is_whole() {
        Ok(())
    } else {
        Err(Incomplete)
    }
}

/// Goes on with two chunks until one of them ends.
#[inline(never)]
fn both<'a, L: Lane<'a>>(
    lanes: &mut [L; 2],
    first: &mut ChunksExactMut<'a, u8>,
    second: &mut ChunksExactMut<'a, u8>,
) {
    let count = first.len().min(second.len());
    for (first, second) in first.take(count).zip(second.take(count)) {
        L::next(lanes, [first, second]);
    }
}
