//! Records into surfel columns.

use std::ops::Range;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use pointstage_plugin_api::columns::{NO_NORMAL, TangentAxes, encode_normal};

use super::colours::{add_colours, add_other_colours, add_raw_yuv};
use super::layout::NormalForm;
use super::normal::CubicCode;
use super::property::{INVISIBLE, NAMED, NamedProperty, Property, SET_COLUMN};
use super::rows::{Part, Rows, f32_at, vector_at};
use crate::geometry::{Block, NamedColumn, Origins, Provenance, ScalarType};
use crate::job::{Cancelled, Job};
use crate::load::Winding;
use crate::load::assemble::{Built, MAX_COORDINATE, Placed, origin_for, relative, usable};
use crate::load::fill::{ByteColumn, Column, fill_blocks, fill_bytes};
use crate::warnings::{WarningKind, Warnings};

/// Radius of a surfel from the density of its samples: `k / √(π·d)`, with k as a float, as the reference library has it.
const DENSITY_RADIUS: f32 = 1.2;

/// Builds the columns; the surfels that cannot be placed are left out of `rows`.
pub(super) fn build(
    rows: &mut Rows<'_>,
    set_count: usize,
    winding: Winding,
    job: &Job,
    warnings: &mut Warnings,
) -> Result<Built, Cancelled> {
    let (mut positions, mut placed) = place(rows, DVec3::ZERO, job)?;
    let origin = origin_for(&placed.bounds);
    let any_unusable = placed.not_finite > 0;
    if any_unusable {
        warnings.add(
            WarningKind::NonFinitePositionsDropped,
            placed.not_finite as u64,
        );
        rows.drop_unusable();
    }
    if any_unusable || origin != DVec3::ZERO {
        (positions, placed) = place(rows, origin, job)?;
    }
    let has_radii = [Property::RADIUS, Property::AXES, Property::DENSITY]
        .into_iter()
        .any(|property| rows.have(property));
    let mut origins = Origins::default();
    if has_radii {
        warnings.add(
            WarningKind::UnusableRadiiReplaced,
            placed.without_radius as u64,
        );
        if placed.without_radius < rows.count {
            origins.radii = Provenance::FromFile;
        }
    }
    let mut blocks: Vec<Block> = positions
        .into_iter()
        .map(|position_radius| Block {
            position_radius,
            ..Block::default()
        })
        .collect();
    add_axes(rows, &mut blocks, &mut origins, job, warnings)?;
    add_normals(rows, winding, &mut blocks, &mut origins, job, warnings)?;
    let coloured = add_colours(rows, &mut blocks, &mut origins, job)?;
    for named in NAMED {
        if named.property.is_colour() {
            add_other_colours(rows, named, &coloured, &mut blocks, job)?;
            add_raw_yuv(rows, named, &mut blocks, job)?;
        } else if rows.have(named.property) {
            add_named(rows, named, &mut blocks, job, warnings)?;
        }
    }
    if set_count > 1 {
        add_set_indices(rows, &mut blocks, job)?;
    }
    Ok(Built {
        blocks,
        origin,
        bounds: relative(&placed.bounds, origin),
        new_index: None,
        origins,
    })
}

/// Centres (less `origin`) and radii.
fn place(
    rows: &Rows<'_>,
    origin: DVec3,
    job: &Job,
) -> Result<(Column<[f32; 4]>, Placed), Cancelled> {
    let convert = |range: Range<usize>, slots: &mut [[f32; 4]]| {
        let mut placed = Placed::default();
        rows.each(range, |index, part, record| {
            let centre = part.position(record);
            if !usable(centre.to_array()) {
                placed.not_finite += 1;
                return;
            }
            placed.bounds = placed.bounds.with_point(centre);
            let local = (centre - origin).as_vec3();
            let radius = radius(part, record);
            let radius = if radius > 0.0 && f64::from(radius) <= MAX_COORDINATE {
                radius
            } else {
                placed.without_radius += 1;
                0.0
            };
            slots[index] = [local.x, local.y, local.z, radius];
        });
        placed
    };
    fill_blocks(rows.count, 1, job, convert, Placed::merge)
}

