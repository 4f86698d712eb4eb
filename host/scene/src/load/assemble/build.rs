//! Tables of vertices into surfel columns.
//!
//! Positions come first (see `place`): one pass places all vertices, measures their box and counts those that are not
//! finite. If some are not, or if the box is far from the origin, a second pass places the good ones around an origin of
//! their own. Axes, normals, colours and named columns follow, of the vertices that were kept.

use std::ops::Range;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use pointstage_plugin_api::columns::{NO_NORMAL, TangentAxes, encode_normal};

use super::AssembleError;
use super::place::{Placed, new_indices, origin_for, place, relative};
use super::roles::{NamedRole, Roles};
use super::table::{Field, Piece, RowSelection};
use crate::bounds::Bounds;
use crate::geometry::{Block, NamedColumn, Origins, Provenance, ScalarType};
use crate::job::{Cancelled, Job};
use crate::load::Winding;
use crate::load::fill::{Column, PIECE_SURFELS, fill_blocks, fill_bytes};
use crate::warnings::{WarningKind, Warnings};

/// The columns of a file.
#[derive(Debug)]
pub(in crate::load) struct Built {
    pub(in crate::load) blocks: Vec<Block>,
    pub(in crate::load) origin: DVec3,
    /// Relative to `origin`.
    pub(in crate::load) bounds: Bounds,
    /// New index of each row, `u32::MAX` for dropped ones; `None` when all were kept.
    pub(in crate::load) new_index: Option<Vec<u32>>,
    pub(in crate::load) origins: Origins,
}

/// Builds the columns of `row_count` vertices.
pub(in crate::load) fn build(
    roles: &Roles<'_>,
    row_count: usize,
    winding: Winding,
    job: &Job,
    warnings: &mut Warnings,
) -> Result<Built, AssembleError> {
    let mut rows = RowSelection::All(row_count);
    // Where the box is not known yet, most files are near 0.
    let guess = roles
        .bounds
        .map_or(DVec3::ZERO, |bounds| origin_for(&bounds));
    let (mut positions, mut placed) = place(roles, &rows, guess, job)?;
    let origin = origin_for(&placed.bounds);
    let new_index = (placed.not_finite > 0).then(|| new_indices(roles, row_count));
    if let Some(new_index) = &new_index {
        warnings.add(
            WarningKind::NonFinitePositionsDropped,
            placed.not_finite as u64,
        );
        let kept = (0..row_count as u32)
            .zip(new_index)
            .filter(|(_, index)| **index != u32::MAX)
            .map(|(row, _)| row);
        rows = RowSelection::Kept(kept.collect());
        if rows.len() == 0 {
            return Err(AssembleError::NothingFinite {
                count: row_count as u64,
            });
        }
    }
    if new_index.is_some() || origin != guess {
        (positions, placed) = place(roles, &rows, origin, job)?;
    }
    if roles.z.is_none() {
        warnings.add(WarningKind::NoZ, 1);
    }
    let mut origins = Origins::default();
    if roles.radius.is_some() && placed.without_radius < rows.len() {
        origins.radii = Provenance::FromFile;
    }
    warn_of_radii(roles, &placed, warnings);
    let mut blocks: Vec<Block> = positions
        .into_iter()
        .map(|position_radius| Block {
            position_radius,
            ..Block::default()
        })
        .collect();
    add_axes(
        roles,
        &rows,
        winding,
        &mut blocks,
        &mut origins,
        job,
        warnings,
    )?;
    add_normals(
        roles,
        &rows,
        winding,
        &mut blocks,
        &mut origins,
        job,
        warnings,
    )?;
    add_colours(roles, &rows, &mut blocks, &mut origins, job)?;
    add_named(&roles.named, &rows, &mut blocks, job)?;
    Ok(Built {
        blocks,
        origin,
        bounds: relative(&placed.bounds, origin),
        new_index,
        origins,
    })
}

fn warn_of_radii(roles: &Roles<'_>, placed: &Placed, warnings: &mut Warnings) {
    if roles.radius.is_some() {
        warnings.add(
            WarningKind::UnusableRadiiReplaced,
            placed.without_radius as u64,
        );
    }
}

