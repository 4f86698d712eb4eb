//! Records of LAS points: as they lie in the file, or decompressed, chunk by chunk.

use las::Header;
use pointstage_plugin_api::{Error, Result};

use crate::las_columns::Plan;
use crate::las_pieces::{HandedOver, Piece, Stop};
use crate::laz::{Chunks, Ended, Limits};

/// Bytes of records that are decompressed and not yet handed over, for each thread (two chunks of a usual file, and as many
/// again), and at least so many in all.
const BYTES_A_THREAD: usize = 6 << 20;
const LEAST_BYTES: usize = 1 << 24;

/// Bytes of the records of a chunk that is handed over as a whole.
const BYTES_OF_CHUNK: usize = 1 << 24;

/// Where records come from.
pub(crate) enum Records<'a> {
    /// They lie in the file.
    Plain(&'a [u8]),
    Packed(Packed<'a>),
}

/// Records that are decompressed.
pub(crate) struct Packed<'a> {
    chunks: Chunks<'a>,
    stride: usize,
    expected: u64,
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
        let expected = header.number_of_points();
        let chunks = Chunks::new(file, start, expected, &description);
        Ok(Self {
            chunks: chunks.map_err(|problem| unknown(&problem))?,
            stride,
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
        let threads = rayon::current_num_threads();
        let limits = Limits {
            threads,
            points: (threads * BYTES_A_THREAD).max(LEAST_BYTES) / self.stride,
            of_chunk: BYTES_OF_CHUNK / self.stride,
        };
        let fetch = |piece: Piece| handed.take(piece);
        match self.chunks.decompress(limits, plan, fetch) {
            Ok(()) => Ok(()),
            Err(Ended::By(stop)) => Err(stop),
            Err(Ended::Damaged(problem)) => Err(Stop::Failed(Error::failed(format!(
                "expected {} points, but behind point {} comes what cannot be read: {problem}; the file is damaged or truncated, copy it again",
                self.expected,
                handed.taken()
            )))),
            Err(Ended::NoThread(error)) => Err(Stop::Failed(Error::failed(format!(
                "the system gives no thread to decompress it: {error}; close other programs"
            )))),
        }
    }
}
