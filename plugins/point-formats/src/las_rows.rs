//! Values of LAS records, column by column.

use crate::las_extra::Extra;

/// What a column is made of. Numbers without a name of their own are places in a record.
pub(crate) enum Source<'a> {
    /// x, y and z as they are.
    Numbers,
    /// x, y and z, `value = scale · number + offset`.
    Position { scale: [f64; 3], offset: [f64; 3] },
    /// `(byte >> shift) & mask`.
    Bits { place: usize, shift: u32, mask: u8 },
    /// A whole number of 16 bits.
    Word(usize),
    /// A double.
    Double(usize),
    /// Degrees in a byte.
    Degrees(usize),
    /// Steps of 0.006 degrees.
    Steps(usize),
    /// Three components of 16 bits, of which the bytes nearest to them are kept.
    ColourWords(usize),
    /// Three components of 16 bits, of which only the lower byte is used.
    ColourBytes(usize),
    /// Three components of 16 bits as they are.
    Components(usize),
    /// A value of the extra bytes, which begin there.
    Extra { extra: &'a Extra, first: usize },
}

/// Records of a run.
trait Rows {
    /// `N` bytes of each record, from `place` on; a record that ends before them ends all.
    fn fields<const N: usize>(&self, place: usize) -> impl Iterator<Item = &[u8; N]>;

    /// The bytes, and how many of them are a record.
    fn bytes(&self) -> (&[u8], usize);
}

/// Records of `S` bytes.
struct Fixed<'a, const S: usize>(&'a [u8]);

impl<const S: usize> Rows for Fixed<'_, S> {
    #[inline]
    fn fields<const N: usize>(&self, place: usize) -> impl Iterator<Item = &[u8; N]> {
        let records = self.0.as_chunks::<S>().0.iter();
        records.map_while(move |record| record.get(place..)?.first_chunk())
    }

    fn bytes(&self) -> (&[u8], usize) {
        (self.0, S)
    }
}

/// Records of any length.
struct Any<'a> {
    records: &'a [u8],
    stride: usize,
}

impl Rows for Any<'_> {
    #[inline]
    fn fields<const N: usize>(&self, place: usize) -> impl Iterator<Item = &[u8; N]> {
        fields(self.records, place, self.stride)
    }

    fn bytes(&self) -> (&[u8], usize) {
        (self.records, self.stride)
    }
}

impl Source<'_> {
    /// The values of records of so many bytes into `out`, native byte order.
    pub(crate) fn write(&self, records: &[u8], stride: usize, out: &mut [u8]) {
        // Loops over records of a known length are three times as fast; these are those of the formats without waveforms and
        // extra bytes.
        match stride {
            20 => self.write_rows(&Fixed::<20>(records), out),
            26 => self.write_rows(&Fixed::<26>(records), out),
            28 => self.write_rows(&Fixed::<28>(records), out),
            30 => self.write_rows(&Fixed::<30>(records), out),
            34 => self.write_rows(&Fixed::<34>(records), out),
            36 => self.write_rows(&Fixed::<36>(records), out),
            38 => self.write_rows(&Fixed::<38>(records), out),
            _ => self.write_rows(&Any { records, stride }, out),
        }
    }

    fn write_rows(&self, records: &impl Rows, out: &mut [u8]) {
        match *self {
            Self::Numbers => convert(records, 0, out, |bytes: [u8; 12]| {
                let [x, y, z] = numbers(bytes).map(i32::to_ne_bytes);
                [
                    x[0], x[1], x[2], x[3], y[0], y[1], y[2], y[3], z[0], z[1], z[2], z[3],
                ]
            }),
            Self::Position { scale, offset } => {
                let rows = records.fields::<12>(0);
                for (bytes, out) in rows.zip(out.as_chunks_mut::<24>().0) {
                    let numbers = numbers(*bytes);
                    for (axis, out) in out.as_chunks_mut::<8>().0.iter_mut().enumerate() {
                        let number = f64::from(numbers[axis]);
                        *out = (scale[axis] * number + offset[axis]).to_ne_bytes();
                    }
                }
            }
            Self::Bits { place, shift, mask } => {
                convert(records, place, out, |[byte]| [(byte >> shift) & mask]);
            }
            Self::Word(place) => convert(records, place, out, |bytes| {
                u16::from_le_bytes(bytes).to_ne_bytes()
            }),
            Self::Double(place) => convert(records, place, out, |bytes| {
                f64::from_le_bytes(bytes).to_ne_bytes()
            }),
            Self::Degrees(place) => convert(records, place, out, |[byte]| {
                f32::from(byte as i8).to_ne_bytes()
            }),
            Self::Steps(place) => convert(records, place, out, |bytes| {
                (f32::from(i16::from_le_bytes(bytes)) * 0.006).to_ne_bytes()
            }),
            Self::ColourWords(place) => {
                convert(records, place, out, |bytes| words(bytes).map(nearest_byte));
            }
            Self::ColourBytes(place) => convert(records, place, out, |bytes| {
                words(bytes).map(|value| value as u8)
            }),
            Self::Components(place) => convert(records, place, out, |bytes| {
                let [r, g, b] = words(bytes).map(u16::to_ne_bytes);
                [r[0], r[1], g[0], g[1], b[0], b[1]]
            }),
            Self::Extra { extra, first } => {
                let (bytes, stride) = records.bytes();
                extra.write(bytes, stride, first, out);
            }
        }
    }
}