/// Axes, with the normals and radii that follow from them. Columns with any useless axes are left out.
fn add_axes(
    roles: &Roles<'_>,
    rows: &RowSelection,
    winding: Winding,

    blocks: &mut [Block],
    origins: &mut Origins,
    job: &Job,
    warnings: &mut Warnings,
) -> Result<(), Cancelled> {
    let Some(axes) = roles.axes else {
        return Ok(());
    };
    let fields = axes.map(Some);
    let convert = |range: Range<usize>, slots: &mut [[f32; 8]]| {
        let piece = Piece::read(&fields, rows, &range);
        let mut useless = 0;
        for (index, slot) in slots.iter_mut().enumerate() {
            let [ux, uy, uz, vx, vy, vz] =
                std::array::from_fn(|field| piece.values[field][index] as f32);
            let (u, v) = (Vec3::new(ux, uy, uz), Vec3::new(vx, vy, vz));
            useless += usize::from(!(u.is_finite() && v.is_finite() && u.cross(v).length() > 0.0));
            *slot = TangentAxes::new(u, v).0;
        }
        useless
    };
    let (columns, useless) = fill_blocks(rows.len(), 1, job, convert, |a: usize, b| a + b)?;
    warnings.add(WarningKind::UnusableAxesIgnored, useless as u64);
    if useless > 0 {
        return Ok(());
    }
    origins.axes = Provenance::FromFile;
    for (block, column) in blocks.iter_mut().zip(columns) {
        if origins.radii == Provenance::Missing {
            let slots = Arc::make_mut(&mut block.position_radius);
            for (slot, axes) in slots.iter_mut().zip(column.iter()) {
                let axes = TangentAxes(*axes);
                slot[3] = axes.u().length().max(axes.v().length());
            }
        }
        if roles.normal.is_none() {
            let sign = winding.sign() as f32;
            let normal = |axes: &[f32; 8]| {
                encode_normal(TangentAxes(*axes).u().cross(TangentAxes(*axes).v()) * sign)
            };
            block.normal = Some(column.iter().map(normal).collect());
            origins.normals = Provenance::FromFile;
        }
        block.axes = Some(column);
    }
    if origins.radii == Provenance::Missing {
        origins.radii = Provenance::FromFile;
    }
    Ok(())
}

fn add_normals(
    roles: &Roles<'_>,
    rows: &RowSelection,
    winding: Winding,
    blocks: &mut [Block],
    origins: &mut Origins,
    job: &Job,
    warnings: &mut Warnings,
) -> Result<(), Cancelled> {
    let Some(normal) = roles.normal else {
        return Ok(());
    };
    let fields = normal.map(Some);
    let sign = winding.sign();
    let convert = |range: Range<usize>, slots: &mut [u32]| {
        let piece = Piece::read(&fields, rows, &range);
        let [xs, ys, zs] = &piece.values;
        let mut useless = 0;
        for (index, slot) in slots.iter_mut().enumerate() {
            let normal = DVec3::new(xs[index], ys[index], zs[index]) * sign;
            let is_useful = normal.is_finite() && normal != DVec3::ZERO;
            useless += usize::from(!is_useful);
            *slot = if is_useful {
                encode_normal(normal.as_vec3())
            } else {
                NO_NORMAL
            };
        }
        useless
    };
    let (columns, useless) = fill_blocks(rows.len(), 1, job, convert, |a: usize, b| a + b)?;
    warnings.add(WarningKind::UnusableNormalsReplaced, useless as u64);
    if useless < rows.len() {
        origins.normals = Provenance::FromFile;
        for (block, column) in blocks.iter_mut().zip(columns) {
            block.normal = Some(column);
        }
    }
    Ok(())
}

