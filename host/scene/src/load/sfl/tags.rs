//! Tags of SFL files, and their values.

use super::container::{Container, Directory, Entry, ValueType};
use super::error::SflError;

/// A tag.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Tag {
    pub(crate) number: u16,
    pub(crate) name: &'static str,
}

macro_rules! tags {
    ($($constant:ident = $number:literal, $name:literal;)*) => {
        impl Tag {
            $(pub(crate) const $constant: Self = Self { number: $number, name: $name };)*
        }
    };
}
tags! {
    TITLE = 0x0100, "title";
    APPLICATION = 0x0102, "application";
    RIGHT = 0x0110, "right direction";
    UP = 0x0111, "up direction";
    BACK = 0x0112, "back direction";
    BOUNDING_BOX = 0x0118, "bounding box";
    SET_LIST = 0x0120, "index of the list of surfel sets";
    SET_COUNT = 0x0130, "number of surfel sets";
    LEVEL_COUNT = 0x0140, "number of resolutions";
    SHOWN_LEVEL = 0x0141, "index of resolution 0";
    FORMAT_VERSION = 0x0150, "surfel format version";
    RECORD_SIZE = 0x0151, "record size";
    PROPERTIES = 0x0152, "property mask";
    PROPERTY_INDICES = 0x0153, "property numbers";
    PROPERTY_OFFSETS = 0x0154, "property offsets";
    TRANSFORM = 0x0161, "transform";
    IDENTIFIER = 0x0162, "identifier";
    SURFEL_COUNT = 0x0170, "number of surfels";
    RECORDS = 0x0171, "surfel records";
}

/// Tags whose values this reader checks and does not use.
const UNUSED: [u16; 13] = [
    0x0100, 0x0101, 0x0102, 0x0103, 0x0105, 0x0113, 0x0115, 0x0118, 0x0160, 0x0162, 0x0163, 0x0164,
    0x0165,
];

impl Tag {
    /// Where it stands; where the directory starts if it does not.
    pub(super) fn byte(self, directory: &Directory<'_>) -> u64 {
        directory
            .find(self.number)
            .map_or(directory.byte, |entry| entry.byte)
    }

    pub(super) fn missing(self, directory: &Directory<'_>, what: &'static str) -> SflError {
        SflError::MissingTag {
            byte: directory.byte,
            tag: format!("{} ({:#06x})", self.name, self.number),
            what,
        }
    }

    fn wrong(self, entry: &Entry<'_>, expected: &str) -> SflError {
        SflError::Value {
            byte: entry.byte,
            what: self.name.into(),
            expected: expected.into(),
            found: entry.describe(),
        }
    }
}

/// Big-endian numbers of a value.
#[derive(Clone, Copy, Debug)]
pub(super) struct List<'a, const SIZE: usize> {
    numbers: &'a [[u8; SIZE]],
}

impl<'a, const SIZE: usize> List<'a, SIZE> {
    fn new(bytes: &'a [u8]) -> Self {
        Self {
            numbers: bytes.as_chunks().0,
        }
    }

    pub(super) fn len(&self) -> usize {
        self.numbers.len()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }
}

impl<'a> List<'a, 4> {
    pub(super) fn get(&self, index: usize) -> Option<u32> {
        self.numbers.get(index).copied().map(u32::from_be_bytes)
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = u32> + use<'a> {
        self.numbers.iter().copied().map(u32::from_be_bytes)
    }
}

impl<'a> List<'a, 2> {
    pub(super) fn iter(&self) -> impl Iterator<Item = u16> + use<'a> {
        self.numbers.iter().copied().map(u16::from_be_bytes)
    }
}

/// A whole number; `None` if the tag is not there.
pub(super) fn u32_one(
    container: &Container<'_>,
    directory: &Directory<'_>,
    tag: Tag,
) -> Result<Option<u32>, SflError> {
    let Some(entry) = directory.find(tag.number) else {
        return Ok(None);
    };
    if entry.value_type() != ValueType::U32 || entry.count() != 1 {
        return Err(tag.wrong(&entry, "UINT32, 1 element"));
    }
    Ok(List::<4>::new(container.value_bytes(&entry, tag.name)?).get(0))
}

/// Whole numbers of 32 bits.
pub(super) fn u32_list<'a>(
    container: &Container<'a>,
    directory: &Directory<'a>,
    tag: Tag,
) -> Result<Option<List<'a, 4>>, SflError> {
    list(container, directory, tag, ValueType::U32)
}

/// Whole numbers of 16 bits.
pub(super) fn u16_list<'a>(
    container: &Container<'a>,
    directory: &Directory<'a>,
    tag: Tag,
) -> Result<Option<List<'a, 2>>, SflError> {
    list(container, directory, tag, ValueType::U16)
}

fn list<'a, const SIZE: usize>(
    container: &Container<'a>,
    directory: &Directory<'a>,
    tag: Tag,
    value_type: ValueType,
) -> Result<Option<List<'a, SIZE>>, SflError> {
    let Some(entry) = directory.find(tag.number) else {
        return Ok(None);
    };
    if entry.value_type() != value_type {
        return Err(tag.wrong(&entry, &format!("UINT{}", 8 * SIZE)));
    }
    Ok(Some(List::new(container.value_bytes(&entry, tag.name)?)))
}

/// Exactly `N` floats.
pub(super) fn floats<const N: usize>(
    container: &Container<'_>,
    directory: &Directory<'_>,
    tag: Tag,
) -> Result<Option<[f64; N]>, SflError> {
    let Some(entry) = directory.find(tag.number) else {
        return Ok(None);
    };
    if entry.value_type() != ValueType::F32 || entry.count() as usize != N {
        return Err(tag.wrong(&entry, &format!("FLOAT, {N} elements")));
    }
    let list = List::<4>::new(container.value_bytes(&entry, tag.name)?);
    Ok(Some(std::array::from_fn(|index| {
        list.get(index)
            .map_or(0.0, |bits| f64::from(f32::from_bits(bits)))
    })))
}

/// Refuses tags whose values reach beyond the file, also those that nothing comes of: such a file is damaged.
pub(super) fn check_unused(
    container: &Container<'_>,
    directory: &Directory<'_>,
) -> Result<(), SflError> {
    for number in UNUSED {
        if let Some(entry) = directory.find(number)
            && !matches!(entry.value_type(), ValueType::Other(_))
        {
            container.value_bytes(&entry, &format!("the value of tag {number:#06x}"))?;
        }
    }
    Ok(())
}
