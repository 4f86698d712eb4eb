//! Chunks in lockstep: two at once on each thread, where there are enough of them.

use std::fmt;
use std::slice::ChunksExactMut;
use std::sync::{Mutex, MutexGuard, PoisonError};

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

/// Decompresses chunks, on all threads, of which so many have nothing else to do at first.
///
/// # Errors
/// [`Incomplete`]: one of them is damaged or cut off.
pub(crate) fn decompress(
    layout: Layout,
    chunks: Vec<Chunk<'_>>,
    threads: usize,
) -> Result<(), Incomplete> {
    if layout.is_layered {
        share::<LayeredLane<'_>>(layout, chunks, threads)
    } else {
        share::<ChunkedLane<'_>>(layout, chunks, threads)
    }
}

fn share<'a, L: Lane<'a> + Send>(
    layout: Layout,
    mut chunks: Vec<Chunk<'a>>,
    threads: usize,
) -> Result<(), Incomplete> {
    // The longest are begun first, so that all threads end at about the same time.
    chunks.sort_by_key(|chunk| std::cmp::Reverse(chunk.output.len()));
    let queue = Queue {
        layout,
        waiting: Mutex::new(Waiting {
            chunks: chunks.into_iter(),
            threads,
        }),
    };
    (0..rayon::current_num_threads())
        .into_par_iter()
        .try_for_each(|_| work::<L>(&queue))
}

/// What is still to be decompressed, and how.
struct Queue<'a> {
    layout: Layout,
    waiting: Mutex<Waiting<'a>>,
}

/// What has not begun yet.
struct Waiting<'a> {
    chunks: std::vec::IntoIter<Chunk<'a>>,
    threads: usize,
}

/// A chunk that was begun, and the records behind its first.
type Begun<'a, L> = (L, ChunksExactMut<'a, u8>);

impl<'a> Queue<'a> {
    /// The first chunk of a thread, and a second if that leaves one for each thread that has none yet: alone they take longer, but
    /// less than one after the other.
    fn first<L: Lane<'a>>(&self) -> Result<[Option<Begun<'a, L>>; 2], Incomplete> {
        let mut waiting = self.lock();
        waiting.threads = waiting.threads.saturating_sub(1);
        let chunk = waiting.chunks.next();
        let has_second = waiting.chunks.len() > waiting.threads;
        let second = has_second.then(|| waiting.chunks.next()).flatten();
        drop(waiting);
        Ok([self.begin(chunk)?, self.begin(second)?])
    }

    /// Begins the next chunk; `None` when there are no more.
    fn next<L: Lane<'a>>(&self) -> Result<Option<Begun<'a, L>>, Incomplete> {
        let chunk = self.lock().chunks.next();
        self.begin(chunk)
    }

    fn lock(&self) -> MutexGuard<'_, Waiting<'a>> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn begin<L: Lane<'a>>(
        &self,
        chunk: Option<Chunk<'a>>,
    ) -> Result<Option<Begun<'a, L>>, Incomplete> {
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
    loop {
        let [first, second] = queue.first::<L>()?;
        let Some(mut begun) = first else {
            return Ok(());
        };
        if let Some(second) = second {
            begun = pairs(queue, begun, second)?;
        }
        let (lane, records) = begun;
        let mut single = [lane];
        for record in records {
            L::next(&mut single, [record]);
        }
        let [lane] = &single;
        if !lane.is_whole() {
            return Err(Incomplete);
        }
    }
}

/// Two chunks at once, and the next in place of one that ends, until there is no next; what is left of the other.
fn pairs<'a, L: Lane<'a>>(
    queue: &Queue<'a>,
    (lane, mut records): Begun<'a, L>,
    (other, mut other_records): Begun<'a, L>,
) -> Result<Begun<'a, L>, Incomplete> {
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
                return Ok((other, other_records));
            }
            (None, _) => {
                let [lane, _] = lanes;
                return Ok((lane, records));
            }
        }
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
