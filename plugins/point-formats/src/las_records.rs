//! Records of LAS points: as they lie in the file, or decompressed, chunk by chunk.

use std::io::Cursor;

use ::laz::ParLasZipDecompressor;
use las::Header;
use pointstage_plugin_api::{Error, Result};

use crate::las_columns::{Layout, Plan};
use crate::las_pieces::{HandedOver, Piece, Stop};
use crate::laz::{Chunks, Ended, Limits, Taker as _};

/// Bytes of records that are decompressed and not yet handed over, for each thread (two chunks of a usual file, and as many
/// again), and at least so many in all.
const BYTES_A_THREAD: usize = 6 << 20;
const LEAST_BYTES: usize = 1 << 24;

/// Bytes of points that the crate decompresses at once, and that a chunk of ours may have: a header may claim 64 KB a point, and
/// the memory is taken before the first is read.
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
    layout: Layout,
    expected: u64,
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
        let layout = Layout::of(header);
        let packed: usize = description
            .items()
            .iter()
            .map(|item| usize::from(item.size()))
            .sum();
        if packed != layout.stride {
            return Err(unknown(&format_args!(
                "expected points of {} bytes, found {packed}",
                layout.stride
            )));
        }
        let expected = header.number_of_points();
        let mut source = Cursor::new(file);
        source.set_position(start);
        // Made in any case: it refuses files without chunks, which neither of the two decompresses.
        let decompressor = ParLasZipDecompressor::new(source, description.clone())
            .map_err(|error| unknown(&error))?;
        let chunks = Chunks::new(file, start, expected, &description, BYTES_AT_ONCE)
            .map_err(|error| unknown(&error))?;
        let decompressor = match chunks {
            Some(chunks) => Decompressor::Own(chunks),
            None => Decompressor::Crate(Box::new(decompressor)),
        };
        Ok(Self {
            decompressor,
            layout,
            expected,
        })
    }

    /// Decompresses all records and hands them over.
    ///
    /// # Errors
    /// They cannot be decompressed, or what takes them stops.
    pub(crate) fn hand_over(
        self,
        plan: &Plan<'_>,
        handed: &mut HandedOver<'_, '_>,
    ) -> Result<(), Stop> {
        let expected = self.expected;
        let damaged = |taken: u64, problem: &dyn std::fmt::Display| {
            Stop::Failed(Error::failed(format!(
                "expected {expected} points, but behind point {taken} comes what cannot be read: {problem}; the file is damaged or truncated, copy it again"
            )))
        };
        match self.decompressor {
            Decompressor::Own(chunks) => {
                let threads = rayon::current_num_threads();
                let limits = Limits {
                    threads,
                    points: (threads * BYTES_A_THREAD).max(LEAST_BYTES) / self.layout.stride,
                };
                let fetch = |piece: Piece| handed.take(piece);
                match chunks.decompress(limits, plan, fetch) {
                    Ok(()) => Ok(()),
                    Err(Ended::By(stop)) => Err(stop),
                    Err(Ended::Damaged(problem)) => Err(damaged(handed.taken(), &problem)),
                    Err(Ended::NoThread(error)) => Err(Stop::Failed(Error::failed(format!(
                        "the system gives no thread to decompress it: {error}; close other programs"
                    )))),
                }
            }
            Decompressor::Crate(mut decompressor) => {
                let most = (BYTES_AT_ONCE / self.layout.stride as u64).max(1);
                let (mut records, mut piece) = (Vec::new(), Piece::default());
                while handed.taken() < expected {
                    let count = most.min(expected - handed.taken()) as usize;
                    records.resize(count * self.layout.stride, 0);
                    decompressor
                        .decompress_many(&mut records)
                        .map_err(|problem| damaged(handed.taken(), &problem))?;
                    plan.begin(&mut piece, count);
                    plan.fill(&records, &mut piece.columns);
                    piece.largest_colour = self.layout.largest_colour(&records);
                    piece = handed.take(piece)?.unwrap_or_default();
                }
                Ok(())
            }
        }
    }
}
