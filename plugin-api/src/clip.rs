//! Clip lines: where surfels end at a sharp edge, by named columns that a file may bring.
//!
//! A surfel's disk reaches beyond an edge of its surface and makes it ragged. A line in the surfel's own plane cuts it off:
//! the part stays where `a·u + b·v + c ≥ 0`, with u and v in units of the tangent half-axes, so that |(u, v)| = 1 is the rim.
//!
//! | columns | meaning |
//! |---|---|
//! | `clip_a0` `clip_b0` `clip_c0` | the first line |
//! | `clip_a1` `clip_b1` `clip_c1` (optional) | the second line |
//! | `clip_union` (optional) | not 0: what either line leaves stays (an inner corner); else what both leave (an outer one) |
//!
//! Each has one number a surfel, of any type. A line of zeros, or with a number that is not finite, cuts nothing off. The surfels
//! must have tangent axes (the column `axes`; `ux` … `vz` in PLY files), since without them nobody knows where u and v point.
//! Factors on a surfel's size move its rim and not its lines.
//!
//! No manifest asks for these columns: a scene without them is drawn as ever. The content on the CPU crosses the border
//! whatever the manifest says; a renderer that draws on the device brings [`ClipLines`] there itself, which the shader library
//! reads (`lib::clip`).
//!
//! Zwicker et al., *Perspective Accurate Splatting*, GI 2004, cut splats at sharp edges and corners by one or two lines.

use crate::columns;
use crate::scene::{Block, Column};
use bytemuck::{Pod, Zeroable};

/// Names of the columns of the two lines: a, b, c.
pub const LINES: [[&str; 3]; 2] = [
    ["clip_a0", "clip_b0", "clip_c0"],
    ["clip_a1", "clip_b1", "clip_c1"],
];
/// Name of the column that says how two lines go together.
pub const UNION: &str = "clip_union";

/// The lines of a surfel; `ClipLines` of the shader library.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct ClipLines {
    /// a, b, c of the first.
    pub first: [f32; 3],
    /// 1 if what either leaves stays, 0 if what both leave.
    pub is_union: f32,
    /// Of the second.
    pub second: [f32; 3],
    /// Nothing.
    pub padding: f32,
}

