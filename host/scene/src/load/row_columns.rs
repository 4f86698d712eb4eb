//! The columns of surfels that come in runs, until they are an object's.
//!
//! Most are gathered as they come and converted when all are there. Positions that are whole numbers with a scale, and
//! colours of bytes beside them, have but one place to go: they are written to the object's own blocks at once, and the
//! numbers become positions there when their box is known. A cloud is then written to fresh memory once, which costs more than
//! reading it.

use std::collections::HashSet;
use std::sync::Arc;

use bytes::{Bytes, BytesMut};
use rayon::prelude::*;

use super::Winding;
use super::assemble::{
    AssembleError, Built, MOST_VERTICES, NumberBox, PositionScale, Table, build, numbers_of,
    origin_for, relative,
};
use super::block_slots::BlockSlots;
use super::column_spec::{ColumnRole, ColumnSpec, roles_of, table_of};
use super::error::LoadStop;
use super::fill::Column;
use super::gathered::Gathered;
use super::memory::{MANY_BYTES, room};
use super::object_builder::BuildError;
use crate::bounds::Bounds;
use crate::geometry::{Block, NamedColumn, Origins, Provenance, ScalarType};
use crate::job::Job;
use crate::warnings::Warnings;

/// Columns in the making, all with the same number of rows.
#[derive(Debug)]
pub(super) struct RowColumns {
    columns: Vec<(ColumnSpec, Values)>,
    scale: Option<PositionScale>,
    rows: usize,
}

/// The values of a column.
#[derive(Debug)]
enum Values {
    /// As they came.
    Gathered(Gathered),
    /// Bits of three whole numbers and a 0, where the positions are going to be; and their box.
    Positions(BlockSlots<[u32; 4]>, NumberBox),
    /// Packed colours of three bytes.
    Rgb(BlockSlots<u32>),
    /// Packed colours of four bytes.
    Rgba(BlockSlots<u32>),
}

impl RowColumns {
    /// Columns without rows.
    ///
    /// # Errors
    /// There is no position, something is declared twice, or a column cannot have so many components.
    pub(super) fn new(specs: Vec<ColumnSpec>) -> Result<Self, BuildError> {
        let problem = |problem: String| Err(BuildError::Columns { problem });
        let mut known = HashSet::new();
        for spec in &specs {
            if !spec.role.fits(spec.components) {
                return Err(BuildError::Components {
                    role: spec.role,
                    components: spec.components,
                });
            }
            let name = (spec.role == ColumnRole::Named).then_some(&spec.name);
            if !known.insert((spec.role, name)) {
                return problem(format!("{:?} '{}' is declared twice", spec.role, spec.name));
            }
        }
        if !specs.iter().any(|spec| spec.role == ColumnRole::Position) {
            return problem("there is no position".to_owned());
        }
        let columns = specs.into_iter().map(|spec| {
            let values = Values::gathered(&spec);
            (spec, values)
        });
        Ok(Self {
            columns: columns.collect(),
            scale: None,
            rows: 0,
        })
    }

    /// Says what the numbers of the positions, which must be I32, stand for.
    ///
    /// # Errors
    /// They are of another type; nothing is noted then.
    pub(super) fn scale_positions(&mut self, scale: PositionScale) -> Result<(), BuildError> {
        for (spec, _) in &self.columns {
            if spec.role == ColumnRole::Position && spec.scalar != ScalarType::I32 {
                return Err(BuildError::Scale {
                    scalar: spec.scalar,
                });
            }
        }
        self.scale = Some(scale);
        let all_fit = self.columns.iter().all(|(spec, _)| fits_in_place(spec));
        if all_fit && self.rows == 0 {
            for (spec, values) in &mut self.columns {
                *values = Values::in_place(spec);
            }
        }
        Ok(())
    }

    /// Makes room for surfels that are announced, in memory of `most_bytes` at most; a hint, of which no more is believed than a
    /// few million at once. Without effect once some have come.
    pub(super) fn reserve(&mut self, rows: u64, most_bytes: u64) {
        const MOST: u64 = 1 << 24;
        if self.rows > 0 {
            return;
        }
        let widths = self.columns.iter().map(|(spec, values)| values.width(spec));
        let width: u64 = widths.sum();
        let at_first = rows.min(MOST).min(most_bytes / width.max(1)) as usize;
        let announced = rows.min(MOST_VERTICES) as usize;
        // Named columns stay with the object, the others do not.
        let mut gathered: [Vec<&mut Gathered>; 2] = Default::default();
        for (spec, values) in &mut self.columns {
            match values {
                Values::Gathered(values) => {
                    gathered[usize::from(spec.role == ColumnRole::Named)].push(values);
                }
                Values::Positions(slots, _) => *slots = BlockSlots::new(announced, at_first),
                Values::Rgb(slots) | Values::Rgba(slots) => {
                    *slots = BlockSlots::new(announced, at_first);
                }
            }
        }
        for columns in gathered {
            Gathered::reserve(columns, at_first);
        }
    }

