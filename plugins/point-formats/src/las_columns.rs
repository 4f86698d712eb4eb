//! Records of LAS points into columns: what is where in each point format, and how it is kept.

use las::Header;
use pointstage_plugin_api::abi::ScalarType;
use pointstage_plugin_api::loading::Column;
use rayon::prelude::*;

use crate::las_extra::Extra;

/// Records that one thread takes apart at a time: few enough that they stay in its cache while column after column is
/// taken from them.
const PIECE: usize = 2048;

/// Names of columns that every file has, then those of some.
pub(crate) const NAMES: [&str; 9] = [
    "intensity",
    "classification",
    "return_number",
    "number_of_returns",
    "point_source_id",
    "user_data",
    "scan_angle",
    "gps_time",
    "near_infrared",
];

/// How colours are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Colours {
    /// All are black.
    None,
    /// Some programs keep bytes where 16 bits are due.
    Bytes,
    Words,
}

impl Colours {
    /// By the largest component of all.
    pub(crate) fn of(largest: u16) -> Self {
        match largest {
            0 => Self::None,
            1..=255 => Self::Bytes,
            _ => Self::Words,
        }
    }
}

/// Where the parts of a record are that not all formats have, or not in one place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Layout {
    /// Bytes of a record.
    pub(crate) stride: usize,
    /// Whether it is one of the formats from 6 on.
    is_extended: bool,
    time: Option<usize>,
    pub(crate) colour: Option<usize>,
    infrared: Option<usize>,
    /// First of the extra bytes.
    extra: usize,
}

impl Layout {
    pub(crate) fn of(header: &Header) -> Self {
        let format = header.point_format();
        let mut end = if format.is_extended { 22 } else { 20 };
        let mut place = |is_there: bool, bytes: usize| {
            let start = end;
            end += if is_there { bytes } else { 0 };
            is_there.then_some(start)
        };
        let time = place(format.has_gps_time, 8);
        let colour = place(format.has_color, 6);
        let infrared = place(format.has_nir, 2);
        place(format.has_waveform, 29);
        Self {
            stride: usize::from(format.len()),
            is_extended: format.is_extended,
            time,
            colour,
            infrared,
            extra: end,
        }
    }

    /// The largest component of all colours; 0 if there are none. What is above 255 is not looked beyond.
    pub(crate) fn largest_colour(&self, records: &[u8]) -> u16 {
        let Some(place) = self.colour else { return 0 };
        let of_piece = |records: &[u8]| {
            fields::<6>(records, place, self.stride)
                .map(|bytes| words(*bytes).into_iter().max().unwrap_or_default())
                .max()
                .unwrap_or_default()
        };
        // Runs of pieces, so that what is above 255 at the start spares the rest.
        let mut largest = 0;
        for run in records.chunks(16 * PIECE * self.stride) {
            let pieces = run.par_chunks(PIECE * self.stride).map(of_piece);
            largest = largest.max(pieces.max().unwrap_or_default());
            if largest > 255 {
                break;
            }
        }
        largest
    }
}

/// A column, and how it is made of records.
struct Part<'a> {
    column: Column<'a>,
    source: Source<'a>,
    /// Bytes a point.
    width: usize,
}

/// What a column is made of. Numbers without a name of their own are places in a record.
enum Source<'a> {
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
    /// A value of the extra bytes, which begin there.
    Extra { extra: &'a Extra, first: usize },
}

/// The columns that a file has.
pub(crate) struct Plan<'a> {
    stride: usize,
    parts: Vec<Part<'a>>,
}

impl<'a> Plan<'a> {
    /// Of a host that knows what the numbers of positions stand for (`knows_scale`) or must be told values.
    pub(crate) fn new(
        header: &Header,
        knows_scale: bool,
        colours: Colours,
        extras: &'a [Extra],
    ) -> Self {
        let layout = Layout::of(header);
        let mut parts = vec![if knows_scale {
            Part {
                column: Column::POSITION_I32,
                source: Source::Numbers,
                width: 12,
            }
        } else {
            let (scale, offset) = scale_of(header);
            Part {
                column: Column::POSITION_F64,
                source: Source::Position { scale, offset },
                width: 24,
            }
        }];
        parts.extend(always(layout.is_extended));
        let colour = layout.colour.and_then(|place| match colours {
            Colours::None => None,
            Colours::Bytes => Some(Source::ColourBytes(place)),
            Colours::Words => Some(Source::ColourWords(place)),
        });
        parts.extend(colour.map(|source| Part {
            column: Column::RGB_U8,
            source,
            width: 3,
        }));
        if let Some(place) = layout.time {
            parts.push(Part::named(
                NAMES[7],
                ScalarType::F64,
                Source::Double(place),
            ));
        }
        if let Some(place) = layout.infrared {
            parts.push(Part::named(NAMES[8], ScalarType::U16, Source::Word(place)));
        }
        parts.extend(extras.iter().map(|extra| Part {
            column: extra.column(),
            width: extra.width(),
            source: Source::Extra {
                extra,
                first: layout.extra,
            },
        }));
        Self {
            stride: layout.stride,
            parts,
        }
    }

