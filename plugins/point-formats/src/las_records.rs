//! Records of LAS points as they lie in the file, or decompressed from it, run by run.

use std::io::Cursor;

use ::laz::ParLasZipDecompressor;
use las::Header;
use pointstage_plugin_api::{Error, Result};

use crate::large_memory::LargeMemory;
use crate::laz::Chunks;

/// Points decompressed at once for each thread: two chunks of a usual file, and at least so many in all.
const POINTS_A_THREAD: u64 = 100_000;
const POINTS_AT_ONCE: u64 = 400_000;

/// Bytes of points decompressed at once: a header may claim 64 KB a point, and the memory is taken before the first is read.
const BYTES_AT_ONCE: u64 = 1 << 24;

/// Where records come from.
pub(crate) enum Records<'a> {
    /// They lie in the file.
    Plain(&'a [u8]),
    Packed(Packed<'a>),
}

/// Records that are decompressed.
pub(crate) struct Packed<'a> {
    decompressor: Decompressor<'a>,
    stride: usize,
    expected: u64,
    read: u64,
}

/// What decompresses records.
enum Decompressor<'a> {
    /// Ours, for most files.
    Own(Chunks<'a>),
    /// That of the crate `laz`, for the others.
    Crate(Box<ParLasZipDecompressor<Cursor<&'a [u8]>>>),
}

impl<'a> Records<'a> {
    /// The records of a file, of which the points begin at byte `start`.
    ///
    /// # Errors
    /// The file ends before its points do, or does not say how they are compressed.
    pub(crate) fn new(file: &'a [u8], start: u64, header: &Header) -> Result<Self> {
        let (expected, format) = (header.number_of_points(), header.point_format());
        let stride = usize::from(format.len());
        if format.is_compressed {
            return Packed::new(file, start, header).map(Self::Packed);
        }
        let start = usize::try_from(start).unwrap_or(usize::MAX);
        let all = file.get(start..).unwrap_or_default();
        let bytes = usize::try_from(expected)
            .ok()
            .and_then(|points| points.checked_mul(stride))
            .and_then(|bytes| all.get(..bytes));
        bytes.map(Self::Plain).ok_or_else(|| {
            Error::failed(format!(
                "expected {expected} points of {stride} bytes, found {} bytes; the file is truncated, copy it again",
                all.len()
            ))
        })
    }
}

impl<'a> Packed<'a> {
    fn new(file: &'a [u8], start: u64, header: &Header) -> Result<Self> {
        let unknown = |problem: &dyn std::fmt::Display| {
            Error::failed(format!(
                "how its points are compressed cannot be read: {problem}; the file is damaged, copy it again"
            ))
        };
        let description = header.laz_vlr().map_err(|error| unknown(&error))?;
        let stride = usize::from(header.point_format().len());
        let packed: usize = description
            .items()
            .iter()
            .map(|item| usize::from(item.size()))
            .sum();
        if packed != stride {
            return Err(unknown(&format_args!(
                "expected points of {stride} bytes, found {packed}"
            )));
        }
        let mut source = Cursor::new(file);
        source.set_position(start);
        // Made in any case: it refuses files without chunks, which neither of the two decompresses.
        let decompressor = ParLasZipDecompressor::new(source, description.clone())
            .map_err(|error| unknown(&error))?;
        let chunks = Chunks::new(file, start, &description, BYTES_AT_ONCE)
            .map_err(|error| unknown(&error))?;
        let decompressor = match chunks {
            Some(chunks) => Decompressor::Own(chunks),
            None => Decompressor::Crate(Box::new(decompressor)),
        };
        Ok(Self {
            decompressor,
            stride,
            expected: header.number_of_points(),
            read: 0,
        })
    }

    /// The next records, in place of those that `records` holds; none behind the last. All threads but `busy` ones have time.
    ///
    /// # Errors
    /// They cannot be decompressed.
    pub(crate) fn next(&mut self, records: &mut LargeMemory, busy: usize) -> Result<()> {
        let threads = rayon::current_num_threads();
        let points = (POINTS_A_THREAD * threads as u64).max(POINTS_AT_ONCE);
        let most = (BYTES_AT_ONCE / self.stride as u64).clamp(1, points);
        let threads = threads.saturating_sub(busy).max(1);
        let left = self.expected - self.read;
        let damaged = |problem: &dyn std::fmt::Display| {
            Error::failed(format!(
                "expected {} points, but behind point {} comes what cannot be read: {problem}; the file is damaged or truncated, copy it again",
                self.expected, self.read
            ))
        };
        let count = match &mut self.decompressor {
            Decompressor::Own(chunks) => chunks
                .next(records, most, left, threads)
                .map_err(|problem| damaged(&problem))?,
            Decompressor::Crate(decompressor) => {
                let count = most.min(left);
                records.set_length(count as usize * self.stride);
                if count > 0 {
                    decompressor
                        .decompress_many(records)
                        .map_err(|problem| damaged(&problem))?;
                }
                count
            }
        };
        self.read += count;
        Ok(())
    }

    /// How much of the file has been read, from 0 to 1.
    pub(crate) fn fraction(&self) -> f32 {
        self.read as f32 / self.expected as f32
    }
}
