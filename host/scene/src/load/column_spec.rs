//! Columns as loaders declare them, and as the tables that objects are built from.

use std::borrow::Cow;

use super::assemble::{ByteOrder, Field, NumberBox, PositionScale, Roles, Table, TableColumn};
use crate::geometry::ScalarType;

/// What a column means.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ColumnRole {
    /// Only its name says.
    Named,
    /// x, y, z; or x and y, with z taken as 0. Any type: the object gets an origin that keeps f64 coordinates precise.
    Position,
    /// Three components; the length does not matter.
    Normal,
    /// Red, green, blue, perhaps alpha: sRGB as bytes, 16 bits, or floats from 0 to 1.
    Colour,
    /// One component, scene units.
    Radius,
    /// Tangent half-axes u and v, six components, scene units.
    Axes,
}

impl ColumnRole {
    /// How many components a column of this role has.
    pub(super) fn fits(self, components: u32) -> bool {
        match self {
            Self::Named => (1..=1024).contains(&components),
            Self::Position => (2..=3).contains(&components),
            Self::Normal => components == 3,
            Self::Colour => (3..=4).contains(&components),
            Self::Radius => components == 1,
            Self::Axes => components == 6,
        }
    }
}

/// A column that is going to be filled.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColumnSpec {
    /// What it means.
    pub role: ColumnRole,
    /// The file's name for it; of no meaning unless the role is [`ColumnRole::Named`].
    pub name: String,
    /// Type of a component.
    pub scalar: ScalarType,
    /// Components a surfel.
    pub components: u32,
}

impl ColumnSpec {
    /// A column whose role says all.
    pub fn new(role: ColumnRole, scalar: ScalarType, components: u32) -> Self {
        Self {
            role,
            name: String::new(),
            scalar,
            components,
        }
    }

    /// A column kept under its name.
    pub fn named(name: impl Into<String>, scalar: ScalarType, components: u32) -> Self {
        Self {
            name: name.into(),
            ..Self::new(ColumnRole::Named, scalar, components)
        }
    }

    /// Bytes of one surfel's values.
    pub(super) fn width(&self) -> usize {
        self.scalar.size() * self.components as usize
    }
}

/// A column as a table of its own.
pub(super) fn table_of<'a>(spec: &ColumnSpec, bytes: &'a [u8], rows: usize) -> Table<'a> {
    let component = |index: u32| TableColumn {
        name: spec.name.clone(),
        scalar: spec.scalar,
        offset: index as usize * spec.scalar.size(),
    };
    Table {
        bytes: Cow::Borrowed(bytes),
        stride: spec.width(),
        rows,
        order: ByteOrder::NATIVE,
        columns: (0..spec.components).map(component).collect(),
    }
}

/// The columns by meaning, without the named ones; `None` without a position, which a builder cannot lack.
pub(super) fn roles_of<'a>(
    tables: &'a [(ColumnRole, Table<'a>)],
    scale: Option<PositionScale>,
) -> Option<Roles<'a>> {
    let table = |role| {
        let found = tables.iter().find(|(own, _)| *own == role);
        found.map(|(_, table)| table)
    };
    fn fields<'t, const N: usize>(table: &'t Table<'t>) -> [Field<'t>; N] {
        std::array::from_fn(|index| table.field(index))
    }
    let position = table(ColumnRole::Position)?;
    let coordinate = |axis: usize| {
        let field = position.field(axis);
        scale.map_or(field, |by| field.scaled(by.scale[axis], by.offset[axis]))
    };
    let has_z = position.columns.len() > 2;
    let colour = table(ColumnRole::Colour);
    Some(Roles {
        x: coordinate(0),
        y: coordinate(1),
        z: has_z.then(|| coordinate(2)),
        bounds: scale
            .filter(|_| has_z)
            .and_then(|scale| scale.bounds(&NumberBox::of_many(position.bytes.as_chunks().0))),
        normal: table(ColumnRole::Normal).map(fields),
        colour: colour.map(fields),
        alpha: colour
            .filter(|table| table.columns.len() > 3)
            .map(|table| table.field(3)),
        radius: table(ColumnRole::Radius).map(|table| table.field(0)),
        axes: table(ColumnRole::Axes).map(fields),
        named: Vec::new(),
    })
}
