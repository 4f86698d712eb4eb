//! What both twins of the composition are asked for, and the small decisions that they share.

use glam::{Mat4, Vec4};
use pointstage_plugin_api::abi::{Format, FrameUniform};

use super::depth::{distance_terms, distance_with};
use super::picture::{Background, Picture};
use super::targets::{Appearance, TargetSpec};

/// How to turn targets into a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Composition {
    /// The target that is shown; [`Appearance::Colours`] is the picture proper.
    pub shown: TargetSpec,
    /// What lies where nothing is drawn.
    pub background: Background,
    /// Factor on linear colours before sRGB. The background is not exposed: it looks as asked for.
    pub exposure: f32,
    /// The projection that wrote the depth target.
    pub clip_from_view: Mat4,
    /// First row of this tile in the whole image, px; for gradients.
    pub tile_origin_y_px: f32,
    /// Height of the whole image, px.
    pub image_height_px: f32,
    /// Values at the dark and the bright end of the ramp (distances, for depth); `None` finds them in view.
    pub ramp_range: Option<[f32; 2]>,
}

/// A composed picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Composed {
    /// 8-bit sRGB, straight alpha.
    pub picture: Picture,
    /// Values at the dark and the bright end of the ramp, for the legend; `None` without a ramp or with nothing in view.
    pub range: Option<[f32; 2]>,
}

impl Composition {
    /// Shows `shown` as the frame of this uniform drew it.
    pub fn of_frame(
        shown: &TargetSpec,
        background: Background,
        exposure: f32,
        frame: &FrameUniform,
    ) -> Self {
        Self {
            shown: shown.clone(),
            background,
            exposure,
            clip_from_view: Mat4::from_cols_array_2d(&frame.clip_from_view),
            tile_origin_y_px: frame.tile_origin_px[1],
            image_height_px: frame.image_size_px[1],
            ramp_range: None,
        }
    }

    /// Terms of the distance from depth.
    pub(crate) fn distance_terms(&self) -> Vec4 {
        distance_terms(&self.clip_from_view)
    }

    /// sRGB of the background's upper and lower edge, and whether there is one at all.
    pub(crate) fn background_edges(&self) -> ([f32; 3], [f32; 3], bool) {
        let unit = |colour: [f32; 3]| colour.map(|value| positive(value).min(1.0));
        match self.background {
            Background::Transparent => ([0.0; 3], [0.0; 3], false),
            Background::Solid(colour) => (unit(colour), unit(colour), true),
            Background::Gradient(top, bottom) => (unit(top), unit(bottom), true),
        }
    }

    /// Whether the colours need the least and the greatest value in view.
    pub(crate) fn needs_range(&self) -> bool {
        self.has_ramp() && self.ramp_range.is_none()
    }

    /// The ramp's ends, if the target is shown on a ramp and they are given.
    pub(crate) fn given_ends(&self) -> Option<[f32; 2]> {
        self.ramp_range.filter(|_| self.has_ramp())
    }

    fn has_ramp(&self) -> bool {
        matches!(
            self.shown.appearance,
            Appearance::Depth | Appearance::Ramp | Appearance::RampFromZero
        )
    }

    /// How far from its clear value a float still counts as untouched: what the format rounds away.
    pub(crate) fn clear_tolerance(&self) -> f32 {
        let clear = self.shown.clear[0].abs() as f32;
        match self.shown.format {
            Format::R8_UNORM => 0.5 / 255.0,
            Format::R16_FLOAT => clear / 1024.0, // ten bits of mantissa
            _ => 0.0,
        }
    }

    /// The values at the ramp's dark and bright end, from the least and the greatest value in view.
    pub(crate) fn ramp_ends(&self, least: f32, greatest: f32) -> [f32; 2] {
        match self.shown.appearance {
            // Reversed z: the least depth is the farthest, and the nearest is brightest.
            Appearance::Depth => {
                [least, greatest].map(|depth| distance_with(depth, self.distance_terms()))
            }
            Appearance::RampFromZero => [0.0, greatest],
            _ => [least, greatest],
        }
    }
}

/// The value if it is above 0, else 0; also for NaN.
#[inline]
pub(crate) fn positive(value: f32) -> f32 {
    if value > 0.0 { value } else { 0.0 }
}
