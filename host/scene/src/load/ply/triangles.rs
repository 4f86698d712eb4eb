//! Binary faces that are all triangles, the usual case, converted in parallel.

use std::sync::Arc;

use rayon::prelude::*;

use super::header::{Element, PropertyKind};
use crate::geometry::ScalarType;
use crate::job::{Cancelled, Job};
use crate::load::assemble::{ByteOrder, Triangles, corner_from, read_integer};
use crate::load::memory::zeroed_slice;

/// Rows converted between two looks at the cancel flag.
const ROWS_A_PIECE: usize = 1 << 16;

/// The element as triangles, and the bytes it takes, if every row's only list has three corners.
///
/// Rows are taken to be equally long; by induction from the first they are, when each has length 3 where one of that
/// size would have its length.
pub(super) fn all_triangles(
    file_rest: &[u8],
    element: &Element,
    corners: usize,
    order: ByteOrder,
    job: &Job,
) -> Result<Option<(Triangles, usize)>, Cancelled> {
    let lists = element
        .properties
        .iter()
        .filter(|property| matches!(property.kind, PropertyKind::List { .. }))
        .count();
    let PropertyKind::List { length, item } = element.properties[corners].kind else {
        return Ok(None);
    };
    let before: usize = element.properties[..corners]
        .iter()
        .map(|property| property.kind.min_size())
        .sum();
    let stride = element.min_row_size() + 3 * item.size();
    let rows = element.count as usize;
    let Some(bytes) = rows
        .checked_mul(stride)
        .and_then(|size| file_rest.get(..size))
    else {
        return Ok(None);
    };
    let first_length = bytes
        .get(before..)
        .filter(|list| list.len() >= length.size());
    let starts_with_three = first_length.is_some_and(|list| read_integer(length, list, order) == 3);
    if lists != 1 || !(starts_with_three || rows == 0) {
        return Ok(None);
    }
    let mut triangles: Arc<[[u32; 3]]> = zeroed_slice(rows);
    let slots = Arc::get_mut(&mut triangles).expect("just made, nobody else has it");
    let layout = RowLayout {
        stride,
        before,
        length,
        item,
        order,
    };
    let pieces = slots
        .par_chunks_mut(ROWS_A_PIECE)
        .zip(bytes.par_chunks(ROWS_A_PIECE * stride));
    let found = pieces
        .map(|(slots, bytes)| {
            job.check().map_err(NotTriangles::Cancelled)?;
            layout.read(bytes, slots).ok_or(NotTriangles::OtherLength)
        })
        .try_reduce(
            || (0, 0),
            |(max_a, count_a), (max_b, count_b)| Ok((max_a.max(max_b), count_a + count_b)),
        );
    match found {
        Ok((max_corner, degenerate_count)) => Ok(Some((
            Triangles {
                corners: triangles,
                max_corner,
                degenerate_count,
            },
            bytes.len(),
        ))),
        Err(NotTriangles::OtherLength) => Ok(None),
        Err(NotTriangles::Cancelled(cancelled)) => Err(cancelled),
    }
}

/// Why an element is not all triangles.
enum NotTriangles {
    OtherLength,
    Cancelled(Cancelled),
}

/// Where a row of one list of three has what.
struct RowLayout {
    stride: usize,
    /// Bytes before the list's length.
    before: usize,
    length: ScalarType,
    item: ScalarType,
    order: ByteOrder,
}

impl RowLayout {
    /// Fills `triangles` from rows; the largest corner and the number of triangles with one twice. `None` if a row's list
    /// is not of length 3.
    fn read(&self, bytes: &[u8], triangles: &mut [[u32; 3]]) -> Option<(u32, u64)> {
        // What nearly every file has: uchar 3 and three ints, 13 bytes.
        let usual = self.stride == 13
            && self.before == 0
            && self.length.size() == 1
            && matches!(self.item, ScalarType::I32 | ScalarType::U32);
        match (usual, self.order) {
            (true, ByteOrder::Little) => read_usual::<false>(bytes, triangles),
            (true, ByteOrder::Big) => read_usual::<true>(bytes, triangles),
            (false, _) => self.read_any(bytes, triangles),
        }
    }

    fn read_any(&self, bytes: &[u8], triangles: &mut [[u32; 3]]) -> Option<(u32, u64)> {
        let mut max_corner = 0;
        let mut degenerate_count = 0;
        for (triangle, row) in triangles.iter_mut().zip(bytes.chunks_exact(self.stride)) {
            let list = &row[self.before..];
            if read_integer(self.length, list, self.order) != 3 {
                return None;
            }
            let items = &list[self.length.size()..];
            let corner = |index: usize| {
                corner_from(read_integer(
                    self.item,
                    &items[index * self.item.size()..],
                    self.order,
                ))
            };
            *triangle = [corner(0), corner(1), corner(2)];
            let [a, b, c] = *triangle;
            max_corner = max_corner.max(a).max(b).max(c);
            degenerate_count += u64::from(a == b || b == c || a == c);
        }
        Some((max_corner, degenerate_count))
    }
}

/// Rows of one byte and three 32-bit corners. Negative corners come out above every vertex, as [`corner_from`]'s do.
#[allow(
    clippy::needless_bitwise_bool,
    reason = "branches would keep the loop from being vectorised"
)]
fn read_usual<const BIG: bool>(bytes: &[u8], triangles: &mut [[u32; 3]]) -> Option<(u32, u64)> {
    let (rows, _) = bytes.as_chunks::<13>();
    let mut max_corner = 0;
    let mut degenerate_count = 0;
    let mut lengths = 0;
    for (triangle, row) in triangles.iter_mut().zip(rows) {
        let [length, a0, a1, a2, a3, b0, b1, b2, b3, c0, c1, c2, c3] = *row;
        let corner = |bytes| {
            if BIG {
                u32::from_be_bytes(bytes)
            } else {
                u32::from_le_bytes(bytes)
            }
        };
        let (a, b, c) = (
            corner([a0, a1, a2, a3]),
            corner([b0, b1, b2, b3]),
            corner([c0, c1, c2, c3]),
        );
        *triangle = [a, b, c];
        lengths |= length ^ 3;
        max_corner = max_corner.max(a).max(b).max(c);
        degenerate_count += u64::from((a == b) | (b == c) | (a == c));
    }
    (lengths == 0).then_some((max_corner, degenerate_count))
}
