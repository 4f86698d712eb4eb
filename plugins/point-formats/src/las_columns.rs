//! Records of LAS points into columns: what is where in each point format, and how it is kept.

use las::Header;
use pointstage_plugin_api::abi::ScalarType;
use pointstage_plugin_api::loading::Column;
use rayon::prelude::*;

use crate::las_extra::Extra;
use crate::las_rows::{Source, fields, nearest_byte, words};

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

/// How colours are kept; the later ones fit larger components.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
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

    /// Components of 16 bits, native byte order, as bytes in place of what `bytes` holds.
    pub(crate) fn bytes_of(self, components: &[u8], bytes: &mut Vec<u8>) {
        let components = components.as_chunks().0.iter();
        let components = components.map(|component| u16::from_ne_bytes(*component));
        bytes.clear();
        match self {
            Self::None => {}
            Self::Bytes => bytes.extend(components.map(|component| component as u8)),
            Self::Words => bytes.extend(components.map(nearest_byte)),
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

/// The columns that a file has.
pub(crate) struct Plan<'a> {
    stride: usize,
    parts: Vec<Part<'a>>,
    /// Number of the part that colours are.
    colour: Option<usize>,
}

impl<'a> Plan<'a> {
    /// Of a host that knows what the numbers of positions stand for (`knows_scale`) or must be told values. Colours that are not
    /// known to be bytes or words yet stay components of 16 bits, of which [`Colours::bytes_of`] makes bytes.
    pub(crate) fn new(
        header: &Header,
        knows_scale: bool,
        colours: Option<Colours>,
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
            Some(Colours::None) => None,
            Some(Colours::Bytes) => Some((Source::ColourBytes(place), 3)),
            Some(Colours::Words) => Some((Source::ColourWords(place), 3)),
            None => Some((Source::Components(place), 6)),
        });
        let colour = colour.map(|(source, width)| {
            parts.push(Part {
                column: Column::RGB_U8,
                source,
                width,
            });
            parts.len() - 1
        });
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
            colour,
        }
    }

    /// The columns, in the order of [`Self::fill`].
    pub(crate) fn columns(&self) -> Vec<Column<'a>> {
        self.parts.iter().map(|part| part.column).collect()
    }

    /// Number of the column of colours, if there is one.
    pub(crate) fn colour(&self) -> Option<usize> {
        self.colour
    }

    /// Bytes of a record.
    pub(crate) fn stride(&self) -> usize {
        self.stride
    }

    /// Bytes that each column has a point, in the order of [`Self::fill`].
    pub(crate) fn widths(&self) -> impl Iterator<Item = usize> {
        self.parts.iter().map(|part| part.width)
    }

    /// Takes whole records apart, into the places of theirs in each column.
    pub(crate) fn take_apart<'s>(
        &self,
        records: &[u8],
        slots: impl IntoIterator<Item = &'s mut [u8]>,
    ) {
        for (part, out) in self.parts.iter().zip(slots) {
            part.source.write(records, self.stride, out);
        }
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
        pieces
            .zip(slots)
            .for_each(|(records, slots)| self.take_apart(records, slots));
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

/// Scale and offset of the positions.
pub(crate) fn scale_of(header: &Header) -> ([f64; 3], [f64; 3]) {
    let transforms = header.transforms();
    let axes = [&transforms.x, &transforms.y, &transforms.z];
    (axes.map(|axis| axis.scale), axes.map(|axis| axis.offset))
}