/// `FROM` bytes of each record, from `place` on, as `TO` bytes of `out`.
#[inline]
fn convert<const FROM: usize, const TO: usize>(
    records: &impl Rows,
    place: usize,
    out: &mut [u8],
    value: impl Fn([u8; FROM]) -> [u8; TO],
) {
    for (bytes, out) in records.fields(place).zip(out.as_chunks_mut().0) {
        *out = value(*bytes);
    }
}

/// `N` bytes of each record, from `place` on; a record that ends before them ends all.
#[inline]
pub(crate) fn fields<const N: usize>(
    records: &[u8],
    place: usize,
    stride: usize,
) -> impl Iterator<Item = &[u8; N]> {
    let own = records.get(place..).unwrap_or_default();
    own.chunks(stride).map_while(<[u8]>::first_chunk)
}

/// The numbers of a position.
#[inline]
fn numbers(bytes: [u8; 12]) -> [i32; 3] {
    let numbers = bytes.as_chunks::<4>().0;
    std::array::from_fn(|index| i32::from_le_bytes(numbers[index]))
}

/// Of 16 bits the byte of the nearest colour, as 65535 = 257 · 255.
#[inline]
pub(crate) fn nearest_byte(value: u16) -> u8 {
    ((u32::from(value) + 128) / 257) as u8
}

/// The components of a colour.
#[inline]
pub(crate) fn words(bytes: [u8; 6]) -> [u16; 3] {
    let words = bytes.as_chunks::<2>().0;
    std::array::from_fn(|index| u16::from_le_bytes(words[index]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_byte_of_a_colour_is_the_nearest() {
        for value in 0..=u16::MAX {
            let exact = f64::from(value) / 257.0;
            assert_eq!(nearest_byte(value), exact.round() as u8, "{value}");
        }
    }

    #[test]
    fn records_of_known_length_are_read_as_any_are() {
        fn check<const S: usize>() {
            let records: Vec<u8> = (0..100 * S).map(|index| (index * 37 % 251) as u8).collect();
            let any = Any {
                records: &records,
                stride: S,
            };
            let position = Source::Position {
                scale: [0.5, -0.25, 3.0],
                offset: [1.0, 2.0, 1e6],
            };
            let bits = Source::Bits {
                place: 14,
                shift: 3,
                mask: 7,
            };
            let last = S - 6;
            for (source, width) in [
                (Source::Numbers, 12),
                (position, 24),
                (bits, 1),
                (Source::Word(12), 2),
                (Source::Double(last - 2), 8),
                (Source::Degrees(16), 4),
                (Source::Steps(18), 4),
                (Source::ColourWords(last), 3),
                (Source::ColourBytes(last), 3),
                (Source::Components(last), 6),
            ] {
                let (mut fixed, mut expected) = (vec![0; 100 * width], vec![0; 100 * width]);
                source.write(&records, S, &mut fixed);
                source.write_rows(&any, &mut expected);
                assert_eq!(fixed, expected, "{S}, width {width}");
                assert!(expected.iter().any(|byte| *byte != 0), "{S}, width {width}");
            }
        }
        check::<20>();
        check::<26>();
        check::<28>();
        check::<30>();
        check::<34>();
        check::<36>();
        check::<38>();
    }
}
