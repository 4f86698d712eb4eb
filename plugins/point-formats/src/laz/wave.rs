//! Wave packets: item WAVEPACKET13, version 1, and WAVEPACKET14, versions 3 and 4, which is the same in a layer of its own.

use super::decoder::Decoder;
use super::integer::Integers;
use super::model::Symbols;

/// Bytes of a record.
pub(super) const BYTES: usize = 29;

/// A record's fields.
struct Wave {
    descriptor: u8,
    /// Where the waveform lies, in bytes.
    offset: u64,
    /// Bytes of the waveform.
    size: u32,
    /// The bits of floats: the place of the return, then the direction.
    place: i32,
    direction: [i32; 3],
}

impl Wave {
    fn read(record: &[u8; BYTES]) -> Self {
        let [descriptor, a, b, c, d, e, f, g, h, numbers @ ..] = *record;
        let (numbers, _) = numbers.as_chunks();
        let number = |at: usize| numbers.get(at).copied().unwrap_or_default();
        Self {
            descriptor,
            offset: u64::from_le_bytes([a, b, c, d, e, f, g, h]),
            size: u32::from_le_bytes(number(0)),
            place: i32::from_le_bytes(number(1)),
            direction: [number(2), number(3), number(4)].map(i32::from_le_bytes),
        }
    }

    fn write(&self, record: &mut [u8; BYTES]) {
        let [x, y, z] = self.direction;
        record[0] = self.descriptor;
        record[1..9].copy_from_slice(&self.offset.to_le_bytes());
        record[9..13].copy_from_slice(&self.size.to_le_bytes());
        record[13..17].copy_from_slice(&self.place.to_le_bytes());
        record[17..21].copy_from_slice(&x.to_le_bytes());
        record[21..25].copy_from_slice(&y.to_le_bytes());
        record[25..29].copy_from_slice(&z.to_le_bytes());
    }
}

/// Models of wave packets.
pub(super) struct Waves {
    descriptors: Symbols,
    /// How the offset is told, by how that before was.
    ways: [Symbols; 4],
    way: usize,
    difference: i32,
    differences: Integers,
    sizes: Integers,
    places: Integers,
    directions: Integers,
}

impl Waves {
    pub(super) fn new() -> Self {
        let way = Symbols::new(4);
        let integers = Integers::new(32, 1);
        Self {
            descriptors: Symbols::new(256),
            ways: std::array::from_fn(|_| way.clone()),
            way: 0,
            difference: 0,
            differences: integers.clone(),
            sizes: integers.clone(),
            places: integers.clone(),
            directions: integers.with_contexts(3),
        }
    }

    /// Reads a record in place of the one before.
    pub(super) fn read(&mut self, decoder: &mut Decoder<'_>, record: &mut [u8; BYTES]) {
        let mut wave = Wave::read(record);
        wave.descriptor = decoder.symbol(&mut self.descriptors);
        self.way = usize::from(decoder.symbol(&mut self.ways[self.way & 3]));
        match self.way {
            0 => {}
            1 => wave.offset = wave.offset.wrapping_add(wave.size.into()),
            2 => {
                self.difference = self.differences.read(decoder, self.difference, 0);
                wave.offset = wave.offset.wrapping_add_signed(self.difference.into());
            }
            _ => wave.offset = decoder.full() as u64,
        }
        wave.size = self.sizes.read(decoder, wave.size as i32, 0) as u32;
        wave.place = self.places.read(decoder, wave.place, 0);
        for (context, number) in wave.direction.iter_mut().enumerate() {
            *number = self.directions.read(decoder, *number, context);
        }
        wave.write(record);
    }
}
