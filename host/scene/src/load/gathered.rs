//! Values of a column that come in runs: room is made for all that are announced, and runs are copied there on all cores.

use bytes::{Bytes, BytesMut};

use super::memory::{append, room};
use pointstage_plugin_api::columns::MAX_BLOCK_SURFELS;

/// The values of one column.
#[derive(Debug)]
pub(super) struct Gathered {
    /// Bytes of one surfel's values.
    width: usize,
    /// Bytes that a part may hold.
    part_bytes: usize,
    parts: Vec<BytesMut>,
}

impl Gathered {
    /// All values lie together.
    pub(super) fn together(width: usize) -> Self {
        Self {
            width,
            part_bytes: usize::MAX,
            parts: Vec::new(),
        }
    }

    /// The values are cut as an object's blocks are.
    pub(super) fn in_blocks(width: usize) -> Self {
        Self {
            part_bytes: MAX_BLOCK_SURFELS * width,
            ..Self::together(width)
        }
    }

    /// Makes room for the values of surfels that are announced, before any has come: one piece of memory for all these columns,
    /// for small ones have no large pages of their own. The system gives the memory when it is written to.
    pub(super) fn reserve<'a>(columns: impl IntoIterator<Item = &'a mut Self>, surfels: usize) {
        /// Parts begin at multiples of this many bytes, as values of any type may.
        const ALIGNMENT: usize = 16;
        let mut columns: Vec<&mut Self> = columns.into_iter().collect();
        let mut lengths: Vec<(usize, usize)> = Vec::new();
        for (number, column) in columns.iter_mut().enumerate() {
            column.parts.clear();
            let mut left = surfels * column.width;
            while left > 0 {
                let part = left.min(column.part_bytes);
                lengths.push((number, part.next_multiple_of(ALIGNMENT)));
                left -= part;
            }
        }
        let mut rest = room(lengths.iter().map(|(_, length)| length).sum());
        for (number, length) in lengths {
            let behind = rest.split_off(length);
            columns[number]
                .parts
                .push(std::mem::replace(&mut rest, behind));
        }
    }

    /// Adds the values of some surfels, whole ones.
    pub(super) fn add(&mut self, mut values: &[u8]) {
        let part_bytes = self.part_bytes;
        let free = |part: &BytesMut| part_bytes - part.len();
        let room = self.parts.iter().map(free).fold(0, usize::saturating_add);
        let more = values.len().saturating_sub(room).div_ceil(part_bytes);
        self.parts
            .extend(std::iter::repeat_with(BytesMut::new).take(more));
        for part in &mut self.parts {
            let (now, later) = values.split_at(values.len().min(free(part)));
            values = later;
            if !now.is_empty() {
                append(part, now);
            }
        }
    }

    /// The parts, without the room that was left if that is much.
    pub(super) fn into_parts(self) -> impl Iterator<Item = Bytes> {
        let parts = self.parts.into_iter().filter(|part| !part.is_empty());
        parts.map(|part| {
            let left = part.capacity() - part.len();
            if left > part.len() / 8 {
                Bytes::copy_from_slice(&part)
            } else {
                part.freeze()
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of `surfels` surfels, handed over in runs of `run`.
    fn gather(mut gathered: Gathered, width: usize, surfels: usize, run: usize) -> Vec<Bytes> {
        let all = values(width * surfels);
        for values in all.chunks(run * width) {
            gathered.add(values);
        }
        gathered.into_parts().collect()
    }

    fn values(count: usize) -> Vec<u8> {
        (0..count).map(|index| (index % 251) as u8).collect()
    }

    #[test]
    fn values_stay_in_order_whatever_was_announced() {
        const SURFELS: usize = 700_000;
        for announced in [0, 1, 400_001, SURFELS, SURFELS + 5] {
            for run in [SURFELS, 65_536, 333_333] {
                let mut gathered = Gathered::together(3);
                Gathered::reserve([&mut gathered], announced);
                let found = gather(gathered, 3, SURFELS, run);
                assert!(
                    found == [values(3 * SURFELS)],
                    "{announced} announced, runs of {run}"
                );
            }
        }
    }

    #[test]
    fn values_in_blocks_are_cut_where_blocks_are() {
        let surfels = MAX_BLOCK_SURFELS + 1000;
        for announced in [
            0,
            MAX_BLOCK_SURFELS - 7,
            surfels,
            surfels + MAX_BLOCK_SURFELS,
        ] {
            let mut gathered = Gathered::in_blocks(1);
            Gathered::reserve([&mut gathered], announced);
            let found = gather(gathered, 1, surfels, 1_000_003);
            let lengths: Vec<usize> = found.iter().map(Bytes::len).collect();
            assert_eq!(lengths, [MAX_BLOCK_SURFELS, 1000], "{announced} announced");
            assert!(found.concat() == values(surfels), "{announced} announced");
        }
    }
}