    /// The columns, in the order of [`Self::fill`].
    pub(crate) fn columns(&self) -> Vec<Column<'a>> {
        self.parts.iter().map(|part| part.column).collect()
    }

    /// Takes whole records apart, on all cores: the bytes of each column replace those that were there.
    pub(crate) fn fill(&self, records: &[u8], columns: &mut Vec<Vec<u8>>) {
        let count = records.len() / self.stride;
        columns.resize_with(self.parts.len(), Vec::new);
        let pieces = records.par_chunks(PIECE * self.stride);
        let mut slots: Vec<Vec<&mut [u8]>> = Vec::with_capacity(pieces.len());
        slots.resize_with(pieces.len(), || Vec::with_capacity(self.parts.len()));
        for (part, column) in self.parts.iter().zip(columns) {
            column.resize(count * part.width, 0);
            let of_column = column.chunks_mut(PIECE * part.width);
            for (slots, bytes) in slots.iter_mut().zip(of_column) {
                slots.push(bytes);
            }
        }
        pieces.zip(slots).for_each(|(records, slots)| {
            for (part, out) in self.parts.iter().zip(slots) {
                // Loops over records of a known length are three times as fast; these are those of the formats without
                // waveforms and extra bytes.
                match self.stride {
                    20 => part.source.write(&Fixed::<20>(records), out),
                    26 => part.source.write(&Fixed::<26>(records), out),
                    28 => part.source.write(&Fixed::<28>(records), out),
                    30 => part.source.write(&Fixed::<30>(records), out),
                    34 => part.source.write(&Fixed::<34>(records), out),
                    36 => part.source.write(&Fixed::<36>(records), out),
                    38 => part.source.write(&Fixed::<38>(records), out),
                    stride => part.source.write(&Any { records, stride }, out),
                }
            }
        });
    }
}

/// The columns of every file but the positions.
fn always(is_extended: bool) -> [Part<'static>; 7] {
    let bits = |name, place, shift, mask| {
        Part::named(name, ScalarType::U8, Source::Bits { place, shift, mask })
    };
    let word = |name, place| Part::named(name, ScalarType::U16, Source::Word(place));
    let angle = |source| Part::named(NAMES[6], ScalarType::F32, source);
    if is_extended {
        [
            word(NAMES[0], 12),
            bits(NAMES[1], 16, 0, 255),
            bits(NAMES[2], 14, 0, 15),
            bits(NAMES[3], 14, 4, 15),
            word(NAMES[4], 20),
            bits(NAMES[5], 17, 0, 255),
            angle(Source::Steps(18)),
        ]
    } else {
        [
            word(NAMES[0], 12),
            bits(NAMES[1], 15, 0, 31),
            bits(NAMES[2], 14, 0, 7),
            bits(NAMES[3], 14, 3, 7),
            word(NAMES[4], 18),
            bits(NAMES[5], 17, 0, 255),
            angle(Source::Degrees(16)),
        ]
    }
}

impl Part<'static> {
    fn named(name: &'static str, scalar: ScalarType, source: Source<'static>) -> Self {
        let width = match scalar {
            ScalarType::U8 => 1,
            ScalarType::U16 => 2,
            ScalarType::F32 => 4,
            _ => 8,
        };
        Self {
            column: Column::named(name, scalar, 1),
            source,
            width,
        }
    }
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
    /// The values of records into `out`, native byte order.
    fn write(&self, records: &impl Rows, out: &mut [u8]) {
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
fn fields<const N: usize>(
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
fn nearest_byte(value: u16) -> u8 {
    ((u32::from(value) + 128) / 257) as u8
}

/// Scale and offset of the positions.
pub(crate) fn scale_of(header: &Header) -> ([f64; 3], [f64; 3]) {
    let transforms = header.transforms();
    let axes = [&transforms.x, &transforms.y, &transforms.z];
    (axes.map(|axis| axis.scale), axes.map(|axis| axis.offset))
}

/// The components of a colour.
#[inline]
fn words(bytes: [u8; 6]) -> [u16; 3] {
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
            ] {
                let (mut fixed, mut expected) = (vec![0; 100 * width], vec![0; 100 * width]);
                source.write(&Fixed::<S>(&records), &mut fixed);
                source.write(&any, &mut expected);
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