/// The columns of a block.
#[derive(Clone, Copy)]
pub struct ClipColumns<'a> {
    first: [Column<'a>; 3],
    second: Option<[Column<'a>; 3]>,
    union: Option<Column<'a>>,
    surfel_count: u32,
}

impl ClipLines {
    /// A line that cuts nothing off.
    const EVERYWHERE: [f32; 3] = [0.0, 0.0, 1.0];
    /// Lines that cut nothing off.
    pub const NONE: Self = Self {
        first: Self::EVERYWHERE,
        is_union: 0.0,
        second: Self::EVERYWHERE,
        padding: 0.0,
    };

    /// Lines from a, b, c of each, as columns hold them.
    pub fn new([first, second]: [[f32; 3]; 2], is_union: bool) -> Self {
        let line = |line: [f32; 3]| {
            let is_line = line.iter().all(|number| number.is_finite()) && line != [0.0; 3];
            if is_line { line } else { Self::EVERYWHERE }
        };
        Self {
            first: line(first),
            is_union: f32::from(u8::from(is_union)),
            second: line(second),
            padding: 0.0,
        }
    }
}

impl<'a> ClipColumns<'a> {
    /// The block's columns; none if it has no lines or no tangent axes.
    pub fn of(block: Block<'a>) -> Option<Self> {
        let surfel_count = block.surfel_count();
        block.column(columns::AXES)?;
        // A column that is shorter than the surfels is treated as absent.
        let column = |name: &str| {
            let column = block.column(name)?;
            let last = surfel_count.checked_sub(1)?;
            column.number(last, 0).map(|_| column)
        };
        let line = |[a, b, c]: [&str; 3]| Some([column(a)?, column(b)?, column(c)?]);
        let [first, second] = LINES;
        Some(Self {
            first: line(first)?,
            second: line(second),
            union: column(UNION),
            surfel_count,
        })
    }

    /// Surfels of the block.
    pub fn surfel_count(&self) -> u32 {
        self.surfel_count
    }

    /// Grows with every change of the content.
    pub fn revision(&self) -> u64 {
        let columns = self.first.iter().chain(self.second.iter().flatten());
        let revisions = columns.chain(&self.union).map(Column::revision);
        revisions.max().unwrap_or_default()
    }

    /// The lines of a surfel of the block; none of them cuts where `number` is beyond the block.
    pub fn lines(&self, number: u32) -> ClipLines {
        let read = |column: &Column<'_>| column.number(number, 0).unwrap_or_default() as f32;
        let line = |columns: &[Column<'_>; 3]| columns.each_ref().map(read);
        let second = self.second.as_ref().map_or([0.0; 3], line);
        let is_union = self.second.is_some() && self.union.as_ref().map_or(0.0, read) != 0.0;
        ClipLines::new([line(&self.first), second], is_union)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::abi::{BlockRecord, ColumnRecord, ScalarType};
    use abi_stable::std_types::RSlice;

    fn record<'a>(name: &'a str, scalar: ScalarType, bytes: &'a [u8]) -> ColumnRecord<'a> {
        ColumnRecord::new(name, scalar, 1, 7, bytes)
    }

    fn lines(records: &[ColumnRecord<'_>], number: u32) -> Option<ClipLines> {
        let block = Block::new(BlockRecord {
            first_surfel: 0,
            surfel_count: 2,
            columns: RSlice::from_slice(records),
        });
        let columns = ClipColumns::of(block)?;
        assert_eq!(columns.revision(), 7);
        Some(columns.lines(number))
    }

    #[test]
    fn lines_come_from_columns_of_any_type() {
        let axes = [0_u8; 64];
        let a: Vec<u8> = [1.5_f64, 2.5].map(f64::to_ne_bytes).concat();
        let b: Vec<u8> = [-3_i16, 4].map(i16::to_ne_bytes).concat();
        let c: Vec<u8> = [0.25_f32, f32::NAN].map(f32::to_ne_bytes).concat();
        let union = [1_u8, 0];
        let mut records = vec![
            record("axes", ScalarType::F32, &axes),
            record("clip_a0", ScalarType::F64, &a),
            record("clip_b0", ScalarType::I16, &b),
            record("clip_c0", ScalarType::F32, &c),
            record("clip_union", ScalarType::U8, &union),
        ];
        let first = lines(&records, 0).unwrap();
        assert_eq!((first.first, first.is_union), ([1.5, -3.0, 0.25], 0.0));
        assert_eq!(first.second, ClipLines::EVERYWHERE);
        // Of the second surfel c is no number.
        assert_eq!(lines(&records, 1), Some(ClipLines::NONE));
        records.extend(
            ["clip_a1", "clip_b1", "clip_c1"].map(|name| record(name, ScalarType::I16, &b)),
        );
        let both = lines(&records, 0).unwrap();
        assert_eq!((both.second, both.is_union), ([-3.0; 3], 1.0));
    }

    #[test]
    fn without_axes_or_a_whole_line_there_are_none() {
        let numbers = [0_u8; 8];
        let line = LINES[0].map(|name| record(name, ScalarType::F32, &numbers));
        assert_eq!(lines(&line, 0), None);
        let axes = record("axes", ScalarType::F32, &numbers);
        assert_eq!(lines(&[axes, line[0], line[1]], 0), None);
        let short = record("clip_c0", ScalarType::F32, &numbers[..4]);
        assert_eq!(lines(&[axes, line[0], line[1], short], 0), None);
        // Zeros cut nothing off.
        let all = [axes, line[0], line[1], line[2]];
        assert_eq!(lines(&all, 0), Some(ClipLines::NONE));
    }
}
