//! Chunks that the crate `laz` decompresses: of other versions, with waves or very many extra bytes.

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

use ::laz::record::{
    LayeredPointRecordDecompressor, RecordDecompressor, SequentialPointRecordDecompressor,
};
use ::laz::{LazItem, LazItemType};

use super::lanes::{Incomplete, Lane};

/// Extra bytes of a record at most: each has a model of some KB in each chunk that is being decompressed.
const MOST_EXTRA_BYTES: u16 = 1024;

/// Fields of a record that the crate knows.
#[derive(Clone, Debug)]
pub(super) struct Items {
    list: Vec<LazItem>,
    pub(super) stride: usize,
    /// Streams of a chunk, where each field has one of its own.
    streams: Option<usize>,
}

type Decompressor<'a> = Box<dyn RecordDecompressor<Cursor<&'a [u8]>> + Send + 'a>;

impl Items {
    /// Those of a file.
    ///
    /// # Errors
    /// The crate does not know them.
    pub(super) fn of(items: &[LazItem]) -> Result<Self, String> {
        let is_layered = items.first().is_some_and(|item| item.version() >= 3);
        let streams = items.iter().map(|item| match item.item_type() {
            LazItemType::Point14 => 9,
            LazItemType::RGBNIR14 => 2,
            LazItemType::Byte14(count) => count.into(),
            _ => 1,
        });
        let new = Self {
            list: items.to_vec(),
            stride: items.iter().map(|item| usize::from(item.size())).sum(),
            streams: is_layered.then(|| streams.sum()),
        };
        for item in items {
            if let LazItemType::Byte(count) | LazItemType::Byte14(count) = item.item_type()
                && count > MOST_EXTRA_BYTES
            {
                return Err(format!(
                    "points have {count} extra bytes, expected {MOST_EXTRA_BYTES} at most"
                ));
            }
        }
        match new.decompressor(&[]) {
            Ok(_) => Ok(new),
            Err(error) => Err(error.to_string()),
        }
    }

    fn decompressor<'a>(&self, input: &'a [u8]) -> ::laz::Result<Decompressor<'a>> {
        let input = Cursor::new(input);
        let mut decompressor: Decompressor<'a> = if self.streams.is_some() {
            Box::new(LayeredPointRecordDecompressor::new(input))
        } else {
            Box::new(SequentialPointRecordDecompressor::new(input))
        };
        decompressor.set_fields_from(&self.list)?;
        Ok(decompressor)
    }

    /// Whether the streams of a chunk are no longer than it: the crate takes memory for what is claimed.
    fn streams_fit(&self, input: &[u8]) -> bool {
        let Some(streams) = self.streams else {
            return true;
        };
        // The first record, and the number of points.
        let sizes = input.get(self.stride + 4..).unwrap_or_default();
        let Some((sizes, rest)) = sizes.split_at_checked(4 * streams) else {
            return false;
        };
        let sizes = sizes.as_chunks().0.iter();
        let all: u64 = sizes.map(|size| u64::from(u32::from_le_bytes(*size))).sum();
        all <= rest.len() as u64
    }
}

/// A chunk that is being decompressed.
pub(super) struct CrateLane<'a> {
    decompressor: Decompressor<'a>,
    is_whole: bool,
}

impl CrateLane<'_> {
    /// Writes the next record, unless what is read is damaged. The crate has assertions that damage breaks.
    fn read(&mut self, record: &mut [u8]) {
        let read = AssertUnwindSafe(|| self.decompressor.decompress_next(record).is_ok());
        self.is_whole = self.is_whole && catch_unwind(read).unwrap_or(false);
    }
}

impl<'a> Lane<'a> for CrateLane<'a> {
    type Format = Items;

    fn begin(items: &Items, input: &'a [u8], first: &mut [u8]) -> Result<Self, Incomplete> {
        if !items.streams_fit(input) {
            return Err(Incomplete);
        }
        let mut lane = Self {
            decompressor: items.decompressor(input).map_err(|_| Incomplete)?,
            is_whole: true,
        };
        lane.read(first);
        lane.is_whole.then_some(lane).ok_or(Incomplete)
    }

    fn next<const LANES: usize>(lanes: &mut [Self; LANES], records: [&mut [u8]; LANES]) {
        for (lane, record) in lanes.iter_mut().zip(records) {
            lane.read(record);
        }
    }

    fn is_whole(&self) -> bool {
        self.is_whole
    }
}
