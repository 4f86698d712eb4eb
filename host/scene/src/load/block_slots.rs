//! A column whose values are written where they stay, in the memory of an object's blocks, while they still come.

use std::mem::MaybeUninit;
use std::sync::Arc;

use bytemuck::Pod;
use pointstage_plugin_api::columns::MAX_BLOCK_SURFELS;
use rayon::prelude::*;

use super::fill::{Column, PIECE_SURFELS};
use super::memory::{MANY_BYTES, uninit_slice};

/// The blocks of a column in the making.
#[derive(Debug)]
pub(super) struct BlockSlots<T> {
    /// Values that are said to come.
    announced: usize,
    /// Of these so many are believed before any has come.
    at_first: usize,
    /// All but the last are as long as a block can be, and full.
    blocks: Vec<Arc<[MaybeUninit<T>]>>,
    /// Values written, from the first slot on without a gap.
    len: usize,
}

impl<T: Pod + Send + Sync> BlockSlots<T> {
    /// Takes room for the first `at_first` values of which so many are announced, which need not be true; more is taken when
    /// these are there, and that of further blocks when their first value comes.
    pub(super) fn new(announced: usize, at_first: usize) -> Self {
        let mut slots = Self {
            announced,
            at_first,
            blocks: Vec::new(),
            len: 0,
        };
        // Here, as each thread that takes room later has memory of its own to take it from.
        slots.free_slots(0);
        slots
    }

    /// Adds what `value` makes of each row, on all cores, and joins by `merge`, in any order, what `measure` finds in pieces of
    /// the rows.
    pub(super) fn extend<const WIDTH: usize, S: Default + Send>(
        &mut self,
        mut rows: &[[u8; WIDTH]],
        value: impl Fn(&[u8; WIDTH]) -> T + Sync,
        measure: impl Fn(&[[u8; WIDTH]]) -> S + Sync,
        merge: impl Fn(S, S) -> S + Sync,
    ) -> S {
        /// Pieces that one thread takes at least, if there are as many.
        const FEWEST_PIECES: usize = 8;
        let write = |(slots, rows): (&mut [MaybeUninit<T>], &[[u8; WIDTH]])| {
            for (slot, row) in slots.iter_mut().zip(rows) {
                slot.write(value(row));
            }
            measure(rows)
        };
        let mut summary = S::default();
        while !rows.is_empty() {
            let slots = self.free_slots(rows.len());
            let (now, later) = rows.split_at(rows.len().min(slots.len()));
            let slots = &mut slots[..now.len()];
            let found = if size_of_val(slots) < MANY_BYTES {
                let pieces = slots.chunks_mut(PIECE_SURFELS);
                let pieces = pieces.zip(now.chunks(PIECE_SURFELS));
                pieces.map(write).fold(S::default(), &merge)
            } else {
                let pieces = slots.par_chunks_mut(PIECE_SURFELS);
                let pieces = pieces.zip(now.par_chunks(PIECE_SURFELS));
                let found = pieces.with_min_len(FEWEST_PIECES).map(write);
                found.reduce(S::default, &merge)
            };
            summary = merge(summary, found);
            self.len += now.len();
            rows = later;
        }
        summary
    }

    /// Slots of the last block for what comes next: seldom fewer than `coming`, and one at least if anything comes.
    fn free_slots(&mut self, coming: usize) -> &mut [MaybeUninit<T>] {
        let index = self.len / MAX_BLOCK_SURFELS;
        let start = index * MAX_BLOCK_SURFELS;
        let used = self.len - start;
        let block = self.blocks.get(index);
        if used == block.map_or(0, |block| block.len()) {
            // Where less was announced, or is believed, twice as much, so that values seldom move.
            // The more have come, the more are believed to come.
            let believed = self.at_first.max(4 * self.len);
            let announced = self.announced.min(believed).saturating_sub(start);
            let wanted = announced.max(2 * used).max(used + coming);
            let mut larger = uninit_slice(wanted.min(MAX_BLOCK_SURFELS));
            if let Some(block) = block {
                larger = moved(block, larger);
            }
            self.blocks.truncate(index);
            self.blocks.push(larger);
        }
        let block = Arc::get_mut(&mut self.blocks[index]).expect("nobody else has it yet");
        &mut block[used..]
    }

