//! Properties of a surfel: their bits in the mask, their form in a record, and what becomes of them.
//!
//! | property | becomes |
//! |---|---|
//! | position, radius | `position_radius` |
//! | normal | `normal` |
//! | diffuse colour, else ambient, else specular | `colour` |
//! | tangent axes | `axes` |
//! | colours as Y, U, V | `diffuse_yuv` … besides |
//! | all others | a column of the name in [`NAMED`] |

use crate::geometry::ScalarType;

/// A property, by its bit in the mask.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Property(pub(crate) u16);

impl Property {
    pub(crate) const POSITION: Self = Self(0);
    pub(crate) const NORMAL: Self = Self(1);
    pub(crate) const RADIUS: Self = Self(4);
    pub(super) const DENSITY: Self = Self(6);
    pub(super) const AMBIENT: Self = Self(8);
    pub(crate) const DIFFUSE: Self = Self(10);
    pub(super) const SPECULAR: Self = Self(12);
    pub(crate) const AXES: Self = Self(24);
    pub(super) const FLAGS: Self = Self(27);
    /// Two rays that the reference writer puts over whatever else is in the record.
    pub(super) const RAYS: [Self; 2] = [Self(33), Self(34)];
    /// Bits up to the last property that is known.
    pub(super) const COUNT: usize = 36;

    /// Is it one of the three colours?
    pub(crate) fn is_colour(self) -> bool {
        [Self::AMBIENT, Self::DIFFUSE, Self::SPECULAR].contains(&self)
    }
}

/// A property kept under a name.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NamedProperty {
    pub(crate) property: Property,
    pub(crate) name: &'static str,
    pub(crate) scalar: ScalarType,
    /// Components; of colours 4, whatever the file's model.
    pub(crate) components: usize,
}

const fn named(
    bit: u16,
    name: &'static str,
    scalar: ScalarType,
    components: usize,
) -> NamedProperty {
    NamedProperty {
        property: Property(bit),
        name,
        scalar,
        components,
    }
}

/// The properties that have no column of their own kind, by rising bit.
pub(crate) const NAMED: [NamedProperty; 17] = [
    named(5, "weight", ScalarType::F32, 1),
    named(6, "sampling_density", ScalarType::F32, 3),
    named(7, "texture_uv", ScalarType::F32, 2),
    named(8, "ambient_colour", ScalarType::U8, 4),
    named(9, "ambient_coefficient", ScalarType::U8, 1),
    named(10, "diffuse_colour", ScalarType::U8, 4),
    named(11, "diffuse_coefficient", ScalarType::U8, 1),
    named(12, "specular_colour", ScalarType::U8, 4),
    named(13, "specular_coefficient", ScalarType::U8, 1),
    named(14, "shininess", ScalarType::U8, 1),
    named(27, "flags", ScalarType::U32, 1),
    named(28, "isovalue", ScalarType::F32, 1),
    named(29, "origin_cell", ScalarType::U32, 1),
    named(30, "camera_depth", ScalarType::F32, 1),
    named(31, "camera_id", ScalarType::U8, 1),
    named(32, "camera_xy", ScalarType::U16, 2),
    named(35, "phi_theta", ScalarType::F32, 2),
];

/// Name of the column that tells the sets of a file apart.
pub(crate) const SET_COLUMN: &str = "surfel_set";

/// The bit of [`Property::FLAGS`] that asks not to draw a surfel.
pub(super) const INVISIBLE: u32 = 0x400;

/// How a set's colours are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ColourModel {
    L,
    La,
    Rgb,
    Rgba,
    Yuv,
    Yuva,
}

impl ColourModel {
    /// The bits of the mask that tell the model.
    pub(super) const MASK: u32 = 0x001F_0000;

    /// The model of a mask; `Err` holds bits that are none of the six, `Ok(None)` is a file without colours.
    pub(super) fn from_mask(mask: u32) -> Result<Option<Self>, u32> {
        Ok(Some(match mask & Self::MASK {
            0 => return Ok(None),
            0x0001_0000 => Self::L,
            0x0009_0000 => Self::La,
            0x0007_0000 => Self::Rgb,
            0x000F_0000 => Self::Rgba,
            0x0010_0000 => Self::Yuv,
            0x0018_0000 => Self::Yuva,
            other => return Err(other),
        }))
    }

    /// Bytes of a colour.
    pub(super) const fn size(self) -> usize {
        match self {
            Self::L => 1,
            Self::La => 2,
            Self::Rgb | Self::Yuv => 3,
            Self::Rgba | Self::Yuva => 4,
        }
    }

    /// Is it one of the two that lose something when they are converted?
    pub(super) const fn is_yuv(self) -> bool {
        matches!(self, Self::Yuv | Self::Yuva)
    }

    /// sRGB with straight alpha of stored bytes; what is not stored is 255.
    ///
    /// Y, U and V go back by the reference library's own matrix, without an offset: what it stored for negative U and V is
    /// lost.
    #[inline]
    pub(super) fn rgba(self, bytes: &[u8]) -> [u8; 4] {
        let byte = |index: usize| bytes.get(index).copied().unwrap_or(255);
        match self {
            Self::L => [byte(0), byte(0), byte(0), 255],
            Self::La => [byte(0), byte(0), byte(0), byte(1)],
            Self::Rgb => [byte(0), byte(1), byte(2), 255],
            Self::Rgba => [byte(0), byte(1), byte(2), byte(3)],
            Self::Yuv | Self::Yuva => {
                let [y, u, v] = [0, 1, 2].map(|index| f64::from(byte(index)));
                // Saturates.
                let round = |value: f64| (value + 0.5).floor() as u8;
                let alpha = if self == Self::Yuva { byte(3) } else { 255 };
                [
                    round(y + 1.14 * v),
                    round(y - 0.394 * u - 0.581 * v),
                    round(y + 2.028 * u),
                    alpha,
                ]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_model_gives_four_bytes() {
        let of = |mask| ColourModel::from_mask(mask).unwrap().unwrap();
        assert_eq!(of(0x0001_0000).rgba(&[7]), [7, 7, 7, 255]);
        assert_eq!(of(0x0009_0000).rgba(&[7, 9]), [7, 7, 7, 9]);
        assert_eq!(of(0x0007_0000).rgba(&[1, 2, 3]), [1, 2, 3, 255]);
        assert_eq!(of(0x000F_0000).rgba(&[1, 2, 3, 4]), [1, 2, 3, 4]);
        assert_eq!(of(0x0010_0000).rgba(&[100, 0, 0]), [100, 100, 100, 255]);
        assert_eq!(of(0x0018_0000).rgba(&[100, 10, 20, 4]), [123, 84, 120, 4]);
        assert_eq!(ColourModel::from_mask(0x0003_0000), Err(0x0003_0000));
        assert_eq!(ColourModel::from_mask(0x0800_0413), Ok(None));
    }
}
