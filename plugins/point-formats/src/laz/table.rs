//! The chunks of a file.
//!
//! The crate `laz` reads the table, too, but takes memory for as many chunks as it claims, which ends the program if there is
//! not so much.

use ::laz::LazVlr;

use super::decoder::Decoder;
use super::integer::Integers;
use super::lanes::{Chunk, Incomplete, Taker};
use super::layout::{Layout, Version};
use super::sharing::{Ended, Limits, decompress};

/// Bytes before the first chunk, which say where the table is.
const PLACE_BYTES: usize = size_of::<i64>();
/// Bytes of the table before its entries: a version, and the number of chunks.
const HEAD_BYTES: usize = 8;
/// Bytes of a file for each of its chunks at least. A chunk has a whole record, unless it is empty.
const FEWEST_BYTES: usize = 8;
/// How LASzip calls points that are compressed without chunks, as in its first version.
const IN_ONE_PIECE: u16 = 1;
/// And those in chunks of one stream and of many.
const CHUNKED: [u16; 2] = [2, 3];

/// The chunks of a file that hold its points.
#[derive(Debug)]
pub(crate) struct Chunks<'a> {
    layout: Layout,
    list: Vec<Chunk<'a>>,
    /// Whether they hold as many points as they should.
    are_all: bool,
}

impl<'a> Chunks<'a> {
    /// The chunks of a file of so many points, which begin at byte `start`.
    ///
    /// # Errors
    /// It is not known how they are compressed, or there is no table of chunks.
    pub(crate) fn new(
        file: &'a [u8],
        start: u64,
        points: u64,
        description: &LazVlr,
    ) -> Result<Self, String> {
        let layout = Layout::of(description.items())?;
        let start = usize::try_from(start).unwrap_or(usize::MAX);
        let compressor = compressor_of(description);
        if compressor == IN_ONE_PIECE && matches!(layout.version, Version::First | Version::Second)
        {
            return Ok(Self::in_one_piece(layout, file, start, points));
        }
        if !CHUNKED.contains(&compressor) {
            return Err(format!(
                "compressor {compressor} is not known, expected {IN_ONE_PIECE} or one of {CHUNKED:?}; compress it again with another program"
            ));
        }
        let missing = || "there is no table of chunks".to_owned();
        let table = table_of(file, start).ok_or_else(missing)?;
        let (number, entries) = table.split_at_checked(HEAD_BYTES).ok_or_else(missing)?;
        let number = number
            .last_chunk()
            .map_or(0, |number| u32::from_le_bytes(*number));
        if number as usize > file.len() / FEWEST_BYTES {
            return Err(format!(
                "it claims {number} chunks, which no file of its length can hold"
            ));
        }
        let mut entries = Entries {
            decoder: Decoder::new(entries),
            numbers: Integers::new(32, 2),
            count: 0,
            bytes: 0,
        };
        let mut rest = file
            .get(start.saturating_add(PLACE_BYTES)..)
            .unwrap_or_default();
        let (mut list, mut left) = (Vec::new(), points);
        let equal = (!description.uses_variable_size_chunks()).then(|| description.chunk_size());
        for _ in 0..number {
            let Some((count, bytes)) = entries.next(equal) else {
                break;
            };
            let Some((input, behind)) = rest.split_at_checked(bytes) else {
                break;
            };
            rest = behind;
            // The last one of equal chunks has fewer points than the others.
            let count = u64::from(count).min(left);
            left -= count;
            if count > 0 {
                let count = count as usize;
                list.push(Chunk { input, count });
            }
        }
        Ok(Self {
            layout,
            list,
            are_all: left == 0,
        })
    }

    /// All points as one chunk, which begins at once.
    fn in_one_piece(layout: Layout, file: &'a [u8], start: usize, points: u64) -> Self {
        let input = file.get(start..).unwrap_or_default();
        let count = usize::try_from(points).ok();
        let chunk = count
            .filter(|count| *count > 0)
            .map(|count| Chunk { input, count });
        Self {
            layout,
            are_all: chunk.is_some() || points == 0,
            list: Vec::from_iter(chunk),
        }
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

/// The number of the compressor, of which the crate does not tell.
fn compressor_of(description: &LazVlr) -> u16 {
    let mut bytes = Vec::new();
    match description.write_to(&mut bytes) {
        Ok(()) => bytes
            .first_chunk()
            .map_or(0, |first| u16::from_le_bytes(*first)),
        Err(_) => 0,
    }
}

/// The table of chunks of points that begin at a byte, and what follows it. Where it is stands before the first chunk, or at
/// the end of the file if the writer could not go back.
fn table_of(file: &[u8], start: usize) -> Option<&[u8]> {
    let before = file.get(start..)?.first_chunk::<PLACE_BYTES>()?;
    let places = [before, file.last_chunk()?].map(|place| i64::from_le_bytes(*place));
    let mut places = places
        .into_iter()
        .filter_map(|place| usize::try_from(place).ok());
    file.get(places.find(|place| *place > start)?..)
}

/// The entries of a table.
struct Entries<'a> {
    decoder: Decoder<'a>,
    numbers: Integers,
    count: i32,
    bytes: i32,
}

impl Entries<'_> {
    /// Points and bytes of the next chunk; `equal` are the points of each, where they are not in the table. `None` if there is no
    /// entry, or it is damaged.
    fn next(&mut self, equal: Option<u32>) -> Option<(u32, usize)> {
        const COUNT_CONTEXT: usize = 0;
        const BYTES_CONTEXT: usize = 1;
        if equal.is_none() {
            self.count = self
                .numbers
                .read(&mut self.decoder, self.count, COUNT_CONTEXT);
        }
        self.bytes = self
            .numbers
            .read(&mut self.decoder, self.bytes, BYTES_CONTEXT);
        let count = equal.or_else(|| u32::try_from(self.count).ok())?;
        let bytes = usize::try_from(self.bytes).ok()?;
        self.decoder.is_whole().then_some((count, bytes))
    }
}