    /// The blocks, each as long as it has values.
    pub(super) fn into_blocks(mut self) -> Column<T> {
        // Room for a first one may have been taken for nothing.
        self.blocks.truncate(self.len.div_ceil(MAX_BLOCK_SURFELS));
        if let Some(last) = self.blocks.pop() {
            let used = self.len - self.blocks.len() * MAX_BLOCK_SURFELS;
            let is_full = used == last.len();
            self.blocks.push(if is_full {
                last
            } else {
                moved(&last[..used], uninit_slice(used))
            });
        }
        let blocks = self.blocks.into_iter().map(|block| {
            #[allow(unsafe_code, reason = "there is no safe way to fill memory in parts")]
            // SAFETY: `extend` has written the first `len` slots, and there are no others: all blocks but the last are full,
            // as they are followed by another, and the last was cut above to those that are written.
            unsafe {
                block.assume_init()
            }
        });
        blocks.collect()
    }
}

/// Copies values to the start of other memory, on all cores.
fn moved<T: Pod + Send + Sync>(
    from: &[MaybeUninit<T>],
    mut to: Arc<[MaybeUninit<T>]>,
) -> Arc<[MaybeUninit<T>]> {
    /// Values copied by one thread at a time.
    const SEGMENT: usize = 1 << 15;
    let slots = Arc::get_mut(&mut to).expect("just made, nobody else has it");
    let segments = slots[..from.len()].par_chunks_mut(SEGMENT);
    let segments = segments.zip(from.par_chunks(SEGMENT));
    segments.for_each(|(to, from)| to.copy_from_slice(from));
    to
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bytes that are written, inverted, and the sum of their measures.
    fn write(
        (announced, at_first): (usize, usize),
        bytes: &[u8],
        run: usize,
    ) -> (Column<u8>, usize) {
        let mut slots = BlockSlots::new(announced, at_first);
        let runs = bytes.as_chunks::<1>().0.chunks(run);
        let counts = runs.map(|rows| slots.extend(rows, |[byte]| !byte, <[_]>::len, |a, b| a + b));
        let count = counts.sum();
        (slots.into_blocks(), count)
    }

    #[test]
    fn values_are_cut_where_blocks_are_whatever_was_announced() {
        let surfels = MAX_BLOCK_SURFELS + 1000;
        let bytes: Vec<u8> = (0..surfels).map(|index| (index % 251) as u8).collect();
        let expected: Vec<u8> = bytes.iter().map(|byte| !byte).collect();
        let less = MAX_BLOCK_SURFELS - 7;
        for announced in [
            (0, 0),
            (less, surfels),
            (surfels, surfels),
            (surfels, 5),
            (usize::MAX, less),
        ] {
            for run in [65_536, 1_000_003, surfels] {
                let (blocks, count) = write(announced, &bytes, run);
                let lengths: Vec<usize> = blocks.iter().map(|block| block.len()).collect();
                let case = format!("{announced:?} announced, runs of {run}");
                assert_eq!(lengths, [MAX_BLOCK_SURFELS, 1000], "{case}");
                assert_eq!(count, surfels, "{case}");
                assert!(blocks.concat() == expected, "{case}");
            }
        }
    }

    #[test]
    fn nothing_makes_no_blocks() {
        assert_eq!(write((1000, 1000), &[], 1), (Vec::new(), 0));
    }

    #[test]
    fn full_blocks_stay_where_they_are() {
        let bytes = vec![7; MAX_BLOCK_SURFELS + 5];
        let mut slots = BlockSlots::new(bytes.len(), bytes.len());
        slots.extend(
            &bytes.as_chunks::<1>().0[..9],
            |[byte]| *byte,
            |_| (),
            |(), ()| (),
        );
        let first = slots.blocks[0].as_ptr().addr();
        slots.extend(
            &bytes.as_chunks::<1>().0[9..],
            |[byte]| *byte,
            |_| (),
            |(), ()| (),
        );
        let last = slots.blocks[1].as_ptr().addr();
        let found: Vec<usize> = slots
            .into_blocks()
            .iter()
            .map(|block| block.as_ptr().addr())
            .collect();
        assert_eq!(found, [first, last]);
    }
}
