//! The chunks of a file.

use std::io::{Cursor, Seek as _};

use ::laz::LazVlr;
use ::laz::laszip::ChunkTable;

use super::lanes::{Chunk, Incomplete, Taker};
use super::layout::Layout;
use super::sharing::{Ended, Limits, decompress};

/// The chunks of a file that hold its points.
pub(crate) struct Chunks<'a> {
    layout: Layout,
    list: Vec<Chunk<'a>>,
    /// Whether they hold as many points as they should.
    are_all: bool,
}

impl<'a> Chunks<'a> {
    /// The chunks of a file of so many points, which begin at byte `start`; `None` where they are left to the crate `laz`, as
    /// those of which one has more than `most_bytes` of records are.
    ///
    /// # Errors
    /// The table of chunks cannot be read.
    pub(crate) fn new(
        file: &'a [u8],
        start: u64,
        points: u64,
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
        let mut rest = file.get(at..).unwrap_or_default();
        let (mut chunks, mut left) = (Vec::new(), points);
        for entry in table.as_ref() {
            // The last one of a file of equal chunks claims as many points as the others.
            let count = entry.point_count.min(left);
            let input = usize::try_from(entry.byte_count)
                .ok()
                .and_then(|bytes| rest.split_at_checked(bytes));
            let Some((input, behind)) = input else {
                break;
            };
            rest = behind;
            left -= count;
            if count > 0 {
                let count = count as usize;
                chunks.push(Chunk { input, count });
            }
        }
        Ok(Some(Self {
            layout,
            list: chunks,
            are_all: left == 0,
        }))
    }

    /// Decompresses them; see [`decompress`].
    ///
    /// # Errors
    /// [`Ended`]; all chunks before the one at fault have been fetched.
    pub(crate) fn decompress<T: Taker, E>(
        self,
        limits: Limits,
        taker: &T,
        fetch: impl FnMut(T::Piece) -> Result<Option<T::Piece>, E>,
    ) -> Result<(), Ended<E>> {
        decompress(self.layout, self.list, limits, taker, fetch)?;
        if self.are_all {
            Ok(())
        } else {
            Err(Ended::Damaged(Incomplete))
        }
    }
}
