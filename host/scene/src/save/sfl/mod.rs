//! SFL files, as PointShop3D's own library lays them out.
//!
//! Directories come depth first, each with its values behind it (`directory`); in a record comes first what has the larger
//! alignment (`record`). Where each thing lies is counted before anything is written, so `out` need not be able to seek.

mod directory;
mod record;

use std::io::Write;

use glam::{DAffine3, DVec3};

use super::columns::Present;
use super::{SaveError, Saving};
use crate::bounds::Bounds;
use crate::geometry::ScalarType;
use crate::job::Job;
use crate::load::sfl::{SET_COLUMN, Tag};
use crate::scene::Object;
use crate::warnings::{WarningKind, Warnings};
use directory::{Directory, ENTRY_BYTES, End, closing};
use record::Record;

/// The reference library's tables hold 1024 directories beside each other, the closing one included, and its reader does
/// not look whether there are more.
const MOST_SETS: u32 = 1023;

/// Offsets are of 32 bits.
const MOST_BYTES: u64 = u32::MAX as u64;

/// Bytes of the container's header.
const HEADER_BYTES: u64 = 20;

/// Version of the surfel format.
const FORMAT_VERSION: u32 = 1;

/// Writes an object as an SFL file.
///
/// Centres, radii, normals (as floats), colours (as diffuse colours, RGBA), tangent axes and the named columns that have the
/// name and the form of a property of SFL become properties. The object's origin and transform become the transform of the
/// set, in floats; what an origin loses by that is added to the centres. A column `surfel_set` cuts the object into sets.
/// Other named columns, triangles and textures are left out, with a warning.
///
/// # Errors
/// The file would be larger than 4 GiB, or `out` does not take it, or the job was cancelled.
pub fn write_sfl(object: &Object, job: &Job, out: &mut impl Write) -> Result<Warnings, SaveError> {
    let geometry = &object.geometry;
    let present = Present::of(geometry);
    let mut warnings = Warnings::new();
    if geometry.triangles.is_some() {
        let text = "SFL files hold no triangles: left out";
        warnings.add(WarningKind::Other(text.into()), 1);
    }
    if let Some(textures) = &geometry.textures {
        let text =
            "SFL files hold no textures: left out, the surfels keep the colours of their texels";
        warnings.add(
            WarningKind::Other(text.into()),
            textures.pictures.len() as u64,
        );
    }
    let sets = set_lengths(object);
    let record = Record::plan(&present, sets.is_some(), object.radius_scale, &mut warnings);
    let lengths = sets.unwrap_or_else(|| vec![geometry.surfel_count]);
    let placement = Placement::of(object);

    let mut root = Directory::default();
    root.text(Tag::TITLE, &object.name);
    root.text(Tag::APPLICATION, "Pointstage");
    push_box(&mut root, &object.bounds_world());
    root.u32s(Tag::SET_LIST, &[0]);
    let mut list = Directory::default();
    list.u32s(Tag::SET_COUNT, &[lengths.len() as u32]);
    let set = set_directory(object, &record, &placement);
    let levels: Vec<Level> = lengths
        .iter()
        .map(|count| Level::new(*count, &record))
        .collect();

    let list_at = HEADER_BYTES + root.byte_count(true);
    let first_set_at = list_at + list.byte_count(true);
    let set_bytes = |level: &Level| set.byte_count(true) + level.bytes + ENTRY_BYTES;
    let sets_end = first_set_at + levels.iter().map(set_bytes).sum::<u64>();
    let needed = sets_end + 3 * ENTRY_BYTES;
    if needed > MOST_BYTES {
        return Err(SaveError::TooLarge {
            format: "SFL",
            needed,
            most: MOST_BYTES,
        });
    }

    out.write_all(b"GFLF\0\0\0\0SFLF\0\0\0\0")?;
    out.write_all(&(HEADER_BYTES as u32).to_be_bytes())?;
    let root_end = sets_end + 2 * ENTRY_BYTES;
    out.write_all(&root.write(HEADER_BYTES, parent(root_end, list_at, 1)))?;
    let list_end = sets_end + ENTRY_BYTES;
    out.write_all(&list.write(
        list_at,
        parent(list_end, first_set_at, lengths.len() as u32),
    ))?;
    let mut surfels = geometry
        .blocks
        .iter()
        .flat_map(|block| (0..block.len()).map(move |surfel| (block, surfel)));
    let mut bytes = vec![0; record.bytes];
    let mut saving = Saving::new(job, geometry.surfel_count);
    let mut at = first_set_at;
    for (level, length) in levels.iter().zip(lengths) {
        let next = at + set_bytes(level);
        let level_at = at + set.byte_count(true);
        out.write_all(&set.write(at, parent(next, level_at, 1)))?;
        let level_end = level_at + level.bytes;
        out.write_all(
            &level
                .directory
                .write(level_at, End::Leaf { next: level_end }),
        )?;
        for (block, surfel) in surfels.by_ref().take(length) {
            saving.one_more()?;
            record.write(block, surfel, placement.residual, &mut bytes);
            out.write_all(&bytes)?;
        }
        out.write_all(&[0; 3][..level.padding])?;
        out.write_all(&closing(next))?;
        at = next;
    }
    for up in [list_end, root_end, 0] {
        out.write_all(&closing(up))?;
    }
    Ok(warnings)
}

