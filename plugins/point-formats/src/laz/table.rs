//! The chunks of a file, run by run.

use std::io::{Cursor, Seek as _};

use ::laz::LazVlr;
use ::laz::laszip::{ChunkTable, ChunkTableEntry};

use super::lanes::{Chunk, Incomplete, decompress};
use super::layout::Layout;
use crate::large_memory::LargeMemory;

/// The chunks of a file that have not been decompressed yet.
pub(crate) struct Chunks<'a> {
    layout: Layout,
    /// The file from the next chunk on.
    rest: &'a [u8],
    entries: std::vec::IntoIter<ChunkTableEntry>,
}

impl<'a> Chunks<'a> {
    /// The chunks of a file, of which the points begin at byte `start`; `None` where they are left to the crate `laz`, as those
    /// of which one has more than `most_bytes` of records are.
    ///
    /// # Errors
    /// The table of chunks cannot be read.
    pub(crate) fn new(
        file: &'a [u8],
        start: u64,
        description: &LazVlr,
        most_bytes: u64,
    ) -> ::laz::Result<Option<Self>> {
        let Some(layout) = Layout::of(description.items()) else {
            return Ok(None);
        };
        let mut source = Cursor::new(file);
        source.set_position(start);
        let table = ChunkTable::read_from(&mut source, description)?;
        let most = most_bytes / layout.stride() as u64;
        if table.as_ref().iter().any(|entry| entry.point_count > most) {
            return Ok(None);
        }
        let at = usize::try_from(source.stream_position()?).unwrap_or(usize::MAX);
        Ok(Some(Self {
            layout,
            rest: file.get(at..).unwrap_or_default(),
            entries: table.as_ref().to_vec().into_iter(),
        }))
    }

    /// Decompresses whole chunks of about `points` points, but not of more than `left`, in place of what `records` holds, while
    /// so many threads have time; returns their number, 0 only if none is left.
    ///
    /// # Errors
    /// [`Incomplete`]: the file ends before its points do, or is damaged.
    pub(crate) fn next(
        &mut self,
        records: &mut LargeMemory,
        points: u64,
        left: u64,
        threads: usize,
    ) -> Result<u64, Incomplete> {
        let (mut inputs, mut count) = (Vec::new(), 0);
        while count < left {
            let ahead = self.entries.as_slice().first().ok_or(Incomplete)?;
            let of_chunk = ahead.point_count.min(left - count);
            if count > 0 && count + of_chunk > points {
                break;
            }
            let bytes = usize::try_from(ahead.byte_count).map_err(|_| Incomplete)?;
            let (input, rest) = self.rest.split_at_checked(bytes).ok_or(Incomplete)?;
            (self.rest, count) = (rest, count + of_chunk);
            self.entries.next();
            if of_chunk > 0 {
                inputs.push((input, of_chunk as usize * self.layout.stride()));
            }
        }
        records.set_length(count as usize * self.layout.stride());
        let mut outputs = &mut **records;
        let mut chunks = Vec::with_capacity(inputs.len());
        for (input, bytes) in inputs {
            let (output, rest) = outputs.split_at_mut(bytes);
            outputs = rest;
            chunks.push(Chunk { input, output });
        }
        decompress(self.layout, chunks, threads)?;
        Ok(count)
    }
}
