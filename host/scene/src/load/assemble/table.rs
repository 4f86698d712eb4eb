//! Scalar properties of an element as rows of a fixed size, wherever they came from.
//!
//! A binary element without lists is its own table, borrowed from the file. Anything else (text, rows with lists between
//! the scalars) is repacked into native byte order first. [`Field`] then reads a column of either.

use std::borrow::Cow;
use std::ops::Range;

use crate::geometry::ScalarType;
use crate::load::fill::PIECE_SURFELS;

/// Rows of scalars.
#[derive(Clone, Debug)]
pub(in crate::load) struct Table<'a> {
    pub(in crate::load) bytes: Cow<'a, [u8]>,
    /// Bytes from a row to the next; above 0.
    pub(in crate::load) stride: usize,
    pub(in crate::load) rows: usize,
    pub(in crate::load) order: ByteOrder,
    pub(in crate::load) columns: Vec<TableColumn>,
}

/// Byte order of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::load) enum ByteOrder {
    Little,
    Big,
}

impl ByteOrder {
    /// This machine's.
    pub(in crate::load) const NATIVE: Self = if cfg!(target_endian = "big") {
        Self::Big
    } else {
        Self::Little
    };
}

/// One column of a table.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::load) struct TableColumn {
    pub(in crate::load) name: String,
    pub(in crate::load) scalar: ScalarType,
    /// Offset in a row.
    pub(in crate::load) offset: usize,
}

/// A column, ready to read.
#[derive(Clone, Copy, Debug)]
pub(in crate::load) struct Field<'t> {
    /// The table from the column's first value on.
    pub(super) bytes: &'t [u8],
    pub(super) stride: usize,
    pub(super) order: ByteOrder,
    pub(in crate::load) scalar: ScalarType,
    /// Scale and offset that make values of the numbers, if they are not the values themselves.
    pub(super) scaled: Option<(f64, f64)>,
}

/// Which rows of the tables become surfels.
#[derive(Clone, Debug)]
pub(in crate::load) enum RowSelection {
    /// All of them; this many.
    All(usize),
    /// These, ascending.
    Kept(Vec<u32>),
}

impl RowSelection {
    /// How many.
    pub(in crate::load) fn len(&self) -> usize {
        match self {
            Self::All(count) => *count,
            Self::Kept(rows) => rows.len(),
        }
    }
}

/// Reads one value of `bytes`, which holds at least its size.
trait FromBytes: Sized {
    fn read(bytes: &[u8], order: ByteOrder) -> Self;
}

macro_rules! from_bytes {
    ($($type:ty),*) => {$(
        impl FromBytes for $type {
            #[inline]
            fn read(bytes: &[u8], order: ByteOrder) -> Self {
                let value = bytes.first_chunk().copied().unwrap_or_default();
                match order {
                    ByteOrder::Little => <$type>::from_le_bytes(value),
                    ByteOrder::Big => <$type>::from_be_bytes(value),
                }
            }
        }
    )*};
}
from_bytes!(i8, u8, i16, u16, i32, u32, f32, f64);

/// Runs `$body` with `$type` standing for the Rust type of a [`ScalarType`], so that inner loops are specialised.
macro_rules! with_scalar_type {
    ($scalar:expr, $type:ident => $body:expr) => {
        match $scalar {
            ScalarType::I8 => {
                type $type = i8;
                $body
            }
            ScalarType::U8 => {
                type $type = u8;
                $body
            }
            ScalarType::I16 => {
                type $type = i16;
                $body
            }
            ScalarType::U16 => {
                type $type = u16;
                $body
            }
            ScalarType::I32 => {
                type $type = i32;
                $body
            }
            ScalarType::U32 => {
                type $type = u32;
                $body
            }
            ScalarType::F32 => {
                type $type = f32;
                $body
            }
            ScalarType::F64 => {
                type $type = f64;
                $body
            }
        }
    };
}

impl Table<'_> {
    /// The column at `index`.
    pub(in crate::load) fn field(&self, index: usize) -> Field<'_> {
        let column = &self.columns[index];
        let bytes = self.bytes.get(column.offset..).unwrap_or_default();
        Field {
            bytes,
            stride: self.stride,
            order: self.order,
            scalar: column.scalar,
            scaled: None,
        }
    }
}

