//! Twin of `lib::camera`: view space, clip space, pixels.

use super::matrix;
use crate::abi::FrameUniform;
use glam::{DVec2, DVec3, DVec4, Vec4Swizzles as _};

/// The numbers of a [`FrameUniform`] that geometry needs, widened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Reversed z.
    pub clip_from_view: glam::DMat4,
    /// Size of the target, px.
    pub tile_size_px: DVec2,
    /// Pixels that one scene unit covers at distance 1 (perspective) or everywhere (orthographic).
    pub pixels_per_unit: f64,
    /// Whether rays are parallel.
    pub is_orthographic: bool,
}

impl From<&FrameUniform> for Camera {
    fn from(frame: &FrameUniform) -> Self {
        Self {
            clip_from_view: matrix(&frame.clip_from_view),
            tile_size_px: DVec2::from(frame.tile_size_px.map(f64::from)),
            pixels_per_unit: f64::from(frame.pixels_per_unit),
            is_orthographic: frame.is_orthographic != 0,
        }
    }
}

impl Camera {
    /// Clip space from view space.
    pub fn clip_from_view(&self, position_view: DVec3) -> DVec4 {
        self.clip_from_view * position_view.extend(1.0)
    }

    /// Pixel position in the target from clip space; `clip.w` must not be 0.
    pub fn pixel_from_clip(&self, clip: DVec4) -> DVec2 {
        let ndc = clip.xy() / clip.w;
        (DVec2::splat(0.5) + DVec2::new(0.5, -0.5) * ndc) * self.tile_size_px
    }

    /// Normalised device coordinates (−1..1, y up) from a pixel position in the target.
    pub fn ndc_from_pixel(&self, pixel: DVec2) -> DVec2 {
        (pixel / self.tile_size_px - DVec2::splat(0.5)) * DVec2::new(2.0, -2.0)
    }

    /// Pixels that one scene unit across the view covers at `position_view`.
    pub fn pixels_per_unit_at(&self, position_view: DVec3) -> f64 {
        if self.is_orthographic {
            self.pixels_per_unit
        } else {
            self.pixels_per_unit / -position_view.z
        }
    }

    /// Unit direction from `position_view` towards the eye; view space.
    pub fn towards_eye(&self, position_view: DVec3) -> DVec3 {
        if self.is_orthographic {
            DVec3::Z
        } else {
            -position_view.normalize()
        }
    }

    /// The ray that a pixel position sees: its origin in the eye's plane, and its direction, of length 1 along −z. View
    /// space. (No shader needs it: ellipses are met in clip space; it is the independent way for tests.)
    pub fn ray(&self, pixel: DVec2) -> (DVec3, DVec3) {
        let ndc = self.ndc_from_pixel(pixel);
        let view_from_clip = self.clip_from_view.inverse();
        let near = view_from_clip * ndc.extend(1.0).extend(1.0);
        let near = near.xyz() / near.w;
        if self.is_orthographic {
            (near.with_z(0.0), DVec3::NEG_Z)
        } else {
            (DVec3::ZERO, near / -near.z)
        }
    }
}