/// The radius that a record stores, or that follows from its axes or its density; 0 if none does.
#[inline]
fn radius(part: &Part<'_>, record: &[u8]) -> f32 {
    let layout = &part.set.layout;
    let scaled = |radius: f32| {
        if part.placement.radius_scale == 1.0 {
            radius
        } else {
            (f64::from(radius) * part.placement.radius_scale) as f32
        }
    };
    if let Some(offset) = layout.offset(Property::RADIUS) {
        scaled(f32_at(record, offset))
    } else if let Some(axes) = stored_axes(part, record) {
        let [u, v] = axes.map(Vec3::length);
        u.max(v)
    } else if let Some(offset) = layout.offset(Property::DENSITY) {
        let density = vector_at(record, offset).as_dvec3().length();
        let radius = f64::from(DENSITY_RADIUS) / (std::f64::consts::PI * density).sqrt();
        scaled(radius as f32)
    } else {
        0.0
    }
}

/// The tangent half-axes that a record stores, in the object's space.
#[inline]
fn stored_axes(part: &Part<'_>, record: &[u8]) -> Option<[Vec3; 2]> {
    let offset = part.set.layout.offset(Property::AXES)?;
    let axes = [vector_at(record, offset), vector_at(record, offset + 12)];
    Some(part.placement.axes(axes))
}

fn are_useful([u, v]: [Vec3; 2]) -> bool {
    u.is_finite() && v.is_finite() && u.cross(v).length() > 0.0
}

/// The normal that a record stores, or that follows from its axes, in the object's space; zero if none does.
#[inline]
fn normal(part: &Part<'_>, record: &[u8]) -> DVec3 {
    let layout = &part.set.layout;
    let Some(offset) = layout.offset(Property::NORMAL) else {
        let [u, v] = stored_axes(part, record).unwrap_or_default();
        return u.as_dvec3().cross(v.as_dvec3());
    };
    let bytes = record.get(offset..).unwrap_or_default();
    let stored = match layout.normal_form {
        NormalForm::Floats => vector_at(record, offset).as_dvec3(),
        NormalForm::Packed(code @ CubicCode::Bits16) => {
            let bytes = bytes.first_chunk().copied().unwrap_or_default();
            code.decode(u32::from(u16::from_be_bytes(bytes)))
        }
        NormalForm::Packed(code @ CubicCode::Bits32) => {
            let bytes = bytes.first_chunk().copied().unwrap_or_default();
            code.decode(u32::from_be_bytes(bytes))
        }
    };
    part.placement.normal(stored)
}

/// Half-axes of a disk: of length `radius`, orthogonal to `normal` and each other, as the reference library picks them.
fn disk_axes(normal: Vec3, radius: f32) -> [Vec3; 2] {
    let (x, y, z) = (normal.x.abs(), normal.y.abs(), normal.z.abs());
    let a = if x < y && x < z {
        Vec3::new(0.0, -normal.z, normal.y)
    } else if x >= y && y < z {
        Vec3::new(normal.z, 0.0, -normal.x)
    } else {
        Vec3::new(-normal.y, normal.x, 0.0)
    };
    let u = a.normalize_or_zero() * radius;
    [u, normal.cross(u)]
}

/// Axes, where any set has them. Useless ones become those of the surfel's disk; if there is none, all are left out.
fn add_axes(
    rows: &Rows<'_>,
    blocks: &mut [Block],
    origins: &mut Origins,
    job: &Job,
    warnings: &mut Warnings,
) -> Result<(), Cancelled> {
    if !rows.have(Property::AXES) {
        return Ok(());
    }
    let convert = |range: Range<usize>, slots: &mut [[f32; 8]]| {
        let mut useless = 0;
        rows.each(range, |index, part, record| {
            let stored = stored_axes(part, record).filter(|axes| are_useful(*axes));
            let [u, v] = stored.unwrap_or_else(|| {
                let normal = normal(part, record).as_vec3().normalize_or_zero();
                let axes = disk_axes(normal, radius(part, record));
                useless += usize::from(!are_useful(axes));
                axes
            });
            slots[index] = TangentAxes::new(u, v).0;
        });
        useless
    };
    let (columns, useless) = fill_blocks(rows.count, 1, job, convert, |a: usize, b| a + b)?;
    warnings.add(WarningKind::UnusableAxesIgnored, useless as u64);
    if useless > 0 {
        return Ok(());
    }
    origins.axes = Provenance::FromFile;
    for (block, column) in blocks.iter_mut().zip(columns) {
        block.axes = Some(column);
    }
    Ok(())
}