impl Field<'_> {
    /// The same numbers, of which each stands for `scale · number + offset`.
    pub(in crate::load) fn scaled(self, scale: f64, offset: f64) -> Self {
        Self {
            scaled: Some((scale, offset)),
            ..self
        }
    }

    /// Values of the selected rows `range`, as f64, into `out` of the same length.
    #[allow(
        clippy::useless_conversion,
        reason = "one of the types of the macro is f64 itself"
    )]
    pub(in crate::load) fn read(&self, rows: &RowSelection, range: Range<usize>, out: &mut [f64]) {
        match rows {
            RowSelection::All(_) => {
                let bytes = &self.bytes[range.start * self.stride..];
                with_scalar_type!(self.scalar, Scalar => {
                    for (value, row) in out.iter_mut().zip(bytes.chunks(self.stride)) {
                        *value = f64::from(Scalar::read(row, self.order));
                    }
                });
            }
            RowSelection::Kept(kept) => {
                with_scalar_type!(self.scalar, Scalar => {
                    for (value, row) in out.iter_mut().zip(&kept[range]) {
                        *value = f64::from(Scalar::read(&self.bytes[*row as usize * self.stride..], self.order));
                    }
                });
            }
        }
        if let Some((scale, offset)) = self.scaled {
            for value in out {
                *value = scale * *value + offset;
            }
        }
    }

    /// The first bytes of the selected rows `range`, which are the values if they are bytes, into `out` of the same length.
    pub(in crate::load) fn read_bytes(
        &self,
        rows: &RowSelection,
        range: Range<usize>,
        out: &mut [u8],
    ) {
        match rows {
            RowSelection::All(_) => {
                let bytes = &self.bytes[range.start * self.stride..];
                for (value, byte) in out.iter_mut().zip(bytes.iter().step_by(self.stride)) {
                    *value = *byte;
                }
            }
            RowSelection::Kept(kept) => {
                for (value, row) in out.iter_mut().zip(&kept[range]) {
                    *value = self.bytes[*row as usize * self.stride];
                }
            }
        }
    }

    /// The value of table row `row` in native byte order, into `out` of the scalar's size.
    pub(in crate::load) fn copy_native(&self, row: usize, out: &mut [u8]) {
        let start = row * self.stride;
        out.copy_from_slice(&self.bytes[start..start + out.len()]);
        if self.order != ByteOrder::NATIVE {
            out.reverse();
        }
    }
}

/// Values of `N` fields for some surfels, as f64.
pub(in crate::load) struct Piece<const N: usize> {
    pub(in crate::load) values: [[f64; PIECE_SURFELS]; N],
}

impl<const N: usize> Piece<N> {
    /// Those of the selected rows `range`, at most [`PIECE_SURFELS`].
    pub(in crate::load) fn read(
        fields: &[Option<Field<'_>>; N],
        rows: &RowSelection,
        range: &Range<usize>,
    ) -> Self {
        let mut values = [[0.0; PIECE_SURFELS]; N];
        for (field, values) in fields.iter().zip(&mut values) {
            if let Some(field) = field {
                field.read(rows, range.clone(), &mut values[..range.len()]);
            }
        }
        Self { values }
    }
}

/// Writes `value` as `scalar` in native byte order at the start of `out`; integers saturate.
#[inline]
pub(in crate::load) fn write_native(scalar: ScalarType, value: f64, out: &mut [u8]) {
    with_scalar_type!(scalar, Scalar => {
        let bytes = (value as Scalar).to_ne_bytes();
        out[..bytes.len()].copy_from_slice(&bytes);
    });
}

/// Reads one integer of `scalar` from the start of `bytes`, which holds at least its size; floats are cut.
#[allow(
    clippy::cast_lossless,
    reason = "the macro casts floats too, which have no lossless way"
)]
pub(in crate::load) fn read_integer(scalar: ScalarType, bytes: &[u8], order: ByteOrder) -> i64 {
    with_scalar_type!(scalar, Scalar => Scalar::read(bytes, order) as i64)
}

/// Reads one number of `scalar` from the start of `bytes`, which holds at least its size.
#[allow(
    clippy::useless_conversion,
    reason = "one of the types of the macro is f64 itself"
)]
pub(in crate::load) fn read_number(scalar: ScalarType, bytes: &[u8], order: ByteOrder) -> f64 {
    with_scalar_type!(scalar, Scalar => f64::from(Scalar::read(bytes, order)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_read_both_byte_orders_and_skip_rows() {
        for order in [ByteOrder::Little, ByteOrder::Big] {
            let value = |number: i16| {
                if order == ByteOrder::Little {
                    number.to_le_bytes()
                } else {
                    number.to_be_bytes()
                }
            };
            let bytes: Vec<u8> = [-1_i16, 300, 7]
                .iter()
                .flat_map(|&number| [[9], [0]].concat().into_iter().take(1).chain(value(number)))
                .collect();
            let column = TableColumn {
                name: "v".into(),
                scalar: ScalarType::I16,
                offset: 1,
            };
            let table = Table {
                bytes: bytes.into(),
                stride: 3,
                rows: 3,
                order,
                columns: vec![column],
            };
            let mut out = [0.0; 2];
            table.field(0).read(&RowSelection::All(3), 1..3, &mut out);
            assert_eq!(out, [300.0, 7.0], "{order:?}");
            table
                .field(0)
                .read(&RowSelection::Kept(vec![0, 2]), 0..2, &mut out);
            assert_eq!(out, [-1.0, 7.0], "{order:?}");
            let mut native = [0; 2];
            table.field(0).copy_native(1, &mut native);
            assert_eq!(i16::from_ne_bytes(native), 300);
        }
    }

    #[test]
    fn writing_saturates_integers() {
        let mut out = [0; 8];
        write_native(ScalarType::U8, 300.0, &mut out);
        assert_eq!(out[0], 255);
        write_native(ScalarType::I8, f64::NAN, &mut out);
        assert_eq!(out[0], 0);
    }
}
