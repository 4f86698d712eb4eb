//! Streams that the crate `laz` would not write: of LASzip's first version, and damaged ones.

use std::io::Write;

use ::laz::compressors::{IntegerCompressor, IntegerCompressorBuilder};
use ::laz::encoders::ArithmeticEncoder;
use ::laz::models::{ArithmeticModel, ArithmeticModelBuilder};
use ::laz::record::{FieldCompressor, RecordCompressor, SequentialPointRecordCompressor};

use super::*;

/// Extra bytes and colours of the first version as LASzip compresses them; the crate's are different.
struct OldBytes {
    last: Vec<u8>,
    /// Of colours: which bytes change.
    changes: Option<ArithmeticModel>,
    numbers: IntegerCompressor,
}

impl OldBytes {
    fn new(count: u32, changes: Option<ArithmeticModel>) -> Self {
        let mut numbers = IntegerCompressorBuilder::new();
        Self {
            last: vec![0; count as usize],
            changes,
            numbers: numbers.bits(8).contexts(count).build_initialized(),
        }
    }
}

impl<W: Write> FieldCompressor<W> for OldBytes {
    fn size_of_field(&self) -> usize {
        self.last.len()
    }

    fn compress_first(&mut self, out: &mut W, bytes: &[u8]) -> std::io::Result<()> {
        self.last.copy_from_slice(bytes);
        out.write_all(bytes)
    }

    fn compress_with(
        &mut self,
        encoder: &mut ArithmeticEncoder<W>,
        bytes: &[u8],
    ) -> std::io::Result<()> {
        let pairs = || self.last.iter().zip(bytes).enumerate();
        if let Some(model) = &mut self.changes {
            let bits = pairs().map(|(at, (last, byte))| u32::from(last != byte) << at);
            encoder.encode_symbol(model, bits.sum())?;
        }
        for (at, (last, byte)) in pairs() {
            if self.changes.is_none() || last != byte {
                let (from, to) = (i32::from(*last), i32::from(*byte));
                self.numbers.compress(encoder, from, to, at as u32)?;
            }
        }
        self.last.copy_from_slice(bytes);
        Ok(())
    }
}

/// As LASzip did at first: without chunks, and so without their table.
#[test]
fn points_in_one_piece_come_out() {
    let first = of_version(&[LazItemType::Point10, LazItemType::GpsTime], 1);
    let wave = of_version(&[LazItemType::WavePacket13], 1);
    let types = [
        LazItemType::Point10,
        LazItemType::GpsTime,
        LazItemType::RGB12,
        LazItemType::WavePacket13,
        LazItemType::Byte(3),
    ];
    let all = of_version(&types, 1);
    for kind in KINDS {
        let wanted = records(kind, &all, 500, &mut Random(13));
        let mut compressor = SequentialPointRecordCompressor::new(Vec::new());
        compressor.set_fields_from(&first).unwrap();
        let changes = ArithmeticModelBuilder::new(64).build();
        compressor.add_field_compressor(OldBytes::new(6, Some(changes)));
        compressor.set_fields_from(&wave).unwrap();
        compressor.add_field_compressor(OldBytes::new(3, None));
        compressor.compress_many(&wanted).unwrap();
        compressor.done().unwrap();
        let mut file = b"before".to_vec();
        file.extend(compressor.into_inner());
        let end = file.len();
        file.extend(b"behind");
        let mut description = Vec::new();
        let chunked = LazVlr::from_laz_items(all.clone());
        chunked.write_to(&mut description).unwrap();
        description[..2].copy_from_slice(&1_u16.to_le_bytes());
        let description = LazVlr::from_buffer(description).unwrap();
        let read = |file: &[u8]| {
            let chunks = Chunks::new(file, 6, 500, &description).unwrap();
            all_of(chunks, &description, limits(2, 1000))
        };
        assert!(read(&file) == Ok(wanted), "{kind:?}");
        assert_eq!(read(&file[..end - 16]), Err(Incomplete), "{kind:?}");
        assert_eq!(read(&[]), Err(Incomplete), "{kind:?}");
    }
}

/// Damaged times, which change their sequence for ever.
struct EndlessTimes(ArithmeticModel);

impl<W: Write> FieldCompressor<W> for EndlessTimes {
    fn size_of_field(&self) -> usize {
        8
    }

    fn compress_first(&mut self, out: &mut W, bytes: &[u8]) -> std::io::Result<()> {
        out.write_all(bytes)
    }

    fn compress_with(
        &mut self,
        encoder: &mut ArithmeticEncoder<W>,
        _: &[u8],
    ) -> std::io::Result<()> {
        const TO_NEXT_SEQUENCE: u32 = 3;
        (0..1_000_000).try_for_each(|_| encoder.encode_symbol(&mut self.0, TO_NEXT_SEQUENCE))
    }
}

/// The crate's decoder calls itself for each change: the stack would overflow.
#[test]
fn times_that_change_their_sequence_for_ever_are_survived() {
    let types = [
        LazItemType::Point10,
        LazItemType::GpsTime,
        LazItemType::WavePacket13,
    ];
    let all = items(&types);
    let mut compressor = SequentialPointRecordCompressor::new(Vec::new());
    compressor.set_fields_from(&all[..1].to_vec()).unwrap();
    compressor.add_field_compressor(EndlessTimes(ArithmeticModelBuilder::new(6).build()));
    compressor.set_fields_from(&all[2..].to_vec()).unwrap();
    let records = records(Kind::Constant, &all, 2, &mut Random(5));
    compressor.compress_many(&records).unwrap();
    compressor.done().unwrap();
    let layout = Layout::of(&all).unwrap();
    let input = compressor.into_inner();
    let chunks = vec![Chunk {
        input: &input,
        count: 2,
    }];
    let taker = Plain {
        stride: layout.stride(),
    };
    let fetch = |_| Ok::<_, Never>(None);
    // Whatever comes out.
    let _ = decompress(layout, chunks, limits(1, 1), &taker, fetch);
}