fn add_normals(
    rows: &Rows<'_>,
    winding: Winding,
    blocks: &mut [Block],
    origins: &mut Origins,
    job: &Job,
    warnings: &mut Warnings,
) -> Result<(), Cancelled> {
    if !rows.have(Property::NORMAL) && !rows.have(Property::AXES) {
        return Ok(());
    }
    let sign = winding.sign();
    let convert = |range: Range<usize>, slots: &mut [u32]| {
        let mut useless = 0;
        rows.each(range, |index, part, record| {
            let normal = normal(part, record) * sign;
            let largest = normal.abs().max_element();
            // Written so that NaN fails; scaled, so that what f64 holds f32 holds too.
            let is_useful = normal.is_finite() && largest > 0.0;
            useless += usize::from(!is_useful);
            slots[index] = if is_useful {
                encode_normal((normal / largest).as_vec3())
            } else {
                NO_NORMAL
            };
        });
        useless
    };
    let (columns, useless) = fill_blocks(rows.count, 1, job, convert, |a: usize, b| a + b)?;
    warnings.add(WarningKind::UnusableNormalsReplaced, useless as u64);
    if useless < rows.count {
        origins.normals = Provenance::FromFile;
        for (block, column) in blocks.iter_mut().zip(columns) {
            block.normal = Some(column);
        }
    }
    if winding == Winding::Flipped {
        warnings.add(WarningKind::Flipped, 1);
    }
    Ok(())
}

/// A column of the file's own; sets that lack it get weight 1, and 0 of everything else.
fn add_named(
    rows: &Rows<'_>,
    named: NamedProperty,
    blocks: &mut [Block],
    job: &Job,
    warnings: &mut Warnings,
) -> Result<(), Cancelled> {
    let size = named.scalar.size();
    let width = size * named.components;
    let absent: &[u8] = if named.name == "weight" {
        &1_f32.to_ne_bytes()
    } else {
        &[0; 12]
    };
    let convert = |range: Range<usize>, slots: &mut [u8]| {
        let mut invisible = 0;
        rows.each(range, |index, part, record| {
            let slot = &mut slots[index * width..(index + 1) * width];
            let stored = part.set.layout.offset(named.property);
            let stored = stored.and_then(|offset| record.get(offset..offset + width));
            let Some(stored) = stored else {
                slot.copy_from_slice(&absent[..width]);
                return;
            };
            slot.copy_from_slice(stored);
            if cfg!(target_endian = "little") {
                slot.chunks_exact_mut(size).for_each(<[u8]>::reverse);
            }
            if named.property == Property::FLAGS {
                let flags = stored.first_chunk().copied().map_or(0, u32::from_be_bytes);
                invisible += u64::from(flags & INVISIBLE != 0);
            }
        });
        invisible
    };
    let (columns, invisible) = fill_bytes(rows.count, width, job, convert, |a: u64, b| a + b)?;
    let text = "a surfel is flagged as invisible and shown all the same";
    warnings.add(WarningKind::Other(text.into()), invisible);
    push_named(blocks, named, columns);
    Ok(())
}

/// Which set each surfel is of.
fn add_set_indices(rows: &Rows<'_>, blocks: &mut [Block], job: &Job) -> Result<(), Cancelled> {
    let convert = |range: Range<usize>, slots: &mut [u8]| {
        let (slots, _) = slots.as_chunks_mut::<4>();
        rows.each(range, |index, part, _| {
            slots[index] = part.set_index.to_ne_bytes();
        });
    };
    let (columns, ()) = fill_bytes(rows.count, 4, job, convert, |(), ()| ())?;
    let named = NamedProperty {
        property: Property(u16::MAX),
        name: SET_COLUMN,
        scalar: ScalarType::U32,
        components: 1,
    };
    push_named(blocks, named, columns);
    Ok(())
}

/// Adds a column to the blocks.
pub(super) fn push_named(blocks: &mut [Block], named: NamedProperty, columns: ByteColumn) {
    let name: Arc<str> = named.name.into();
    for (block, bytes) in blocks.iter_mut().zip(columns) {
        block.named.push(NamedColumn {
            name: name.clone(),
            scalar: named.scalar,
            components: named.components as u32,
            bytes,
        });
    }
}
