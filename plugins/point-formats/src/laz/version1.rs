//! LASzip's first version, of the point formats 0 to 5: as the second ([`super::chunked`]), but with simpler predictions.
//!
//! Few files are left that need it, so its two lanes are read one after the other. (The crate `laz` 0.13 reads colours and extra bytes
//! of this version differently from LASzip.)

use super::decoder::Decoder;
use super::integer::Integers;
use super::lanes::{Incomplete, Lane};
use super::layout::Layout;
use super::model::{Models, Symbols, WideSymbols};
use super::wave::{self, Waves};
use super::{colour, point10};

/// A chunk that is being decompressed.
pub(super) struct FirstLane<'a> {
    decoder: Decoder<'a>,
    /// The last record.
    record: Vec<u8>,
    points: Points,
    times: Option<Times>,
    colours: Option<Colours>,
    waves: Option<Waves>,
    /// A context for each extra byte.
    extra_bytes: Integers,
}

impl<'a> Lane<'a> for FirstLane<'a> {
    fn begin(layout: Layout, input: &'a [u8], first: &mut [u8]) -> Result<Self, Incomplete> {
        let (record, stream) = input.split_at_checked(first.len()).ok_or(Incomplete)?;
        first.copy_from_slice(record);
        Ok(Self {
            decoder: Decoder::new(stream),
            record: record.to_vec(),
            points: Points::new(),
            times: layout.has_time.then(Times::new),
            colours: layout.has_colour.then(Colours::new),
            waves: layout.has_wave.then(Waves::new),
            extra_bytes: Integers::new(8, layout.extra_bytes.into()),
        })
    }

    fn next<const LANES: usize>(lanes: &mut [Self; LANES], records: [&mut [u8]; LANES]) {
        for (lane, record) in lanes.iter_mut().zip(records) {
            lane.read();
            record.copy_from_slice(&lane.record);
        }
    }

    fn is_whole(&self) -> bool {
        self.decoder.is_whole()
    }
}

impl FirstLane<'_> {
    /// Reads a record in place of the last.
    fn read(&mut self) {
        let decoder = &mut self.decoder;
        let mut fields = &mut self.record[..];
        let mut take = |count: usize| fields.split_off_mut(..count).unwrap_or_default();
        if let Ok(point) = take(point10::BYTES).try_into() {
            self.points.read(decoder, point);
        }
        if let Some(times) = &mut self.times
            && let Ok(time) = take(size_of::<f64>()).try_into()
        {
            times.read(decoder, time);
        }
        if let Some(colours) = &mut self.colours
            && let Ok(colour) = take(colour::BYTES).try_into()
        {
            colours.read(decoder, colour);
        }
        if let Some(waves) = &mut self.waves
            && let Ok(wave) = take(wave::BYTES).try_into()
        {
            waves.read(decoder, wave);
        }
        for (context, byte) in fields.iter_mut().enumerate() {
            *byte = self.extra_bytes.read(decoder, (*byte).into(), context) as u8;
        }
    }
}

/// The item POINT10.
struct Points {
    /// The last three of x and of y, and which is next to be replaced.
    differences: [[i32; 2]; 3],
    oldest: usize,
    x: Integers,
    y: Integers,
    z: Integers,
    changes: Symbols,
    intensities: Integers,
    returns: Models,
    classes: Models,
    angles: Integers,
    users: Models,
    sources: Integers,
}

impl Points {
    fn new() -> Self {
        let positions = Integers::new(32, 1);
        let words = Integers::new(16, 1);
        Self {
            differences: [[0; 2]; 3],
            oldest: 0,
            x: positions.clone(),
            y: positions.with_contexts(20),
            z: positions.with_contexts(20),
            changes: Symbols::new(64),
            intensities: words.clone(),
            returns: Models::new(256, 256),
            classes: Models::new(256, 256),
            angles: Integers::new(8, 2),
            users: Models::new(256, 256),
            sources: words,
        }
    }

