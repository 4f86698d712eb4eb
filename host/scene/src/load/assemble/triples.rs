//! Three numbers of each row that lie side by side, as positions mostly do: read at once.

use std::ops::Range;

use glam::{DVec3, IVec3, Vec3};

use super::table::{ByteOrder, Field};
use crate::geometry::ScalarType;

/// Fields of one table that follow each other.
#[derive(Clone, Copy, Debug)]
pub(in crate::load) struct Triples<'t> {
    /// The table from the first field's first value on.
    bytes: &'t [u8],
    stride: usize,
    scalar: ScalarType,
    /// Scale and offset that make values of the numbers.
    scaled: Option<(DVec3, DVec3)>,
}

impl<'t> Triples<'t> {
    /// Of three fields; `None` if they do not follow each other, or are of types that positions seldom have, or of a foreign
    /// byte order.
    pub(in crate::load) fn of(fields: [Field<'t>; 3]) -> Option<Self> {
        let [first, ..] = fields;
        let is_usual = matches!(
            first.scalar,
            ScalarType::I32 | ScalarType::F32 | ScalarType::F64
        );
        if !is_usual || first.order != ByteOrder::NATIVE {
            return None;
        }
        for pair in fields.windows(2) {
            let next = pair[0].bytes.get(first.scalar.size()..)?;
            let is_next = std::ptr::eq(next, pair[1].bytes)
                && (pair[1].scalar, pair[1].stride) == (first.scalar, first.stride);
            if !is_next {
                return None;
            }
        }
        let scales = fields.map(|field| field.scaled);
        let scaled = match scales {
            [Some(x), Some(y), Some(z)] => {
                Some((DVec3::new(x.0, y.0, z.0), DVec3::new(x.1, y.1, z.1)))
            }
            [None, None, None] => None,
            _ => return None,
        };
        Some(Self {
            bytes: first.bytes,
            stride: first.stride,
            scalar: first.scalar,
            scaled,
        })
    }

    /// Calls `each` with the values of every row of `range` and its slot, in order.
    #[inline]
    pub(in crate::load) fn each<T>(
        &self,
        range: &Range<usize>,
        slots: &mut [T],
        mut each: impl FnMut(DVec3, &mut T),
    ) {
        let bytes = &self.bytes[range.start * self.stride..];
        // The last row ends with the table.
        let rows = bytes.chunks(self.stride).zip(slots);
        let scale = |numbers: DVec3| {
            self.scaled
                .map_or(numbers, |(scale, offset)| scale * numbers + offset)
        };
        match self.scalar {
            ScalarType::I32 => rows.for_each(|(row, slot)| {
                let numbers = IVec3::from_array(three(row, i32::from_ne_bytes));
                each(scale(numbers.as_dvec3()), slot);
            }),
            ScalarType::F32 => rows.for_each(|(row, slot)| {
                let numbers = Vec3::from_array(three(row, f32::from_ne_bytes));
                each(scale(numbers.as_dvec3()), slot);
            }),
            _ => rows.for_each(|(row, slot)| {
                each(
                    scale(DVec3::from_array(three(row, f64::from_ne_bytes))),
                    slot,
                );
            }),
        }
    }
}

/// The first three values of a row, which holds them.
#[inline]
fn three<T, const SIZE: usize>(row: &[u8], value: impl Fn([u8; SIZE]) -> T) -> [T; 3] {
    let bytes = row.as_chunks::<SIZE>().0;
    std::array::from_fn(|index| value(bytes[index]))
}

#[cfg(test)]
mod tests {
    use super::super::table::{Piece, RowSelection, Table, TableColumn};
    use super::*;

    /// Rows of 31 bytes, with the numbers at byte 5.
    fn table(scalar: ScalarType, order: ByteOrder, gap: usize) -> Table<'static> {
        let bytes: Vec<u8> = (0..31 * 9_usize)
            .map(|index| (index * 37 % 251) as u8)
            .collect();
        let column = |axis: usize| TableColumn {
            name: String::new(),
            scalar,
            offset: 5 + axis * (scalar.size() + gap),
        };
        Table {
            bytes: bytes.into(),
            stride: 31,
            rows: 9,
            order,
            columns: (0..3).map(column).collect(),
        }
    }

    fn fields<'t>(table: &'t Table<'_>) -> [Field<'t>; 3] {
        std::array::from_fn(|axis| table.field(axis))
    }

    #[test]
    fn values_are_those_of_the_fields_one_by_one() {
        for scalar in [ScalarType::I32, ScalarType::F32, ScalarType::F64] {
            let table = table(scalar, ByteOrder::NATIVE, 0);
            let plain = fields(&table);
            for fields in [plain, plain.map(|field| field.scaled(0.5, -7.0))] {
                let range = 2..9;
                let piece = Piece::read(&fields.map(Some), &RowSelection::All(9), &range);
                let triples = Triples::of(fields).expect("they follow each other");
                let mut found = [DVec3::ZERO; 7];
                triples.each(&range, &mut found, |value, slot| *slot = value);
                for (index, found) in found.iter().enumerate() {
                    let expected = piece.values.map(|values| values[index].to_bits());
                    assert_eq!(found.to_array().map(f64::to_bits), expected, "{scalar:?}");
                }
            }
        }
    }

    #[test]
    fn other_fields_are_no_triples() {
        let apart = table(ScalarType::F32, ByteOrder::NATIVE, 1);
        assert!(Triples::of(fields(&apart)).is_none());
        let foreign = if ByteOrder::NATIVE == ByteOrder::Little {
            ByteOrder::Big
        } else {
            ByteOrder::Little
        };
        let swapped = table(ScalarType::F32, foreign, 0);
        assert!(Triples::of(fields(&swapped)).is_none());
        let short = table(ScalarType::I16, ByteOrder::NATIVE, 0);
        assert!(Triples::of(fields(&short)).is_none());
        let usual = table(ScalarType::F32, ByteOrder::NATIVE, 0);
        let [x, y, z] = fields(&usual);
        assert!(Triples::of([x, z, y]).is_none());
        assert!(Triples::of([x.scaled(1.0, 0.0), y, z]).is_none());
        let same_shape = table(ScalarType::F32, ByteOrder::NATIVE, 0);
        assert!(Triples::of([x, y, same_shape.field(2)]).is_none());
    }
}
