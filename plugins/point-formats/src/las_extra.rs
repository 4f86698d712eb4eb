//! Extra bytes of LAS points: what the file's own description says of them (LAS 1.4, *Extra Bytes* record).

use std::sync::atomic::{AtomicU64, Ordering};

use las::Header;
use pointstage_plugin_api::abi::ScalarType;
use pointstage_plugin_api::loading::{Column, Output};

/// Bytes of one description.
const DESCRIPTION: usize = 192;

/// Bits of a description's options.
const HAS_SCALE: u8 = 8;
const HAS_OFFSET: u8 = 16;

/// Values behind each point, described by the file.
#[derive(Debug)]
pub(crate) struct Extra {
    pub(crate) name: String,
    kind: Kind,
    components: usize,
    /// Bytes before it, from the first extra byte on.
    offset: usize,
    /// What makes values of the stored numbers, if they are not the values themselves.
    measure: Option<Measure>,
    /// Whole numbers read so far that no double holds exactly.
    rounded: AtomicU64,
}

/// `value = number · scale + offset`, component by component.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Measure {
    scale: [f64; 3],
    offset: [f64; 3],
}

/// Type of a stored number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F32,
    F64,
}

impl Kind {
    const ALL: [Self; 10] = [
        Self::U8,
        Self::I8,
        Self::U16,
        Self::I16,
        Self::U32,
        Self::I32,
        Self::U64,
        Self::I64,
        Self::F32,
        Self::F64,
    ];

    /// Type and components of a type's number in the file: single values, then those of two and three components, which LAS 1.4
    /// no longer has.
    fn of(number: u8) -> Option<(Self, usize)> {
        let number = usize::from(number.checked_sub(1)?);
        let components = number / Self::ALL.len() + 1;
        (components <= 3).then(|| (Self::ALL[number % Self::ALL.len()], components))
    }

    const fn size(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }

    /// The column's type; whole numbers of 64 bits have none and are kept as doubles, which are exact up to 2⁵³: what is rounded
    /// beyond that is a warning.
    const fn scalar(self) -> ScalarType {
        match self {
            Self::U8 => ScalarType::U8,
            Self::I8 => ScalarType::I8,
            Self::U16 => ScalarType::U16,
            Self::I16 => ScalarType::I16,
            Self::U32 => ScalarType::U32,
            Self::I32 => ScalarType::I32,
            Self::F32 => ScalarType::F32,
            Self::U64 | Self::I64 | Self::F64 => ScalarType::F64,
        }
    }

    /// A number from its bytes, of which there are as many as it has.
    fn number(self, bytes: &[u8]) -> f64 {
        macro_rules! read {
            ($type:ty) => {
                <$type>::from_le_bytes(bytes.first_chunk().copied().unwrap_or_default())
            };
        }
        match self {
            Self::U8 => f64::from(read!(u8)),
            Self::I8 => f64::from(read!(i8)),
            Self::U16 => f64::from(read!(u16)),
            Self::I16 => f64::from(read!(i16)),
            Self::U32 => f64::from(read!(u32)),
            Self::I32 => f64::from(read!(i32)),
            Self::U64 => read!(u64) as f64,
            Self::I64 => read!(i64) as f64,
            Self::F32 => f64::from(read!(f32)),
            Self::F64 => read!(f64),
        }
    }
}

/// The values that a file describes, and how many of its extra bytes it does not.
pub(crate) fn described(header: &Header) -> (Vec<Extra>, usize) {
    let length = usize::from(header.point_format().extra_bytes);
    let description = header.all_vlrs().find(|record| {
        record.user_id.trim_end_matches('\0') == "LASF_Spec" && record.record_id == 4
    });
    let bytes = description.map_or(&[][..], |record| &record.data);
    read(bytes, length)
}

