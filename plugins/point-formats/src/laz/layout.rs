//! Which fields a record has and how they are compressed.

use ::laz::{LazItem, LazItemType};

use super::by_crate::Items;
use super::{colour, infrared, point10, point14};

/// Extra bytes of a record that are ours: each has a model of 1 KB in each chunk that is being decompressed.
const MOST_EXTRA_BYTES: u16 = 64;

/// How records are compressed, and who decompresses them.
#[derive(Clone, Debug)]
pub(super) enum Format {
    Own(Layout),
    Crate(Items),
}

impl Format {
    /// Of a record of such items.
    ///
    /// # Errors
    /// Nobody knows them.
    pub(super) fn of(items: &[LazItem]) -> Result<Self, String> {
        match Layout::of(items) {
            Some(layout) => Ok(Self::Own(layout)),
            None => Items::of(items).map(Self::Crate),
        }
    }

    /// Bytes of a record.
    pub(super) fn stride(&self) -> usize {
        match self {
            Self::Own(layout) => layout.stride(),
            Self::Crate(items) => items.stride,
        }
    }
}

/// The fields of a record that we decompress ourselves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Layout {
    /// Whether each field has a stream of its own, as in the point formats 6 to 10.
    pub(super) is_layered: bool,
    /// Whether a time follows the point; in layered ones it is part of the point.
    pub(super) has_time: bool,
    pub(super) has_colour: bool,
    /// Whether near infrared follows the colour.
    pub(super) has_infrared: bool,
    pub(super) extra_bytes: u16,
}

impl Layout {
    /// The layout of a record of such items; `None` for those that are left to the crate `laz`: other versions, very many extra
    /// bytes, wave packets.
    pub(crate) fn of(items: &[LazItem]) -> Option<Self> {
        let items: Vec<_> = items
            .iter()
            .map(|item| (item.item_type(), item.version()))
            .collect();
        let (is_layered, mut rest) = match items.split_first()? {
            ((LazItemType::Point10, 2), rest) => (false, rest),
            ((LazItemType::Point14, 3), rest) => (true, rest),
            _ => return None,
        };
        let extra_bytes = match (is_layered, rest) {
            (false, [.., (LazItemType::Byte(count), 2)])
            | (true, [.., (LazItemType::Byte14(count), 3)]) => *count,
            _ => 0,
        };
        if extra_bytes > MOST_EXTRA_BYTES {
            return None;
        }
        if extra_bytes > 0 {
            rest = rest.split_last()?.1;
        }
        let (has_time, has_colour, has_infrared) = match (is_layered, rest) {
            (_, []) => (false, false, false),
            (false, [(LazItemType::GpsTime, 2)]) => (true, false, false),
            (false, [(LazItemType::RGB12, 2)]) | (true, [(LazItemType::RGB14, 3)]) => {
                (false, true, false)
            }
            (false, [(LazItemType::GpsTime, 2), (LazItemType::RGB12, 2)]) => (true, true, false),
            (true, [(LazItemType::RGBNIR14, 3)]) => (false, true, true),
            _ => return None,
        };
        Some(Self {
            is_layered,
            has_time,
            has_colour,
            has_infrared,
            extra_bytes,
        })
    }

    /// Bytes of a record.
    pub(crate) fn stride(self) -> usize {
        let point = if self.is_layered {
            point14::BYTES
        } else {
            point10::BYTES
        };
        let time = if self.has_time { size_of::<f64>() } else { 0 };
        let colour = if self.has_colour { colour::BYTES } else { 0 };
        let infrared = if self.has_infrared {
            infrared::BYTES
        } else {
            0
        };
        point + time + colour + infrared + usize::from(self.extra_bytes)
    }
}