    /// Rows that came so far.
    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    /// Adds rows: the bytes of each column in the order of their declaration.
    ///
    /// # Errors
    /// A column is missing or of another length, or there are too many rows; nothing is added then.
    pub(super) fn add(&mut self, rows: usize, columns: &[&[u8]]) -> Result<(), BuildError> {
        let length = |column: usize, expected: usize, found: usize| BuildError::Length {
            rows: rows as u64,
            column,
            expected: expected as u64,
            found: found as u64,
        };
        if (self.rows as u64).saturating_add(rows as u64) > MOST_VERTICES {
            return Err(BuildError::TooMany);
        }
        let mut bytes = 0;
        for (index, (spec, _)) in self.columns.iter().enumerate() {
            let expected = rows * spec.width();
            let found = columns.get(index).map_or(0, |bytes| bytes.len());
            if found != expected {
                return Err(length(index, expected, found));
            }
            bytes += expected;
        }
        if let Some(more) = columns.get(self.columns.len()) {
            return Err(length(self.columns.len(), 0, more.len()));
        }
        if bytes < MANY_BYTES {
            for ((_, values), bytes) in self.columns.iter_mut().zip(columns) {
                values.add(bytes);
            }
        } else {
            let values = self.columns.par_iter_mut().zip(columns);
            values.for_each(|((_, values), bytes)| values.add(bytes));
        }
        self.rows += rows;
        Ok(())
    }

    /// The columns of an object with an origin of its own.
    ///
    /// # Errors
    /// No row can be placed, or the job was cancelled.
    pub(super) fn build(
        self,
        winding: Winding,
        job: &Job,
        warnings: &mut Warnings,
    ) -> Result<Built, LoadStop> {
        let is_named = |(spec, _): &(ColumnSpec, Values)| spec.role == ColumnRole::Named;
        let (named, columns): (Vec<_>, Vec<_>) = self.columns.into_iter().partition(is_named);
        let numbers = columns.iter().find_map(|(_, values)| match values {
            Values::Positions(_, numbers) => Some(numbers),
            _ => None,
        });
        let placed = self
            .scale
            .and_then(|scale| Some((scale, scale.bounds(numbers?)?)));
        let mut built = if let Some((scale, bounds)) = placed {
            build_in_place(columns, scale, bounds, job)?
        } else {
            let columns: Vec<(ColumnSpec, Bytes)> = columns
                .into_iter()
                .map(|(spec, values)| (spec, values.into_bytes()))
                .collect();
            let tables: Vec<(ColumnRole, Table<'_>)> = columns
                .iter()
                .map(|(spec, bytes)| (spec.role, table_of(spec, bytes, self.rows)))
                .collect();
            let roles = roles_of(&tables, self.scale).ok_or(BuildError::Nothing)?;
            build(&roles, self.rows, winding, job, warnings)?
        };
        for (spec, values) in named {
            job.check().map_err(AssembleError::from)?;
            if let Values::Gathered(values) = values {
                add_named(&spec, values, &mut built);
            }
        }
        Ok(built)
    }
}

/// Whether a column beside scaled positions, or they themselves, can be written to the object's blocks as it comes.
fn fits_in_place(spec: &ColumnSpec) -> bool {
    matches!(
        (spec.role, spec.scalar, spec.components),
        (ColumnRole::Named, ..)
            | (ColumnRole::Position, ScalarType::I32, 3)
            | (ColumnRole::Colour, ScalarType::U8, _)
    )
}

impl Values {
    /// None yet, to be gathered.
    fn gathered(spec: &ColumnSpec) -> Self {
        // Named columns are kept as they come, the others go into the object's own.
        Self::Gathered(match spec.role {
            ColumnRole::Named => Gathered::in_blocks(spec.width()),
            _ => Gathered::together(spec.width()),
        })
    }

    /// None yet, of a column that [`fits_in_place`].
    fn in_place(spec: &ColumnSpec) -> Self {
        match spec.role {
            ColumnRole::Position => Self::Positions(BlockSlots::new(0, 0), NumberBox::default()),
            ColumnRole::Colour if spec.components == 3 => Self::Rgb(BlockSlots::new(0, 0)),
            ColumnRole::Colour => Self::Rgba(BlockSlots::new(0, 0)),
            _ => Self::gathered(spec),
        }
    }

