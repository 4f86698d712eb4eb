//! What a row of faces says beside its corners.

use super::plan::FaceExtras;
use crate::geometry::ScalarType;
use crate::load::assemble::FaceData;

/// Collects what one row says.
pub(super) struct RowExtras {
    wanted: FaceExtras,
    colour: [f32; 4],
    picture: u32,
}

impl RowExtras {
    /// Before the first property of a row.
    pub(super) fn new(wanted: FaceExtras) -> Self {
        Self {
            wanted,
            colour: [0.0, 0.0, 0.0, 1.0],
            picture: 0,
        }
    }

    /// Which component of the colour a property is.
    fn component(&self, property: usize) -> Option<usize> {
        let FaceExtras { colour, alpha, .. } = self.wanted;
        if alpha == Some(property) {
            return Some(3);
        }
        colour?.iter().position(|index| *index == property)
    }

    /// Whether a property's values are wanted.
    #[inline]
    pub(super) fn wants(&self, property: usize) -> bool {
        !self.wanted.is_empty()
            && (self.wanted.uvs == Some(property)
                || self.wanted.picture == Some(property)
                || self.component(property).is_some())
    }

    /// Takes the values of a property that is wanted.
    pub(super) fn take(
        &mut self,
        property: usize,
        scalar: ScalarType,
        values: &[f64],
        data: &mut FaceData,
    ) {
        if self.wanted.uvs == Some(property) {
            let pairs = values.as_chunks::<2>().0;
            data.uvs
                .extend(pairs.iter().map(|pair| pair.map(|value| value as f32)));
            return;
        }
        let Some(value) = values.first() else {
            return;
        };
        if self.wanted.picture == Some(property) {
            // −1 stands for none.
            self.picture = if *value >= 0.0 {
                *value as u32
            } else {
                u32::MAX
            };
        } else if let Some(component) = self.component(property) {
            let largest = match scalar {
                ScalarType::F32 | ScalarType::F64 => 1.0,
                ScalarType::U16 => 65535.0,
                _ => 255.0,
            };
            self.colour[component] = (value / largest).clamp(0.0, 1.0) as f32;
        }
    }

    /// Behind the last property: `corners` is how many corners all rows have so far.
    pub(super) fn end(self, corners: usize, data: &mut FaceData) {
        if self.wanted.uvs.is_some() {
            data.uvs.resize(corners, [f32::NAN; 2]);
        }
        if self.wanted.picture.is_some() {
            data.pictures.push(self.picture);
        }
        if self.wanted.colour.is_some() {
            data.colours.push(self.colour);
        }
    }
}
