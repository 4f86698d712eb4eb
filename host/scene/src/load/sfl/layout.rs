//! Where each property stands in the records of a set.

use super::container::{Container, Directory};
use super::error::SflError;
use super::normal::CubicCode;
use super::property::{ColourModel, NAMED, Property};
use super::tags::{Tag, u16_list, u32_list, u32_one};

/// Far more properties than there are. Sets can share a list, so one that filled the file would be read again and again.
const MOST_PROPERTIES: usize = 4096;

/// How normals are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NormalForm {
    /// Three floats.
    Floats,
    Packed(CubicCode),
}

/// The records of a set.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    /// Bytes from a record to the next; above 0 if there are records.
    pub(super) record_bytes: usize,
    pub(super) normal_form: NormalForm,
    pub(super) colour_model: Option<ColourModel>,
    /// Offset of each property in a record; all of it lies inside.
    offsets: [Option<u32>; Property::COUNT],
    /// The rays are listed, which the reference writer put over other properties.
    pub(super) has_rays: bool,
}

impl Layout {
    /// Where a property starts in a record, if the records have it.
    #[inline]
    pub(super) fn offset(&self, property: Property) -> Option<usize> {
        let offset = self.offsets.get(usize::from(property.0)).copied().flatten();
        offset.map(|offset| offset as usize)
    }

    /// Bytes of a property; `None` if it is unknown or none.
    fn size(&self, property: Property) -> Option<usize> {
        Some(match property {
            Property::POSITION => 12,
            Property::NORMAL => match self.normal_form {
                NormalForm::Floats => 12,
                NormalForm::Packed(CubicCode::Bits16) => 2,
                NormalForm::Packed(CubicCode::Bits32) => 4,
            },
            Property::RADIUS => 4,
            Property::AXES => 24,
            _ if property.is_colour() => self.colour_model?.size(),
            _ => {
                let named = NAMED.iter().find(|named| named.property == property)?;
                named.scalar.size() * named.components
            }
        })
    }

    /// Reads the layout of a set.
    pub(super) fn read(container: &Container<'_>, set: &Directory<'_>) -> Result<Self, SflError> {
        let missing = |tag: Tag| tag.missing(set, "a surfel set");
        let version = u32_one(container, set, Tag::FORMAT_VERSION)?.unwrap_or(0);
        if version >> 16 != 0 {
            return Err(SflError::Version {
                byte: Tag::FORMAT_VERSION.byte(set),
                what: "the surfel format's version",
                found: version,
            });
        }
        let record_bytes =
            u32_one(container, set, Tag::RECORD_SIZE)?.ok_or_else(|| missing(Tag::RECORD_SIZE))?;
        let mask = u32_list(container, set, Tag::PROPERTIES)?
            .filter(|words| !words.is_empty())
            .ok_or_else(|| missing(Tag::PROPERTIES))?;
        let indices = u16_list(container, set, Tag::PROPERTY_INDICES)?
            .ok_or_else(|| missing(Tag::PROPERTY_INDICES))?;
        let offsets = u32_list(container, set, Tag::PROPERTY_OFFSETS)?
            .ok_or_else(|| missing(Tag::PROPERTY_OFFSETS))?;
        if indices.len() != offsets.len() {
            return Err(SflError::Value {
                byte: Tag::PROPERTY_OFFSETS.byte(set),
                what: "offsets of properties in a record".into(),
                expected: format!("{} as there are property numbers", indices.len()),
                found: offsets.len().to_string(),
            });
        }
        if indices.len() > MOST_PROPERTIES {
            return Err(SflError::Value {
                byte: Tag::PROPERTY_INDICES.byte(set),
                what: "property numbers".into(),
                expected: format!("{MOST_PROPERTIES} or fewer"),
                found: indices.len().to_string(),
            });
        }
        let is_in_mask = |index: u16| {
            let word = mask.get(usize::from(index / 32)).unwrap_or(0);
            word >> (index % 32) & 1 == 1
        };
        let first_word = mask.get(0).unwrap_or(0);
        let listed = || {
            indices
                .iter()
                .zip(offsets.iter())
                .filter(|(index, _)| is_in_mask(*index))
                .map(|(index, offset)| (Property(index), offset))
        };
        let lists = |property: Property| listed().any(|(listed, _)| listed == property);
        let mask_byte = Tag::PROPERTIES.byte(set);
        let mut layout = Self {
            record_bytes: record_bytes as usize,
            normal_form: normal_form(first_word, lists(Property::NORMAL), mask_byte)?,
            colour_model: colour_model(
                first_word,
                listed().any(|(property, _)| property.is_colour()),
                mask_byte,
            )?,
            offsets: [None; Property::COUNT],
            has_rays: Property::RAYS.into_iter().any(lists),
        };
        // In the first version of the format both followed from the axes, whatever the mask said.
        let only_axes = version == 0 && lists(Property::AXES);
        for (property, offset) in listed() {
            let Some(size) = layout.size(property) else {
                continue;
            };
            if u64::from(offset) + size as u64 > u64::from(record_bytes) {
                return Err(SflError::Value {
                    byte: Tag::PROPERTY_OFFSETS.byte(set),
                    what: format!("offset of property {} with its {size} bytes", property.0),
                    expected: format!("an end within the record of {record_bytes} bytes"),
                    found: offset.to_string(),
                });
            }
            let follows = only_axes && [Property::NORMAL, Property::RADIUS].contains(&property);
            let slot = &mut layout.offsets[usize::from(property.0)];
            if !follows && slot.is_none() {
                *slot = Some(offset);
            }
        }
        Ok(layout)
    }
}

fn normal_form(mask: u32, is_listed: bool, byte: u64) -> Result<NormalForm, SflError> {
    match mask >> 2 & 3 {
        2 => Ok(NormalForm::Packed(CubicCode::Bits16)),
        3 => Ok(NormalForm::Packed(CubicCode::Bits32)),
        1 if is_listed => Err(SflError::Unsupported {
            byte,
            what: "the normal",
            found: "an icosahedral code of 8 bits".into(),
            advice: "another compression of normals",
        }),
        _ => Ok(NormalForm::Floats),
    }
}

fn colour_model(mask: u32, is_listed: bool, byte: u64) -> Result<Option<ColourModel>, SflError> {
    match ColourModel::from_mask(mask) {
        Ok(model) => Ok(model),
        Err(_) if !is_listed => Ok(None),
        Err(bits) => Err(SflError::Unsupported {
            byte,
            what: "the colour",
            found: format!("colour model {bits:#010x}"),
            advice: "RGB or RGBA",
        }),
    }
}
