//! Columns filled in parallel, block by block.

use std::ops::Range;
use std::sync::Arc;

use bytemuck::Zeroable;
use bytes::Bytes;
use pointstage_plugin_api::columns::MAX_BLOCK_SURFELS;

use super::memory::{filled_bytes, filled_slice};
use crate::job::{Cancelled, Job};

/// Surfels filled at once: small enough for 8 columns of f64 in the first-level cache, and a divisor of a block.
pub(super) const PIECE_SURFELS: usize = 512;

/// Surfels between two looks at the cancel flag, and done by one thread at a time.
pub(super) const TASK_SURFELS: usize = 32 * PIECE_SURFELS;

/// The blocks of a column.
pub(super) type Column<T> = Vec<Arc<[T]>>;

/// The blocks of a named column.
pub(super) type ByteColumn = Vec<Bytes>;

/// A column of `count` surfels with `width` values of `T` each, cut into blocks.
///
/// `convert` gets surfels (at most [`PIECE_SURFELS`]) and their slots, and returns what `merge` joins; `merge` must not mind
/// the order, so that the result does not depend on the number of threads.
pub(super) fn fill_blocks<T, S>(
    count: usize,
    width: usize,
    job: &Job,
    convert: impl Fn(Range<usize>, &mut [T]) -> S + Sync,
    merge: impl Fn(S, S) -> S + Sync,
) -> Result<(Column<T>, S), Cancelled>
where
    T: Zeroable + Send + Sync,
    S: Default + Send,
{
    let mut blocks = Vec::new();
    let mut summary = S::default();
    for start in (0..count).step_by(MAX_BLOCK_SURFELS) {
        let length = MAX_BLOCK_SURFELS.min(count - start);
        let task = |task, slots: &mut [T]| {
            let first = start + task * TASK_SURFELS;
            fill(slots, first, width, job, &convert, &merge)
        };
        let task_values = TASK_SURFELS * width;
        let (block, of_block) = filled_slice(length * width, task_values, task, &merge)?;
        summary = merge(summary, of_block);
        blocks.push(block);
    }
    Ok((blocks, summary))
}

/// The blocks of a column of `count` surfels with `width` bytes each; see [`fill_blocks`].
pub(super) fn fill_bytes<S>(
    count: usize,
    width: usize,
    job: &Job,
    convert: impl Fn(Range<usize>, &mut [u8]) -> S + Sync,
    merge: impl Fn(S, S) -> S + Sync,
) -> Result<(ByteColumn, S), Cancelled>
where
    S: Default + Send,
{
    let mut blocks = Vec::new();
    let mut summary = S::default();
    for start in (0..count).step_by(MAX_BLOCK_SURFELS) {
        let length = MAX_BLOCK_SURFELS.min(count - start);
        let task = |task, slots: &mut [u8]| {
            let first = start + task * TASK_SURFELS;
            fill(slots, first, width, job, &convert, &merge)
        };
        let task_values = TASK_SURFELS * width;
        let (block, of_block) = filled_bytes(length * width, task_values, task, &merge)?;
        summary = merge(summary, of_block);
        blocks.push(block);
    }
    Ok((blocks, summary))
}

/// Fills the slots of some surfels of which `first` is the first.
fn fill<T, S: Default>(
    slots: &mut [T],
    first: usize,
    width: usize,
    job: &Job,
    convert: &(impl Fn(Range<usize>, &mut [T]) -> S + Sync),
    merge: &(impl Fn(S, S) -> S + Sync),
) -> Result<S, Cancelled> {
    job.check()?;
    let pieces = slots.chunks_mut(PIECE_SURFELS * width).enumerate();
    let pieces = pieces.map(|(piece, slots)| {
        let start = first + piece * PIECE_SURFELS;
        convert(start..start + slots.len() / width, slots)
    });
    Ok(pieces.fold(S::default(), merge))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_surfel_is_filled_once() {
        let count = 3 * TASK_SURFELS + PIECE_SURFELS + 7;
        let write = |range: Range<usize>, slots: &mut [u32]| {
            for (surfel, pair) in range.clone().zip(slots.chunks_exact_mut(2)) {
                pair.copy_from_slice(&[surfel as u32, 1]);
            }
            range.len()
        };
        let (blocks, filled) = fill_blocks(count, 2, &Job::new(), write, |a, b| a + b).unwrap();
        assert_eq!(
            (blocks.len(), blocks[0].len(), filled),
            (1, 2 * count, count)
        );
        assert!(
            blocks[0]
                .chunks_exact(2)
                .enumerate()
                .all(|(surfel, pair)| pair == [surfel as u32, 1])
        );
    }

    #[test]
    fn a_cancelled_job_fills_nothing() {
        let job = Job::new();
        job.cancel();
        let result = fill_blocks(10, 1, &job, |_, _: &mut [u8]| (), |(), ()| ());
        assert_eq!(result.map(|_| ()), Err(Cancelled));
    }
}