fn read(descriptions: &[u8], length: usize) -> (Vec<Extra>, usize) {
    let mut found: Vec<Extra> = Vec::new();
    let (mut offset, mut undescribed) = (0, 0);
    for record in descriptions.as_chunks::<DESCRIPTION>().0 {
        let (number, options) = (record[2], record[3]);
        let Some((kind, components)) = Kind::of(number) else {
            // Of type 0 the options are a number of bytes without a meaning; other types are not of this standard, and
            // nobody knows where the next value begins.
            if number == 0 {
                undescribed += usize::from(options).min(length.saturating_sub(offset));
                offset += usize::from(options);
                continue;
            }
            break;
        };
        if offset + kind.size() * components > length {
            break;
        }
        let name = record[4..36].split(|byte| *byte == 0).next();
        let name = String::from_utf8_lossy(name.unwrap_or_default());
        let name = match name.trim() {
            "" => format!("extra_{}", found.len()),
            name => name.to_owned(),
        };
        let doubles = |at: usize| {
            let bytes = &record[at..at + 24];
            std::array::from_fn(|index| Kind::F64.number(&bytes[8 * index..]))
        };
        let measure = (options & (HAS_SCALE | HAS_OFFSET) != 0).then(|| Measure {
            scale: if options & HAS_SCALE == 0 {
                [1.0; 3]
            } else {
                doubles(112)
            },
            offset: if options & HAS_OFFSET == 0 {
                [0.0; 3]
            } else {
                doubles(136)
            },
        });
        found.push(Extra {
            name,
            kind,
            components,
            offset,
            measure,
            rounded: AtomicU64::new(0),
        });
        offset += kind.size() * components;
    }
    (found, undescribed + length.saturating_sub(offset))
}