    /// Bytes that a surfel's values take.
    fn width(&self, spec: &ColumnSpec) -> u64 {
        let width = match self {
            Self::Gathered(_) => spec.width(),
            Self::Positions(..) => size_of::<[u32; 4]>(),
            Self::Rgb(_) | Self::Rgba(_) => size_of::<u32>(),
        };
        width as u64
    }

    /// Adds the values of some surfels, whole ones.
    fn add(&mut self, bytes: &[u8]) {
        match self {
            Self::Gathered(values) => values.add(bytes),
            Self::Positions(slots, numbers) => {
                let value = |position: &[u8; 12]| {
                    let [x, y, z] = numbers_of(position).map(i32::cast_unsigned);
                    [x, y, z, 0]
                };
                let rows = bytes.as_chunks().0;
                let found = slots.extend(rows, value, NumberBox::of, NumberBox::union);
                *numbers = numbers.union(found);
            }
            Self::Rgb(slots) => {
                let value =
                    |&[red, green, blue]: &[u8; 3]| u32::from_le_bytes([red, green, blue, 255]);
                slots.extend(bytes.as_chunks().0, value, |_| (), |(), ()| ());
            }
            Self::Rgba(slots) => {
                let value = |colour: &[u8; 4]| u32::from_le_bytes(*colour);
                slots.extend(bytes.as_chunks().0, value, |_| (), |(), ()| ());
            }
        }
    }

    /// The values as they came.
    fn into_bytes(self) -> Bytes {
        match self {
            Self::Gathered(values) => values.into_parts().next().unwrap_or_default(),
            Self::Positions(slots, _) => bytes_of(slots.into_blocks(), |[x, y, z, _]| {
                bytemuck::cast::<[u32; 3], [u8; 12]>([x, y, z])
            }),
            Self::Rgb(slots) => bytes_of(slots.into_blocks(), |colour| {
                let [red, green, blue, _] = colour.to_le_bytes();
                [red, green, blue]
            }),
            Self::Rgba(slots) => bytes_of(slots.into_blocks(), u32::to_le_bytes),
        }
    }
}

/// The bytes of a column's values one after the other; the memory of each block goes back when it was read.
fn bytes_of<T: Copy, const WIDTH: usize>(
    blocks: Column<T>,
    bytes: impl Fn(T) -> [u8; WIDTH],
) -> Bytes {
    let values: usize = blocks.iter().map(|block| block.len()).sum();
    let mut all: BytesMut = room(values * WIDTH);
    for block in blocks {
        all.extend(block.iter().flat_map(|value| bytes(*value)));
    }
    all.freeze()
}

/// The columns of an object whose values lie in its blocks already, all but the positions as they should be.
fn build_in_place(
    columns: Vec<(ColumnSpec, Values)>,
    scale: PositionScale,
    bounds: Bounds,
    job: &Job,
) -> Result<Built, AssembleError> {
    let origin = origin_for(&bounds);
    let mut positions = Vec::new();
    let mut colours = Vec::new();
    let mut origins = Origins::default();
    for (_, values) in columns {
        match values {
            Values::Positions(slots, _) => {
                positions = scale.place(slots.into_blocks(), origin, job)?;
            }
            Values::Rgb(slots) | Values::Rgba(slots) => {
                colours = slots.into_blocks();
                origins.colours = Provenance::FromFile;
            }
            Values::Gathered(_) => {}
        }
    }
    let mut colours = colours.into_iter();
    let blocks = positions.into_iter().map(|position_radius| Block {
        position_radius,
        colour: colours.next(),
        ..Block::default()
    });
    Ok(Built {
        blocks: blocks.collect(),
        origin,
        bounds: relative(&bounds, origin),
        new_index: None,
        origins,
    })
}

/// Adds a column to the blocks, without the values of surfels that were dropped.
fn add_named(spec: &ColumnSpec, values: Gathered, built: &mut Built) {
    let mut values = values;
    if let Some(new_index) = &built.new_index {
        let width = spec.width();
        let mut kept = Gathered::in_blocks(width);
        let mut indices = new_index.iter();
        for part in values.into_parts() {
            let rows = part.chunks_exact(width).zip(&mut indices);
            let own: Vec<u8> = rows
                .filter(|(_, index)| **index != u32::MAX)
                .flat_map(|(value, _)| value)
                .copied()
                .collect();
            kept.add(&own);
        }
        values = kept;
    }
    let name: Arc<str> = spec.name.as_str().into();
    for (block, bytes) in built.blocks.iter_mut().zip(values.into_parts()) {
        block.named.push(NamedColumn {
            name: name.clone(),
            scalar: spec.scalar,
            components: spec.components,
            bytes,
        });
    }
}

#[cfg(test)]
#[path = "row_columns_tests.rs"]
mod tests;
