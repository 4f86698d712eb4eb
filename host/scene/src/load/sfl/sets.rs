//! The directories of an SFL file: root, list of sets, sets, resolutions.

use glam::{DAffine3, DMat3, DVec3};

use super::container::{Container, Directory};
use super::error::SflError;
use super::layout::Layout;
use super::resolution::Resolution;
use super::tags::{Tag, check_unused, floats, u32_one};
use crate::load::assemble::MAX_COORDINATE;
use crate::warnings::{WarningKind, Warnings};

/// What a file holds, as far as it is shown.
#[derive(Debug)]
pub(super) struct SurfelFile<'a> {
    /// Map from the file's axes to x to the right, y up, z towards the viewer.
    pub(super) standard_from_file: DAffine3,
    pub(super) sets: Vec<SurfelSet<'a>>,
}

/// One object of the file.
#[derive(Debug)]
pub(super) struct SurfelSet<'a> {
    pub(super) layout: Layout,
    /// Map from the set's positions to the file's world, both in the file's axes.
    pub(super) world_from_set: DAffine3,
    /// The records of the resolution that is shown.
    pub(super) records: &'a [u8],
    pub(super) count: usize,
}

impl<'a> SurfelFile<'a> {
    /// Reads the directories and finds the records.
    pub(super) fn read(
        file: &'a [u8],
        resolution: Resolution,
        warnings: &mut Warnings,
    ) -> Result<Self, SflError> {
        let (mut container, root) = Container::open(file)?;
        check_unused(&container, &root)?;
        let standard_from_file = axes(&container, &root, warnings)?;
        let list_index = u32_one(&container, &root, Tag::SET_LIST)?.unwrap_or(0);
        let list = container.child(&root, list_index)?.ok_or_else(|| {
            too_few(
                Tag::SET_LIST,
                &root,
                "one below the number of children",
                list_index,
            )
        })?;
        let set_count = u32_one(&container, &list, Tag::SET_COUNT)?.unwrap_or(0);
        let mut sets = Vec::new();
        let mut bytes_left = file.len();
        let mut next = if set_count > 0 {
            container.first_child(&list)?
        } else {
            None
        };
        for index in 0..set_count {
            let directory = next.ok_or_else(|| {
                let expected = format!("{index} as there are directories");
                too_few(Tag::SET_COUNT, &list, &expected, set_count)
            })?;
            let set = SurfelSet::read(&mut container, &directory, resolution, warnings)?;
            // Records that overlap would make much of little.
            bytes_left = bytes_left
                .checked_sub(set.records.len())
                .ok_or(SflError::Overlap {
                    byte: directory.byte,
                })?;
            sets.push(set);
            next = if index + 1 < set_count {
                container.next_sibling(&directory)?
            } else {
                None
            };
        }
        Ok(Self {
            standard_from_file,
            sets,
        })
    }
}

impl<'a> SurfelSet<'a> {
    fn read(
        container: &mut Container<'a>,
        directory: &Directory<'a>,
        resolution: Resolution,
        warnings: &mut Warnings,
    ) -> Result<Self, SflError> {
        check_unused(container, directory)?;
        let layout = Layout::read(container, directory)?;
        if layout.has_rays {
            let text = "the rays of normal info are stored over other properties, usually the positions, which they destroyed";
            warnings.add(WarningKind::Other(text.into()), 1);
        }
        let world_from_set = match floats(container, directory, Tag::TRANSFORM)? {
            None => DAffine3::IDENTITY,
            Some(values) => affine(&values).unwrap_or_else(|| {
                let text = "the transform of a surfel set cannot be inverted: left out";
                warnings.add(WarningKind::Other(text.into()), 1);
                DAffine3::IDENTITY
            }),
        };
        let level_count = u32_one(container, directory, Tag::LEVEL_COUNT)?.unwrap_or(1);
        let shown = u32_one(container, directory, Tag::SHOWN_LEVEL)?;
        let mut set = Self {
            layout,
            world_from_set,
            records: &[],
            count: 0,
        };
        let Some(last) = level_count.checked_sub(1) else {
            return Ok(set);
        };
        let shown = shown.unwrap_or(last);
        if shown > last {
            let expected = format!("one below the {level_count} resolutions");
            return Err(too_few(Tag::SHOWN_LEVEL, directory, &expected, shown));
        }
        // What lies behind the resolution that is wanted need not be there.
        let wanted = match resolution {
            Resolution::AsFile => shown,
            Resolution::Finest | Resolution::Coarsest => last,
        };
        let mut levels = Vec::new();
        let mut next = container.first_child(directory)?;
        for index in 0..=wanted {
            let level = next.ok_or_else(|| {
                let expected = format!("{index} as there are directories");
                too_few(Tag::LEVEL_COUNT, directory, &expected, level_count)
            })?;
            next = if index < wanted {
                container.next_sibling(&level)?
            } else {
                None
            };
            levels.push(level);
        }
        let counts: Vec<u32> = levels
            .iter()
            .map(|level| Ok(u32_one(container, level, Tag::SURFEL_COUNT)?.unwrap_or(0)))
            .collect::<Result<_, SflError>>()?;
        let chosen = resolution.choose(&counts, shown as usize);
        let text = "a resolution is left out, since another one of its set is loaded";
        warnings.add(WarningKind::Other(text.into()), u64::from(last));
        let level = &levels[chosen];
        set.read_records(container, level)?;
        Ok(set)
    }

