//! Which fields a record has and how they are compressed.

use std::iter::Peekable;

use ::laz::{LazItem, LazItemType};

use super::{colour, infrared, point10, point14, wave};

/// Extra bytes of a record at most: each has a model of 1 KB in each chunk that is being decompressed.
const MOST_EXTRA_BYTES: u16 = 1024;

/// LASzip's ways to compress fields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Version {
    /// Of the point formats 0 to 5, before 2011.
    First,
    /// Of the point formats 0 to 5.
    Second,
    /// Of the point formats 6 to 10, where each field has a stream of its own.
    Third,
    /// The same without an oddity, see [`super::by_channel`].
    Fourth,
}

/// The fields of a record, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) version: Version,
    /// Whether a time follows the point; in the third and fourth version it is part of the point.
    pub(super) has_time: bool,
    pub(super) has_colour: bool,
    /// Whether near infrared follows the colour.
    pub(super) has_infrared: bool,
    pub(super) has_wave: bool,
    pub(super) extra_bytes: u16,
}

impl Layout {
    /// The layout of a record of such items.
    ///
    /// # Errors
    /// LASzip does not compress such records.
    pub(super) fn of(items: &[LazItem]) -> Result<Self, String> {
        let types = items
            .iter()
            .map(|item| (item.item_type(), item.version()))
            .peekable();
        let layout = Self::of_types(types).ok_or_else(|| {
            let types = items
                .iter()
                .map(|item| format!("{:?} version {}", item.item_type(), item.version()));
            let types: Vec<String> = types.collect();
            format!("no records of {} are known", types.join(", "))
        })?;
        if layout.extra_bytes > MOST_EXTRA_BYTES {
            return Err(format!(
                "points have {} extra bytes, expected {MOST_EXTRA_BYTES} at most",
                layout.extra_bytes
            ));
        }
        Ok(layout)
    }

    fn of_types(mut items: Peekable<impl Iterator<Item = (LazItemType, u16)>>) -> Option<Self> {
        use LazItemType::{
            Byte, Byte14, GpsTime, Point10, Point14, RGB12, RGB14, RGBNIR14, WavePacket13,
            WavePacket14,
        };
        let (point, number) = items.next()?;
        let version = match (point, number) {
            (Point10, 1) => Version::First,
            (Point10, 2) => Version::Second,
            (Point14, 3) => Version::Third,
            (Point14, 4) => Version::Fourth,
            _ => return None,
        };
        let (colour, wave) = match point {
            Point14 => (RGB14, WavePacket14),
            _ => (RGB12, WavePacket13),
        };
        let has_time = point == Point10 && items.next_if_eq(&(GpsTime, number)).is_some();
        let has_infrared = point == Point14 && items.next_if_eq(&(RGBNIR14, number)).is_some();
        let has_colour = has_infrared || items.next_if_eq(&(colour, number)).is_some();
        // Those of the second version are the first's, and are called so by LASzip, but not by all.
        let has_wave = items.next_if_eq(&(wave, number)).is_some()
            || point == Point10 && items.next_if_eq(&(WavePacket13, 1)).is_some();
        let extra_bytes = match (point, items.next()) {
            (_, None) => 0,
            (Point10, Some((Byte(count), version))) if version == number => count,
            (Point14, Some((Byte14(count), version))) if version == number => count,
            _ => return None,
        };
        if items.next().is_some() {
            return None;
        }
        Some(Self {
            version,
            has_time,
            has_colour,
            has_infrared,
            has_wave,
            extra_bytes,
        })
    }

    /// Bytes of a record.
    pub(super) fn stride(self) -> usize {
        let point = match self.version {
            Version::First | Version::Second => point10::BYTES,
            Version::Third | Version::Fourth => point14::BYTES,
        };
        let fields = [
            (self.has_time, size_of::<f64>()),
            (self.has_colour, colour::BYTES),
            (self.has_infrared, infrared::BYTES),
            (self.has_wave, wave::BYTES),
        ];
        let fields = fields
            .iter()
            .filter(|(is_there, _)| *is_there)
            .map(|(_, bytes)| bytes);
        point + fields.sum::<usize>() + usize::from(self.extra_bytes)
    }
}
