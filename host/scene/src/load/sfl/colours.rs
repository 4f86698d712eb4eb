//! Colours of records: the one that is shown, and those that are kept beside it.

use std::ops::Range;

use super::build::push_named;
use super::property::{ColourModel, NamedProperty, Property};
use super::rows::{Part, Rows};
use crate::geometry::{Block, Origins, Provenance};
use crate::job::{Cancelled, Job};
use crate::load::fill::{fill_blocks, fill_bytes};

/// Opaque white, for sets without colours beside sets with them.
const WHITE: u32 = u32::MAX;

/// The colour that is shown of a set, with its place in a record.
fn shown_colour(part: &Part<'_>) -> Option<(Property, ColourModel, usize)> {
    let layout = &part.set.layout;
    let model = layout.colour_model?;
    [Property::DIFFUSE, Property::AMBIENT, Property::SPECULAR]
        .into_iter()
        .find_map(|property| Some((property, model, layout.offset(property)?)))
}

/// Colours; returns the property that each part's came from.
pub(super) fn add_colours(
    rows: &Rows<'_>,
    blocks: &mut [Block],
    origins: &mut Origins,
    job: &Job,
) -> Result<Vec<(u32, Property)>, Cancelled> {
    let coloured: Vec<(u32, Property)> = rows
        .parts
        .iter()
        .filter_map(|part| Some((part.set_index, shown_colour(part)?.0)))
        .collect();
    if coloured.is_empty() {
        return Ok(coloured);
    }
    let convert = |range: Range<usize>, slots: &mut [u32]| {
        rows.each(range, |index, part, record| {
            slots[index] = shown_colour(part).map_or(WHITE, |(_, model, offset)| {
                let bytes = record.get(offset..offset + model.size());
                u32::from_le_bytes(model.rgba(bytes.unwrap_or_default()))
            });
        });
    };
    let (columns, ()) = fill_blocks(rows.count, 1, job, convert, |(), ()| ())?;
    origins.colours = Provenance::FromFile;
    for (block, column) in blocks.iter_mut().zip(columns) {
        block.colour = Some(column);
    }
    Ok(coloured)
}

/// A colour that is stored beside the one that is shown; white in sets that lack it or show it.
pub(super) fn add_other_colours(
    rows: &Rows<'_>,
    named: NamedProperty,
    coloured: &[(u32, Property)],
    blocks: &mut [Block],
    job: &Job,
) -> Result<(), Cancelled> {
    let is_shown = |part: &Part<'_>| coloured.contains(&(part.set_index, named.property));
    let place = |part: &Part<'_>| {
        let offset = part.set.layout.offset(named.property)?;
        (!is_shown(part)).then_some((offset, part.set.layout.colour_model?))
    };
    if rows.parts.iter().all(|part| place(part).is_none()) {
        return Ok(());
    }
    let convert = |range: Range<usize>, slots: &mut [u8]| {
        let (slots, _) = slots.as_chunks_mut::<4>();
        rows.each(range, |index, part, record| {
            slots[index] = place(part).map_or([255; 4], |(offset, model)| {
                let bytes = record.get(offset..offset + model.size());
                model.rgba(bytes.unwrap_or_default())
            });
        });
    };
    let (columns, ()) = fill_bytes(rows.count, 4, job, convert, |(), ()| ())?;
    push_named(blocks, named, columns);
    Ok(())
}

/// Y, U, V and alpha as they are stored, since converting them loses something; 0 in sets of another model.
pub(super) fn add_raw_yuv(
    rows: &Rows<'_>,
    mut named: NamedProperty,
    blocks: &mut [Block],
    job: &Job,
) -> Result<(), Cancelled> {
    let place = |part: &Part<'_>| {
        let model = part
            .set
            .layout
            .colour_model
            .filter(|model| model.is_yuv())?;
        Some((part.set.layout.offset(named.property)?, model.size()))
    };
    if rows.parts.iter().all(|part| place(part).is_none()) {
        return Ok(());
    }
    let convert = |range: Range<usize>, slots: &mut [u8]| {
        let (slots, _) = slots.as_chunks_mut::<4>();
        rows.each(range, |index, part, record| {
            let Some((offset, size)) = place(part) else {
                return;
            };
            let stored = record.get(offset..offset + size).unwrap_or_default();
            slots[index] = std::array::from_fn(|index| stored.get(index).copied().unwrap_or(255));
        });
    };
    let (columns, ()) = fill_bytes(rows.count, 4, job, convert, |(), ()| ())?;
    named.name = match named.property {
        Property::AMBIENT => "ambient_yuv",
        Property::SPECULAR => "specular_yuv",
        _ => "diffuse_yuv",
    };
    push_named(blocks, named, columns);
    Ok(())
}
