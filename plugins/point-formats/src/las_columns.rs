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
    /// Three components of 16 bits.
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
    pub(crate) fn new(header: &Header, colours: Colours, extras: &'a [Extra]) -> Self {
        let layout = Layout::of(header);
        let transforms = header.transforms();
        let axes = [&transforms.x, &transforms.y, &transforms.z];
        let mut parts = vec![Part {
            column: Column::POSITION_F64,
            source: Source::Position {
                scale: axes.map(|axis| axis.scale),
                offset: axes.map(|axis| axis.offset),
            },
            width: 24,
        }];
        parts.extend(always(layout.is_extended));
        match (colours, layout.colour) {
            (Colours::Bytes, Some(place)) => parts.push(Part {
                column: Column::RGB_U8,
                source: Source::ColourBytes(place),
                width: 3,
            }),
            (Colours::Words, Some(place)) => parts.push(Part {
                column: Column::RGB_U16,
                source: Source::ColourWords(place),
                width: 6,
            }),
            _ => {}
        }
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
                part.source.write(records, self.stride, out);
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

impl Source<'_> {
    /// The values of records of `stride` bytes into `out`, native byte order.
    fn write(&self, records: &[u8], stride: usize, out: &mut [u8]) {
        match *self {
            Self::Position { scale, offset } => {
                let numbers = fields::<12>(records, 0, stride);
                for (bytes, out) in numbers.zip(out.as_chunks_mut::<24>().0) {
                    let numbers = bytes.as_chunks::<4>().0;
                    for (axis, out) in out.as_chunks_mut::<8>().0.iter_mut().enumerate() {
                        let number = f64::from(i32::from_le_bytes(numbers[axis]));
                        *out = (scale[axis] * number + offset[axis]).to_ne_bytes();
                    }
                }
            }
            Self::Bits { place, shift, mask } => convert(records, place, stride, out, |[byte]| {
                [(byte >> shift) & mask]
            }),
            Self::Word(place) => convert(records, place, stride, out, |bytes| {
                u16::from_le_bytes(bytes).to_ne_bytes()
            }),
            Self::Double(place) => convert(records, place, stride, out, |bytes| {
                f64::from_le_bytes(bytes).to_ne_bytes()
            }),
            Self::Degrees(place) => convert(records, place, stride, out, |[byte]| {
                f32::from(byte as i8).to_ne_bytes()
            }),
            Self::Steps(place) => convert(records, place, stride, out, |bytes| {
                (f32::from(i16::from_le_bytes(bytes)) * 0.006).to_ne_bytes()
            }),
            Self::ColourWords(place) => convert(records, place, stride, out, |bytes| {
                let [red, green, blue] = words(bytes).map(u16::to_ne_bytes);
                [red[0], red[1], green[0], green[1], blue[0], blue[1]]
            }),
            Self::ColourBytes(place) => convert(records, place, stride, out, |bytes| {
                words(bytes).map(|value| value as u8)
            }),
            Self::Extra { extra, first } => extra.write(records, stride, first, out),
        }
    }
}

/// `FROM` bytes of each record, from `place` on, as `TO` bytes of `out`.
#[inline]
fn convert<const FROM: usize, const TO: usize>(
    records: &[u8],
    place: usize,
    stride: usize,
    out: &mut [u8],
    value: impl Fn([u8; FROM]) -> [u8; TO],
) {
    for (bytes, out) in fields(records, place, stride).zip(out.as_chunks_mut().0) {
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

/// The components of a colour.
#[inline]
fn words(bytes: [u8; 6]) -> [u16; 3] {
    let words = bytes.as_chunks::<2>().0;
    std::array::from_fn(|index| u16::from_le_bytes(words[index]))
}
