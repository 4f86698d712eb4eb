//! What a thread does with the chunks that it decompresses: two in lockstep, a run of points at a time.

use std::fmt;

use super::layout::Layout;

/// A chunk that ends before its records do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Incomplete;

impl fmt::Display for Incomplete {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("a chunk ends before its points do")
    }
}

/// A compressed chunk.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chunk<'a> {
    pub(crate) input: &'a [u8],
    /// Records in it, at least one.
    pub(crate) count: usize,
}

/// A chunk that is being decompressed.
pub(super) trait Lane<'a>: Sized + Send {
    /// Begins a chunk and writes its first record.
    fn begin(layout: Layout, input: &'a [u8], first: &mut [u8]) -> Result<Self, Incomplete>;

    /// Writes the next record of each lane.
    fn next<const LANES: usize>(lanes: &mut [Self; LANES], records: [&mut [u8]; LANES]);

    /// Whether nothing was read from behind the chunk's end.
    fn is_whole(&self) -> bool;
}

/// What takes the records of a chunk as they come out.
pub(crate) trait Taker: Sync {
    /// All of a chunk, in the form that is wanted.
    type Piece: Default + Send;

    /// Makes room for so many records, in place of what the piece held.
    fn begin(&self, piece: &mut Self::Piece, count: usize);

    /// Puts records into the piece, behind the `first` ones that it has.
    fn add(&self, piece: &mut Self::Piece, first: usize, records: &[u8]);
}

/// Records of a lane that come out before they are taken: with those of the other they stay in the second-level cache.
pub(super) const RUN: usize = 1024;

/// A lane's chunk, and how far it is.
pub(super) struct Progress<P> {
    /// Number of the chunk in its file.
    pub(super) chunk: usize,
    pub(super) piece: P,
    taken: usize,
    count: usize,
}

/// The lanes of one thread, two at most.
pub(super) struct Pair<'t, L, T: Taker> {
    taker: &'t T,
    layout: Layout,
    stride: usize,
    // Side by side, as `Lane::next` wants them.
    lanes: Vec<L>,
    progress: Vec<Progress<T::Piece>>,
    records: [Vec<u8>; 2],
}

impl<'t, 'a, L: Lane<'a>, T: Taker> Pair<'t, L, T> {
    pub(super) fn new(layout: Layout, taker: &'t T) -> Self {
        let stride = layout.stride();
        let records = || vec![0; RUN * stride];
        Self {
            taker,
            layout,
            stride,
            lanes: Vec::with_capacity(2),
            progress: Vec::with_capacity(2),
            records: [records(), records()],
        }
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.lanes.len()
    }

    /// Begins a chunk in a lane of its own; `piece` is one that may be overwritten.
    ///
    /// # Errors
    /// The chunk has no first record.
    pub(super) fn begin(
        &mut self,
        number: usize,
        chunk: Chunk<'a>,
        mut piece: T::Piece,
    ) -> Result<(), Incomplete> {
        let [records, _] = &mut self.records;
        let first = &mut records[..self.stride];
        let lane = L::begin(self.layout, chunk.input, first)?;
        self.taker.begin(&mut piece, chunk.count);
        self.taker.add(&mut piece, 0, first);
        self.push((
            lane,
            Progress {
                chunk: number,
                piece,
                taken: 1,
                count: chunk.count,
            },
        ));
        Ok(())
    }

    /// Goes on with what another thread has begun.
    pub(super) fn push(&mut self, (lane, progress): (L, Progress<T::Piece>)) {
        self.lanes.push(lane);
        self.progress.push(progress);
    }

    /// Leaves one to another thread.
    pub(super) fn pop(&mut self) -> Option<(L, Progress<T::Piece>)> {
        self.lanes.pop().zip(self.progress.pop())
    }

    /// Goes on by a run of records, and calls `end` with each chunk that ends with it, and whether all of it was there; one that is
    /// cut off ends at once, since damaged data claims many points.
    pub(super) fn run(&mut self, mut end: impl FnMut(Progress<T::Piece>, bool)) {
        let stride = self.stride;
        let left = self.progress.iter().map(|lane| lane.count - lane.taken);
        let count = left.min().unwrap_or_default().min(RUN);
        let [first, second] = &mut self.records;
        let (first, second) = (&mut first[..count * stride], &mut second[..count * stride]);
        match &mut self.lanes[..] {
            [] => {}
            [lane] => one(std::array::from_mut(lane), first, stride),
            lanes => {
                if let Ok(lanes) = lanes.try_into() {
                    both(lanes, first, second, stride);
                }
            }
        }
        for (lane, records) in self.progress.iter_mut().zip([first, second]) {
            self.taker.add(&mut lane.piece, lane.taken, records);
            lane.taken += count;
        }
        for index in (0..self.lanes.len()).rev() {
            let is_whole = self.lanes[index].is_whole();
            if !is_whole || self.progress[index].taken == self.progress[index].count {
                self.lanes.swap_remove(index);
                end(self.progress.swap_remove(index), is_whole);
            }
        }
    }
}

#[inline(never)]
pub(super) fn one<'a, L: Lane<'a>>(lane: &mut [L; 1], records: &mut [u8], stride: usize) {
    for record in records.chunks_exact_mut(stride) {
        L::next(lane, [record]);
    }
}

#[inline(never)]
fn both<'a, L: Lane<'a>>(lanes: &mut [L; 2], first: &mut [u8], second: &mut [u8], stride: usize) {
    let records = first.chunks_exact_mut(stride);
    for (first, second) in records.zip(second.chunks_exact_mut(stride)) {
        L::next(lanes, [first, second]);
    }
}