    fn read(&mut self, decoder: &mut Decoder<'_>, record: &mut [u8; point10::BYTES]) {
        const MOST_SIZE: u32 = 19;
        let [x, y, z] = [0, 4, 8].map(|at| i32::from_le_bytes(bytes(record, at)));
        let median = |axis: usize| {
            let [a, b, c] = self.differences.map(|difference| difference[axis]);
            a.min(b).max(a.max(b).min(c))
        };
        let (median_x, median_y) = (median(0), median(1));
        let of_x = self.x.read(decoder, median_x, 0);
        let size = self.x.size;
        let of_y = self.y.read(decoder, median_y, size.min(MOST_SIZE) as usize);
        let size = size.midpoint(self.y.size);
        let z = self.z.read(decoder, z, size.min(MOST_SIZE) as usize);
        record[0..4].copy_from_slice(&x.wrapping_add(of_x).to_le_bytes());
        record[4..8].copy_from_slice(&y.wrapping_add(of_y).to_le_bytes());
        record[8..12].copy_from_slice(&z.to_le_bytes());
        self.differences[self.oldest % 3] = [of_x, of_y];
        self.oldest = (self.oldest + 1) % 3;
        let change = decoder.symbol(&mut self.changes);
        if change & 32 != 0 {
            let last = u16::from_le_bytes(bytes(record, 12));
            let intensity = self.intensities.read(decoder, last.into(), 0) as u16;
            record[12..14].copy_from_slice(&intensity.to_le_bytes());
        }
        if change & 16 != 0 {
            record[14] = decoder.symbol(self.returns.get(record[14].into()));
        }
        if change & 8 != 0 {
            record[15] = decoder.symbol(self.classes.get(record[15].into()));
        }
        if change & 4 != 0 {
            let is_near = usize::from(size < 3);
            record[16] = self.angles.read(decoder, record[16].into(), is_near) as u8;
        }
        if change & 2 != 0 {
            record[17] = decoder.symbol(self.users.get(record[17].into()));
        }
        if change & 1 != 0 {
            let last = u16::from_le_bytes(bytes(record, 18));
            let source = self.sources.read(decoder, last.into(), 0) as u16;
            record[18..20].copy_from_slice(&source.to_le_bytes());
        }
    }
}

/// Some bytes of a record.
fn bytes<const BYTES: usize>(record: &[u8; point10::BYTES], at: usize) -> [u8; BYTES] {
    std::array::from_fn(|byte| record[at + byte])
}

/// The item GPSTIME11.
struct Times {
    difference: i32,
    extremes: u32,
    multiples: WideSymbols,
    without_difference: Symbols,
    numbers: Integers,
}

impl Times {
    /// The largest multiple of the last difference that has a code, then the codes of a time in full and of one that stays.
    const LARGEST: i32 = 509;
    const FULL: i32 = 510;
    const STAYS: i32 = 511;

    fn new() -> Self {
        Self {
            difference: 0,
            extremes: 0,
            multiples: WideSymbols::new(512),
            without_difference: Symbols::new(3),
            numbers: Integers::new(32, 6),
        }
    }

    fn read(&mut self, decoder: &mut Decoder<'_>, record: &mut [u8; 8]) {
        let mut time = i64::from_le_bytes(*record);
        if self.difference == 0 {
            match decoder.symbol(&mut self.without_difference) {
                0 => {}
                1 => {
                    self.difference = self.numbers.read(decoder, 0, 0);
                    time = time.wrapping_add(self.difference.into());
                }
                _ => time = decoder.full(),
            }
        } else {
            match decoder.wide_symbol(&mut self.multiples) as i32 {
                Self::STAYS => {}
                Self::FULL => time = decoder.full(),
                multiple => time = time.wrapping_add(self.read_multiple(decoder, multiple).into()),
            }
        }
        *record = time.to_le_bytes();
    }

    /// A difference that is about a multiple of the last.
    fn read_multiple(&mut self, decoder: &mut Decoder<'_>, multiple: i32) -> i32 {
        let (foretold, context) = match multiple {
            0 => (self.difference / 4, 2),
            1 => (self.difference, 1),
            2..10 => (self.difference.wrapping_mul(multiple), 3),
            10..50 => (self.difference.wrapping_mul(multiple), 4),
            _ => (self.difference.wrapping_mul(multiple), 5),
        };
        let difference = self.numbers.read(decoder, foretold, context);
        if multiple == 0 || multiple == Self::LARGEST {
            self.extremes += 1;
        }
        if multiple == 1 || self.extremes > 3 {
            self.difference = difference;
            self.extremes = 0;
        }
        difference
    }
}

/// The item RGB12.
struct Colours {
    changes: Symbols,
    /// A context for each byte.
    bytes: Integers,
}

impl Colours {
    fn new() -> Self {
        Self {
            changes: Symbols::new(64),
            bytes: Integers::new(8, colour::BYTES),
        }
    }

    fn read(&mut self, decoder: &mut Decoder<'_>, record: &mut [u8; colour::BYTES]) {
        let change = decoder.symbol(&mut self.changes);
        for (context, byte) in record.iter_mut().enumerate() {
            if change & (1 << context) != 0 {
                *byte = self.bytes.read(decoder, (*byte).into(), context) as u8;
            }
        }
    }
}