    fn read_records(
        &mut self,
        container: &Container<'a>,
        level: &Directory<'a>,
    ) -> Result<(), SflError> {
        let count = u32_one(container, level, Tag::SURFEL_COUNT)?.unwrap_or(0);
        if count == 0 {
            return Ok(());
        }
        let entry = level
            .find(Tag::RECORDS.number)
            .ok_or_else(|| Tag::RECORDS.missing(level, "a resolution"))?;
        if entry.value_type() != super::container::ValueType::Block {
            return Err(SflError::Value {
                byte: entry.byte,
                what: Tag::RECORDS.name.into(),
                expected: "LDB".into(),
                found: entry.describe(),
            });
        }
        let block = container.value_bytes(&entry, Tag::RECORDS.name)?;
        let record_bytes = self.layout.record_bytes;
        let wanted = u64::from(count) * record_bytes as u64;
        let records = usize::try_from(wanted)
            .ok()
            .filter(|wanted| *wanted > 0)
            .and_then(|wanted| block.get(..wanted));
        self.records = records.ok_or_else(|| SflError::Value {
            byte: entry.byte,
            what: format!("{count} surfels of {record_bytes} bytes"),
            expected: format!("{wanted} bytes or more, and more than 0"),
            found: block.len().to_string(),
        })?;
        self.count = count as usize;
        if self
            .layout
            .offset(super::property::Property::POSITION)
            .is_none()
        {
            return Err(SflError::MissingTag {
                byte: level.byte,
                tag: "'position' among the properties".into(),
                what: "the surfel set above",
            });
        }
        Ok(())
    }
}

fn too_few(tag: Tag, directory: &Directory<'_>, expected: &str, found: u32) -> SflError {
    SflError::Value {
        byte: tag.byte(directory),
        what: tag.name.into(),
        expected: expected.into(),
        found: found.to_string(),
    }
}

/// The inverse of the matrix whose columns are right, up and back.
fn axes(
    container: &Container<'_>,
    root: &Directory<'_>,
    warnings: &mut Warnings,
) -> Result<DAffine3, SflError> {
    let mut columns = [DVec3::X, DVec3::Y, DVec3::Z];
    for (column, tag) in columns.iter_mut().zip([Tag::RIGHT, Tag::UP, Tag::BACK]) {
        if let Some(direction) = floats(container, root, tag)? {
            *column = DVec3::from_array(direction);
        }
    }
    let [right, up, back] = columns;
    let file_from_standard = DMat3::from_cols(right, up, back);
    if file_from_standard == DMat3::IDENTITY {
        return Ok(DAffine3::IDENTITY);
    }
    if !can_be_inverted(&file_from_standard) {
        let text = "the file's right, up and back directions span no space: taken as x, y and z";
        warnings.add(WarningKind::Other(text.into()), 1);
        return Ok(DAffine3::IDENTITY);
    }
    Ok(DAffine3::from_mat3(file_from_standard.inverse()))
}

/// Written so that NaN fails.
fn can_be_inverted(matrix: &DMat3) -> bool {
    let largest = matrix.to_cols_array().map(f64::abs);
    largest.iter().all(|value| *value <= MAX_COORDINATE)
        && matrix.determinant().abs() > 0.0
        && matrix.inverse().is_finite()
}

/// The map of a 4×4 matrix, row by row; `None` if it cannot be inverted.
fn affine(values: &[f64; 16]) -> Option<DAffine3> {
    let row = |index: usize| DVec3::new(values[index], values[index + 1], values[index + 2]);
    let matrix = DMat3::from_cols(row(0), row(4), row(8)).transpose();
    let translation = DVec3::new(values[3], values[7], values[11]);
    let is_near = translation.abs().max_element() <= MAX_COORDINATE;
    (can_be_inverted(&matrix) && is_near).then_some(DAffine3 {
        matrix3: matrix,
        translation,
    })
}
