//! The record of a surfel: which properties it has, where each stands, and its bytes.

use glam::{DVec3, Vec3};
use pointstage_plugin_api::columns::colour_from_bytes;

use crate::geometry::{Block, NamedColumn};
use crate::load::sfl::{NAMED, NamedProperty, Property, SET_COLUMN};
use crate::save::columns::{Present, axes_of, bytes_of, normal_of};
use crate::warnings::{WarningKind, Warnings};

/// The bits of the mask for colours as RGBA.
const RGBA: u32 = 0x000F_0000;

/// Layout of the records of an object.
#[derive(Debug)]
pub(super) struct Record {
    /// By rising bit.
    fields: Vec<Field>,
    /// Bytes from a record to the next.
    pub(super) bytes: usize,
    /// Radii and axes are multiplied by this.
    radius_scale: f32,
}

#[derive(Clone, Copy, Debug)]
struct Field {
    property: Property,
    offset: usize,
    source: FieldSource,
}

/// Where the bytes of a property come from.
#[derive(Clone, Copy, Debug)]
enum FieldSource {
    Centre,
    Normal,
    Radius,
    Colour,
    Axes,
    /// The named column of this index.
    Named(usize),
}

/// The bytes of a property, and what its offset is a multiple of, as the reference writer has it.
fn size_and_alignment(source: FieldSource, named: &[NamedColumn]) -> (usize, usize) {
    match source {
        FieldSource::Centre | FieldSource::Normal => (12, 4),
        FieldSource::Radius => (4, 4),
        FieldSource::Colour => (4, 1),
        FieldSource::Axes => (24, 4),
        FieldSource::Named(index) => {
            let column = &named[index];
            let size = column.scalar.size() * column.components as usize;
            let alignment = match &*column.name {
                "phi_theta" => 8,
                // Two numbers of 16 bits that the reference writer takes for one of 32.
                "camera_xy" => 4,
                _ => column.scalar.size(),
            };
            (size, alignment)
        }
    }
}

impl Record {
    /// The layout for what an object has; columns that no property fits are named in `warnings`.
    pub(super) fn plan(
        present: &Present<'_>,
        has_sets: bool,
        radius_scale: f32,
        warnings: &mut Warnings,
    ) -> Self {
        let mut found = vec![(Property::POSITION, FieldSource::Centre)];
        for (is_there, property, source) in [
            (present.normals, Property::NORMAL, FieldSource::Normal),
            (present.radii, Property::RADIUS, FieldSource::Radius),
            (present.colours, Property::DIFFUSE, FieldSource::Colour),
            (present.axes, Property::AXES, FieldSource::Axes),
        ] {
            if is_there {
                found.push((property, source));
            }
        }
        for (index, column) in present.named.iter().enumerate() {
            let fitting = NAMED.iter().find(|named| fits(named, column));
            let is_free = |named: &&NamedProperty| {
                found
                    .iter()
                    .all(|(property, _)| *property != named.property)
            };
            if let Some(named) = fitting.filter(is_free) {
                found.push((named.property, FieldSource::Named(index)));
            } else if !(has_sets && *column.name == *SET_COLUMN) {
                let text = format!(
                    "SFL files have no place for column '{}': left out",
                    column.name
                );
                warnings.add(WarningKind::Other(text), 1);
            }
        }
        found.sort_by_key(|(property, _)| property.0);
        let mut record = Self {
            fields: Vec::new(),
            bytes: 0,
            radius_scale,
        };
        for alignment in [8, 4, 2, 1] {
            for &(property, source) in &found {
                let (size, own_alignment) = size_and_alignment(source, present.named);
                if own_alignment == alignment {
                    let offset = record.bytes.next_multiple_of(alignment);
                    record.bytes = offset + size;
                    record.fields.push(Field {
                        property,
                        offset,
                        source,
                    });
                }
            }
        }
        record.fields.sort_by_key(|field| field.property.0);
        record
    }

    /// The property mask.
    pub(super) fn mask(&self) -> Vec<u32> {
        let has_colour = self.fields.iter().any(|field| field.property.is_colour());
        let mut words = vec![if has_colour { RGBA } else { 0 }];
        for field in &self.fields {
            let word = usize::from(field.property.0 / 32);
            words.resize(words.len().max(word + 1), 0);
            words[word] |= 1 << (field.property.0 % 32);
        }
        words
    }

    /// The numbers of the properties.
    pub(super) fn indices(&self) -> Vec<u16> {
        self.fields.iter().map(|field| field.property.0).collect()
    }

    /// Their offsets.
    pub(super) fn offsets(&self) -> Vec<u32> {
        self.fields
            .iter()
            .map(|field| field.offset as u32)
            .collect()
    }

    /// Writes a surfel into `record`; `residual` is added to its centre.
    pub(super) fn write(&self, block: &Block, surfel: usize, residual: DVec3, record: &mut [u8]) {
        for field in &self.fields {
            let out = &mut record[field.offset..];
            match field.source {
                FieldSource::Centre => {
                    let centre = block.centre(surfel);
                    let centre = if residual == DVec3::ZERO {
                        centre
                    } else {
                        (centre.as_dvec3() + residual).as_vec3()
                    };
                    write_vector(centre, out);
                }
                FieldSource::Normal => write_vector(normal_of(block, surfel), out),
                FieldSource::Radius => {
                    let [.., radius] = block.position_radius[surfel];
                    out[..4].copy_from_slice(&(radius * self.radius_scale).to_be_bytes());
                }
                FieldSource::Colour => {
                    let colours = block.colour.as_ref().map(|colours| colours[surfel]);
                    let colour = colours.unwrap_or(colour_from_bytes([255; 4]));
                    out[..4].copy_from_slice(&colour.to_le_bytes());
                }
                FieldSource::Axes => {
                    let [u, v] = axes_of(block, surfel).map(|axis| axis * self.radius_scale);
                    write_vector(u, out);
                    write_vector(v, &mut out[12..]);
                }
                FieldSource::Named(index) => {
                    let column = &block.named[index];
                    let bytes = bytes_of(column, surfel);
                    let out = &mut out[..bytes.len()];
                    out.copy_from_slice(bytes);
                    if cfg!(target_endian = "little") {
                        out.chunks_exact_mut(column.scalar.size())
                            .for_each(<[u8]>::reverse);
                    }
                }
            }
        }
    }
}

/// Whether a column has the name and the form of a property.
fn fits(named: &NamedProperty, column: &NamedColumn) -> bool {
    *column.name == *named.name
        && column.scalar == named.scalar
        && column.components as usize == named.components
}

fn write_vector(vector: Vec3, out: &mut [u8]) {
    for (slot, value) in out.chunks_exact_mut(4).zip(vector.to_array()) {
        slot.copy_from_slice(&value.to_be_bytes());
    }
}