fn parent(next: u64, first_child: u64, children: u32) -> End {
    End::Parent {
        next,
        first_child,
        children,
    }
}

/// The directory of a resolution, and what lies behind it.
struct Level {
    directory: Directory,
    /// Zeros behind the records.
    padding: usize,
    /// Bytes of directory, records and padding.
    bytes: u64,
}

impl Level {
    fn new(count: usize, record: &Record) -> Self {
        let records = count as u64 * record.bytes as u64;
        let padded = records.next_multiple_of(4);
        let mut directory = Directory::default();
        directory.u32s(Tag::SURFEL_COUNT, &[count as u32]);
        directory.block(Tag::RECORDS, records);
        Self {
            padding: (padded - records) as usize,
            bytes: directory.byte_count(false) + padded,
            directory,
        }
    }
}

fn set_directory(object: &Object, record: &Record, placement: &Placement) -> Directory {
    let mut set = Directory::default();
    set.u32s(Tag::LEVEL_COUNT, &[1]);
    set.u32s(Tag::FORMAT_VERSION, &[FORMAT_VERSION]);
    set.u32s(Tag::RECORD_SIZE, &[record.bytes as u32]);
    set.u32s(Tag::PROPERTIES, &record.mask());
    set.u16s(Tag::PROPERTY_INDICES, &record.indices());
    set.u32s(Tag::PROPERTY_OFFSETS, &record.offsets());
    push_box(
        &mut set,
        &object.geometry.bounds.translated(placement.residual),
    );
    if let Some(transform) = &placement.transform {
        set.f32s(Tag::TRANSFORM, transform);
    }
    set.text(Tag::IDENTIFIER, &object.name);
    set
}

fn push_box(directory: &mut Directory, bounds: &Bounds) {
    if !bounds.is_empty() {
        let corners = [bounds.min, bounds.max].map(|corner| corner.as_vec3().to_array());
        directory.f32s(Tag::BOUNDING_BOX, corners.as_flattened());
    }
}

/// Where an object stands, as the file says it.
struct Placement {
    /// Row by row; `None` for the identity.
    transform: Option<[f32; 16]>,
    /// What an origin in floats is short of; added to the centres.
    residual: DVec3,
}

impl Placement {
    fn of(object: &Object) -> Self {
        let map = object.world_from_local();
        if map == DAffine3::IDENTITY {
            return Self {
                transform: None,
                residual: DVec3::ZERO,
            };
        }
        let translation = map.translation.as_vec3();
        let residual = if object.world_from_object == DAffine3::IDENTITY {
            map.translation - translation.as_dvec3()
        } else {
            DVec3::ZERO
        };
        let [x, y, z] = map.matrix3.transpose().to_cols_array_2d();
        let row = |[a, b, c]: [f64; 3], d: f32| [a as f32, b as f32, c as f32, d];
        let rows = [
            row(x, translation.x),
            row(y, translation.y),
            row(z, translation.z),
            [0.0, 0.0, 0.0, 1.0],
        ];
        let mut transform = [0.0; 16];
        transform.copy_from_slice(rows.as_flattened());
        Self {
            transform: Some(transform),
            residual,
        }
    }
}

/// Surfels of each set, if a column cuts the object into sets that lie one behind the other.
fn set_lengths(object: &Object) -> Option<Vec<usize>> {
    let mut lengths = Vec::new();
    for block in &object.geometry.blocks {
        let column = block.named.iter().find(|column| {
            *column.name == *SET_COLUMN
                && column.scalar == ScalarType::U32
                && column.components == 1
        })?;
        for index in column
            .bytes
            .as_chunks()
            .0
            .iter()
            .copied()
            .map(u32::from_ne_bytes)
        {
            let index = (index < MOST_SETS).then_some(index as usize)?;
            if index + 1 < lengths.len() {
                return None;
            }
            lengths.resize(index + 1, 0);
            lengths[index] += 1;
        }
    }
    (!lengths.is_empty()).then_some(lengths)
}