fn add_colours(
    roles: &Roles<'_>,
    rows: &RowSelection,
    blocks: &mut [Block],
    origins: &mut Origins,
    job: &Job,
) -> Result<(), Cancelled> {
    let Some([red, green, blue]) = roles.colour else {
        return Ok(());
    };
    let fields = [Some(red), Some(green), Some(blue), roles.alpha];
    let are_bytes = fields
        .iter()
        .flatten()
        .all(|field| matches!(field.scalar, ScalarType::U8 | ScalarType::I8));
    let columns = if are_bytes {
        let copy = |range: Range<usize>, slots: &mut [u32]| {
            let mut bytes = [[255; PIECE_SURFELS]; 4];
            for (field, bytes) in fields.iter().zip(&mut bytes) {
                if let Some(field) = field {
                    field.read_bytes(rows, range.clone(), &mut bytes[..range.len()]);
                }
            }
            for (index, slot) in slots.iter_mut().enumerate() {
                *slot = u32::from_le_bytes(bytes.each_ref().map(|bytes| bytes[index]));
            }
        };
        fill_blocks(rows.len(), 1, job, copy, |(), ()| ())?.0
    } else {
        scaled_colours(&fields, rows, job)?
    };
    origins.colours = Provenance::FromFile;
    for (block, column) in blocks.iter_mut().zip(columns) {
        block.colour = Some(column);
    }
    Ok(())
}

/// Colours of components that are not all bytes.
fn scaled_colours(
    fields: &[Option<Field<'_>>; 4],
    rows: &RowSelection,
    job: &Job,
) -> Result<Column<u32>, Cancelled> {
    let scales = colour_scales(fields, rows, job)?;
    let convert = |range: Range<usize>, slots: &mut [u32]| {
        let piece = Piece::read(fields, rows, &range);
        for (index, slot) in slots.iter_mut().enumerate() {
            let byte = |component: usize| match fields[component] {
                None => 255,
                // Some writers call a byte `char`; its bits are meant.
                Some(field) if field.scalar == ScalarType::I8 => {
                    piece.values[component][index] as i8 as u8
                }
                // Cut towards 0, which is the floor of what is not below 0; saturates, and NaN gives 0.
                Some(_) => (piece.values[component][index] * scales[component] + 0.5) as u8,
            };
            *slot = u32::from_le_bytes([byte(0), byte(1), byte(2), byte(3)]);
        }
    };
    Ok(fill_blocks(rows.len(), 1, job, convert, |(), ()| ())?.0)
}

/// What a component is multiplied by to give a byte. Floats go from 0 to 1; if the largest colour is above 1, to 255.
fn colour_scales(
    fields: &[Option<Field<'_>>; 4],
    rows: &RowSelection,
    job: &Job,
) -> Result<[f64; 4], Cancelled> {
    let is_float = |field: &Field<'_>| matches!(field.scalar, ScalarType::F32 | ScalarType::F64);
    let mut largest = 0.0_f64;
    for field in fields.iter().flatten().filter(|field| is_float(field)) {
        let mut values = [0.0; PIECE_SURFELS];
        for start in (0..rows.len()).step_by(PIECE_SURFELS) {
            let range = start..rows.len().min(start + PIECE_SURFELS);
            let values = &mut values[..range.len()];
            field.read(rows, range, values);
            largest = values
                .iter()
                .fold(largest, |largest, value| largest.max(*value));
        }
        job.check()?;
    }
    // A little above 1 is a rounding of 1.
    let float_scale = if largest > 1.5 { 1.0 } else { 255.0 };
    Ok(fields.map(|field| match field.map(|field| field.scalar) {
        Some(ScalarType::F32 | ScalarType::F64) => float_scale,
        Some(ScalarType::U16) => 255.0 / 65535.0,
        _ => 1.0,
    }))
}

fn add_named(
    named: &[NamedRole<'_>],
    rows: &RowSelection,
    blocks: &mut [Block],
    job: &Job,
) -> Result<(), Cancelled> {
    for role in named {
        let size = role.scalar.size();
        let width = size * role.fields.len();
        let convert = |range: Range<usize>, slots: &mut [u8]| {
            for (surfel, slots) in range.zip(slots.chunks_exact_mut(width)) {
                let row = match rows {
                    RowSelection::All(_) => surfel,
                    RowSelection::Kept(kept) => kept[surfel] as usize,
                };
                for (field, slot) in role.fields.iter().zip(slots.chunks_exact_mut(size)) {
                    field.copy_native(row, slot);
                }
            }
        };
        let (columns, ()) = fill_bytes(rows.len(), width, job, convert, |(), ()| ())?;
        let name: Arc<str> = role.name.as_str().into();
        for (block, bytes) in blocks.iter_mut().zip(columns) {
            let components = role.fields.len() as u32;
            block.named.push(NamedColumn {
                name: name.clone(),
                scalar: role.scalar,
                components,
                bytes,
            });
        }
    }
    Ok(())
}
