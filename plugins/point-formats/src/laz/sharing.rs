//! Chunks to threads, and what comes of them in order.
//!
//! Each thread takes chunks, two at a time, in the order of the file, as long as the points that nobody has fetched yet are not
//! too many; who finds none takes one of another thread's two, so that all end at about the same time.

use std::collections::{BTreeMap, VecDeque};
use std::io;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;

use super::chunked::ChunkedLane;
use super::lanes::{Chunk, Incomplete, Lane, Pair, Progress, RUN, Taker, one};
use super::layered::LayeredLane;
use super::layout::{Layout, Version};
use super::version1::FirstLane;

/// Why not all chunks were fetched.
#[derive(Debug)]
pub(crate) enum Ended<E> {
    /// A chunk is damaged or cut off.
    Damaged(Incomplete),
    /// The system gives no thread.
    NoThread(io::Error),
    /// Whoever fetched them wants no more.
    By(E),
}

/// How many threads decompress, and how far ahead.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    pub(crate) threads: usize,
    /// Points that are being decompressed or wait to be fetched.
    pub(crate) points: usize,
    /// Points of a chunk that is fetched as a whole.
    pub(crate) of_chunk: usize,
}

/// Decompresses chunks; `fetch` gets what `taker` made of each, in order, on this thread. What it gives back is used again.
///
/// # Errors
/// [`Ended`]; all chunks before the one at fault have been fetched.
pub(crate) fn decompress<T: Taker, E>(
    layout: Layout,
    chunks: Vec<Chunk<'_>>,
    limits: Limits,
    taker: &T,
    fetch: impl FnMut(T::Piece) -> Result<Option<T::Piece>, E>,
) -> Result<(), Ended<E>> {
    match layout.version {
        Version::First => share::<FirstLane<'_>, _, _>(layout, chunks, limits, taker, fetch),
        Version::Second => share::<ChunkedLane<'_>, _, _>(layout, chunks, limits, taker, fetch),
        Version::Third | Version::Fourth => {
            share::<LayeredLane<'_>, _, _>(layout, chunks, limits, taker, fetch)
        }
    }
}

fn share<'a, L: Lane<'a>, T: Taker, E>(
    layout: Layout,
    chunks: Vec<Chunk<'a>>,
    limits: Limits,
    taker: &T,
    mut fetch: impl FnMut(T::Piece) -> Result<Option<T::Piece>, E>,
) -> Result<(), Ended<E>> {
    if chunks.iter().any(|chunk| chunk.count > limits.of_chunk) {
        return in_parts::<L, T, E>(layout, &chunks, limits.of_chunk, taker, fetch);
    }
    let counts: Vec<usize> = chunks.iter().map(|chunk| chunk.count).collect();
    let sharing = Sharing::<L, T::Piece> {
        most_ahead: limits.points,
        state: Mutex::new(State {
            waiting: chunks.into_iter().enumerate().collect(),
            left_over: Vec::new(),
            done: BTreeMap::new(),
            free: Vec::new(),
            ahead: 0,
            lanes: 0,
            idle: 0,
            is_stopped: false,
        }),
        changed: Condvar::new(),
    };
    thread::scope(|scope| {
        // However this ends, the threads do.
        let _stop = Stop {
            sharing: &sharing,
            only_by_panic: false,
        };
        for thread in 0..limits.threads.clamp(1, counts.len().max(1)) {
            let work = || sharing.work(layout, taker);
            match thread::Builder::new().spawn_scoped(scope, work) {
                Err(error) if thread == 0 => return Err(Ended::NoThread(error)),
                // Those that there are do all of it.
                Err(_) => break,
                Ok(_) => {}
            }
        }
        for (number, count) in counts.into_iter().enumerate() {
            let piece = sharing.wait_for(number).map_err(Ended::Damaged)?;
            let piece = fetch(piece).map_err(Ended::By)?;
            sharing.fetched(count, piece);
        }
        Ok(())
    })
}

/// Decompresses chunks on this thread, each in parts of at most so many records, as one of them has more than are kept in memory.
fn in_parts<'a, L: Lane<'a>, T: Taker, E>(
    layout: Layout,
    chunks: &[Chunk<'a>],
    of_part: usize,
    taker: &T,
    mut fetch: impl FnMut(T::Piece) -> Result<Option<T::Piece>, E>,
) -> Result<(), Ended<E>> {
    let stride = layout.stride();
    let mut records = vec![0; RUN * stride];
    let mut piece = T::Piece::default();
    for chunk in chunks {
        let first = &mut records[..stride];
        let lane = L::begin(layout, chunk.input, first).map_err(Ended::Damaged)?;
        let mut lane = [lane];
        // Of the chunk; the first is there already.
        let mut ready = 1;
        for part in (0..chunk.count).step_by(of_part.max(1)) {
            let count = of_part.max(1).min(chunk.count - part);
            taker.begin(&mut piece, count);
            let mut taken = 0;
            while taken < count {
                let run = RUN.min(count - taken);
                let records = &mut records[..run * stride];
                one(&mut lane, &mut records[ready * stride..], stride);
                ready = 0;
                taker.add(&mut piece, taken, records);
                taken += run;
                let [of_chunk] = &lane;
                if !of_chunk.is_whole() {
                    return Err(Ended::Damaged(Incomplete));
                }
            }
            let given_back = fetch(std::mem::take(&mut piece)).map_err(Ended::By)?;
            piece = given_back.unwrap_or_default();
        }
    }
    Ok(())
}

/// What the threads share.
struct Sharing<'a, L, P> {
    most_ahead: usize,
    state: Mutex<State<'a, L, P>>,
    changed: Condvar,
}