impl Extra {
    pub(crate) fn column(&self) -> Column<'_> {
        let scalar = if self.measure.is_some() {
            ScalarType::F64
        } else {
            self.kind.scalar()
        };
        Column::named(&self.name, scalar, self.components as u32)
    }

    /// Bytes that it takes in its column, a point.
    pub(crate) fn width(&self) -> usize {
        let size = if self.measure.is_some() {
            size_of::<f64>()
        } else {
            self.kind.size()
        };
        size * self.components
    }

    /// Its values of some points, native byte order, into `out`: [`Self::width`] bytes a point. The records are `stride` bytes
    /// long each, and their extra bytes begin at `first`.
    pub(crate) fn write(&self, records: &[u8], stride: usize, first: usize, out: &mut [u8]) {
        let size = self.kind.size();
        let own = records.get(first + self.offset..).unwrap_or_default();
        self.count_rounded(own, stride);
        for (record, out) in own.chunks(stride).zip(out.chunks_exact_mut(self.width())) {
            let values = out.chunks_exact_mut(out.len() / self.components);
            for (component, (bytes, out)) in record.chunks_exact(size).zip(values).enumerate() {
                self.write_one(component, bytes, out);
            }
        }
    }

    /// Counts the numbers that become others as doubles, in records that begin with the first component.
    fn count_rounded(&self, records: &[u8], stride: usize) {
        let is_exact = match self.kind {
            Kind::U64 => |bytes| {
                let number = u64::from_le_bytes(bytes);
                number as f64 as u128 == u128::from(number)
            },
            Kind::I64 => |bytes| {
                let number = i64::from_le_bytes(bytes);
                number as f64 as i128 == i128::from(number)
            },
            _ => return,
        };
        let numbers = records.chunks(stride).flat_map(|record| {
            let numbers = record.as_chunks::<8>().0;
            numbers.iter().take(self.components).copied()
        });
        let rounded = numbers.filter(|bytes| !is_exact(*bytes)).count();
        self.rounded.fetch_add(rounded as u64, Ordering::Relaxed);
    }

    /// Warns if numbers that were written are not those of the file.
    pub(crate) fn warn_of_rounded(&self, out: &mut Output<'_>) {
        let text = format!(
            "a 64-bit whole number of column '{}' is rounded to the nearest of 53 bits",
            self.name
        );
        out.warn(&text, self.rounded.load(Ordering::Relaxed));
    }

    fn write_one(&self, component: usize, bytes: &[u8], out: &mut [u8]) {
        let is_wide = matches!(self.kind, Kind::U64 | Kind::I64);
        if self.measure.is_some() || is_wide {
            let number = self.kind.number(bytes);
            let value = self.measure.map_or(number, |measure| {
                number * measure.scale[component] + measure.offset[component]
            });
            out.copy_from_slice(&value.to_ne_bytes());
            return;
        }
        out.copy_from_slice(bytes);
        if cfg!(target_endian = "big") {
            out.reverse();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn description(number: u8, options: u8, name: &str) -> [u8; DESCRIPTION] {
        let mut record = [0; DESCRIPTION];
        record[2] = number;
        record[3] = options;
        record[4..4 + name.len()].copy_from_slice(name.as_bytes());
        record[112..120].copy_from_slice(&0.5_f64.to_le_bytes());
        record[136..144].copy_from_slice(&100.0_f64.to_le_bytes());
        record
    }

    #[test]
    fn descriptions_say_type_place_and_measure() {
        let all = [
            description(3, 0, "amplitude"),
            description(0, 3, "secret"),
            description(4, HAS_SCALE | HAS_OFFSET, "height"),
            description(29, 0, ""),
        ]
        .concat();
        let (found, undescribed) = read(&all, 2 + 3 + 2 + 12 + 5);
        assert_eq!(undescribed, 3 + 5);
        let facts: Vec<(&str, usize, usize)> = found
            .iter()
            .map(|extra| (extra.name.as_str(), extra.offset, extra.components))
            .collect();
        assert_eq!(
            facts,
            [("amplitude", 0, 1), ("height", 5, 1), ("extra_2", 7, 3)]
        );
        // Records of the five extra bytes before the value and its own two, behind one byte of something else.
        let mut records = [0; 16];
        records[6..8].copy_from_slice(&(-3_i16).to_le_bytes());
        records[14..16].copy_from_slice(&8_i16.to_le_bytes());
        let mut values = [0; 16];
        found[1].write(&records, 8, 1, &mut values);
        let expected = [98.5_f64.to_ne_bytes(), 104.0_f64.to_ne_bytes()].concat();
        assert_eq!(values[..], expected);
        let mut values = [0; 4];
        found[0].write(&[9, 1, 2, 0, 0, 0, 0, 0, 9, 3, 4], 8, 1, &mut values);
        assert_eq!(values, [1, 2, 3, 4]);
    }

    #[test]
    fn descriptions_that_do_not_fit_are_not_believed() {
        let (found, undescribed) = read(&description(10, 0, "time"), 4);
        assert_eq!((found.len(), undescribed), (0, 4));
        let (found, undescribed) = read(&description(77, 0, "new"), 4);
        assert_eq!((found.len(), undescribed), (0, 4));
        assert_eq!(read(&description(0, 200, ""), 7).1, 7);
        let (found, undescribed) = read(&[1; 100], 7);
        assert_eq!((found.len(), undescribed), (0, 7));
    }

    #[test]
    fn whole_numbers_that_doubles_do_not_hold_are_counted() {
        let count_of = |number: u8, values: &[[u8; 8]]| {
            let (found, _) = read(&description(number, 0, "id"), 8);
            let records: Vec<u8> = values
                .iter()
                .flat_map(|value| [&[7], &value[..]].concat())
                .collect();
            let mut out = vec![0; 8 * values.len()];
            found[0].write(&records, 9, 1, &mut out);
            found[0].rounded.load(Ordering::Relaxed)
        };
        let unsigned = [0, 1 << 53, (1 << 53) + 1, (1 << 53) + 2, u64::MAX];
        assert_eq!(count_of(7, &unsigned.map(u64::to_le_bytes)), 2);
        let signed = [-1, -(1 << 53), -(1 << 53) - 1, i64::MIN, i64::MAX];
        assert_eq!(count_of(8, &signed.map(i64::to_le_bytes)), 2);
        assert_eq!(count_of(10, &[f64::MAX.to_le_bytes()]), 0);
    }
}