struct State<'a, L, P> {
    /// Those that nobody has begun.
    waiting: VecDeque<(usize, Chunk<'a>)>,
    /// Those that a thread has begun and left to others.
    left_over: Vec<(L, Progress<P>)>,
    /// Those that have ended, by number.
    done: BTreeMap<usize, Result<P, Incomplete>>,
    /// Pieces to be used again.
    free: Vec<P>,
    /// Points of chunks that have begun and were not fetched.
    ahead: usize,
    /// Chunks that have begun and not ended.
    lanes: usize,
    /// Threads that have nothing to do.
    idle: usize,
    is_stopped: bool,
}

impl<'a, L, P: Default> State<'a, L, P> {
    /// The next chunk, if there is one and it may begin.
    fn begin(&mut self, most_ahead: usize) -> Option<(usize, Chunk<'a>, P)> {
        let may_begin = |(_, next): &mut (usize, Chunk<'_>)| {
            self.ahead == 0 || self.ahead + next.count <= most_ahead
        };
        let (number, chunk) = self.waiting.pop_front_if(may_begin)?;
        self.ahead += chunk.count;
        self.lanes += 1;
        Some((number, chunk, self.free.pop().unwrap_or_default()))
    }
}

impl<'a, L: Lane<'a>, P: Default + Send> Sharing<'a, L, P> {
    fn lock(&self) -> MutexGuard<'_, State<'a, L, P>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'s>(&self, state: MutexGuard<'s, State<'a, L, P>>) -> MutexGuard<'s, State<'a, L, P>> {
        let state = self.changed.wait(state);
        state.unwrap_or_else(PoisonError::into_inner)
    }

    /// What one thread does.
    fn work<T: Taker<Piece = P>>(&self, layout: Layout, taker: &T) {
        let _stop = Stop {
            sharing: self,
            only_by_panic: true,
        };
        let mut pair = Pair::new(layout, taker);
        while self.supply(&mut pair) {
            pair.run(|progress, is_whole| {
                let piece = if is_whole {
                    Ok(progress.piece)
                } else {
                    Err(Incomplete)
                };
                self.end(progress.chunk, piece);
            });
        }
    }

    /// Gives a thread what it lacks, or takes from it what another lacks; `false` when nothing is left to do.
    fn supply<T: Taker<Piece = P>>(&self, pair: &mut Pair<'_, L, T>) -> bool {
        let mut state = self.lock();
        loop {
            if state.is_stopped {
                return false;
            }
            if pair.len() == 2 {
                if state.idle > state.left_over.len() {
                    state.left_over.extend(pair.pop());
                    self.changed.notify_all();
                }
                return true;
            }
            if pair.len() == 0
                && let Some(begun) = state.left_over.pop()
            {
                pair.push(begun);
            } else if let Some((number, chunk, piece)) = state.begin(self.most_ahead) {
                drop(state);
                if pair.begin(number, chunk, piece).is_err() {
                    self.end(number, Err(Incomplete));
                }
                state = self.lock();
            } else if pair.len() > 0 {
                return true;
            } else if state.lanes == 0 && state.waiting.is_empty() {
                return false;
            } else {
                state.idle += 1;
                state = self.wait(state);
                state.idle -= 1;
            }
        }
    }

    /// Notes what came of a chunk.
    fn end(&self, number: usize, piece: Result<P, Incomplete>) {
        let mut state = self.lock();
        state.lanes -= 1;
        state.done.insert(number, piece);
        self.changed.notify_all();
    }

    /// What came of a chunk, when it has ended.
    fn wait_for(&self, number: usize) -> Result<P, Incomplete> {
        let mut state = self.lock();
        loop {
            if let Some(piece) = state.done.remove(&number) {
                return piece;
            }
            if state.is_stopped {
                // A thread panicked, and so will this one when it has waited for all.
                return Err(Incomplete);
            }
            state = self.wait(state);
        }
    }

    /// Makes room for further chunks.
    fn fetched(&self, count: usize, piece: Option<P>) {
        let mut state = self.lock();
        state.ahead -= count;
        state.free.extend(piece);
        self.changed.notify_all();
    }
}

/// Ends all threads when it is dropped.
struct Stop<'s, 'a, L: Lane<'a>, P: Default + Send> {
    sharing: &'s Sharing<'a, L, P>,
    /// Only if that is because of a panic: those who wait would wait for ever.
    only_by_panic: bool,
}

impl<'a, L: Lane<'a>, P: Default + Send> Drop for Stop<'_, 'a, L, P> {
    fn drop(&mut self) {
        if thread::panicking() || !self.only_by_panic {
            self.sharing.lock().is_stopped = true;
            self.sharing.changed.notify_all();
        }
    }
}
