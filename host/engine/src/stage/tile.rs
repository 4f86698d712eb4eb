//! A part of an image that is drawn by itself, so that an image may be larger than what a device draws at once.
//!
//! A tile has an off-centre projection of its own: what the whole image shows at pixel p, the tile shows at p − origin, and
//! so does every renderer that goes by the frame's `clip_from_view` and `tile_size_px`. Pixels per scene unit, and the
//! background's gradient, are those of the whole image.

use super::options::FrameError;
use super::request::FrameRequest;
use glam::{DMat4, DVec4};

/// The greatest width and height of an image that is drawn in tiles, px: pixel positions keep 1/256 px in single precision.
pub const LARGEST_IMAGE_PX: u32 = 65_536;

/// Where in a larger image a frame lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// The tile's upper left corner in the image, px.
    pub origin_px: [u32; 2],
    /// Size of the whole image, px.
    pub image_size_px: [u32; 2],
}

impl FrameRequest {
    /// Size of the whole image, px: that of the frame, or of the image that the frame is a tile of.
    pub fn image_size_px(&self) -> [u32; 2] {
        self.tile.map_or(self.size_px, |tile| tile.image_size_px)
    }

    /// The tile's corner in the image, px; the corner of the image if the frame is all of it.
    pub fn tile_origin_px(&self) -> [u32; 2] {
        self.tile.map_or([0; 2], |tile| tile.origin_px)
    }

    /// Projects view space into the clip space of the frame, which covers the tile.
    pub(super) fn clip_from_view(&self) -> DMat4 {
        let [width, height] = self.image_size_px().map(|length| f64::from(length.max(1)));
        let clip_from_view = self.camera.clip_from_view(width / height);
        match self.tile {
            None => clip_from_view,
            Some(tile) => tile_from_image(tile, self.size_px) * clip_from_view,
        }
    }
}

impl Tile {
    /// Checks that a tile of this size lies in an image that can be drawn.
    pub(super) fn check(self, size_px: [u32; 2]) -> Result<(), FrameError> {
        let [width, height] = self.image_size_px;
        let refuse = |what: String| {
            Err(FrameError::Size {
                width,
                height,
                what,
            })
        };
        if self.image_size_px.contains(&0) {
            return refuse("it needs at least one in each direction".into());
        }
        if width > LARGEST_IMAGE_PX || height > LARGEST_IMAGE_PX {
            return refuse(format!(
                "images have at most {LARGEST_IMAGE_PX} in each direction; ask for less"
            ));
        }
        let [x, y] = self.origin_px;
        let [across, down] = size_px;
        let fits = |origin: u32, length: u32, whole: u32| {
            origin.checked_add(length).is_some_and(|end| end <= whole)
        };
        if fits(x, across, width) && fits(y, down, height) {
            return Ok(());
        }
        refuse(format!(
            "the tile of {across}×{down} pixels at ({x}, {y}) reaches beyond it; ask for a tile within the image"
        ))
    }
}

/// From the image's clip space to the tile's: a pixel's position moves by the tile's corner.
///
/// ```text
/// pixel_x = (1 + x/w)·W/2     the tile's x/w = 2·(pixel_x − origin_x)/width − 1 = (x/w)·W/width + (W − 2·origin_x)/width − 1
/// ```
///
/// and likewise for y, which counts pixels downwards. Depth stays.
fn tile_from_image(tile: Tile, size_px: [u32; 2]) -> DMat4 {
    let [image, origin, size] =
        [tile.image_size_px, tile.origin_px, size_px].map(|pair| pair.map(f64::from));
    let scale = [0, 1].map(|axis| image[axis] / size[axis].max(1.0));
    let shift = [0, 1].map(|axis| (image[axis] - 2.0 * origin[axis]) / size[axis].max(1.0) - 1.0);
    DMat4::from_cols(
        DVec4::new(scale[0], 0.0, 0.0, 0.0),
        DVec4::new(0.0, scale[1], 0.0, 0.0),
        DVec4::Z,
        DVec4::new(shift[0], -shift[1], 0.0, 1.0),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec2, DVec3};
    use pointstage_scene::{Camera, Projection, Scene};
    use proptest::prelude::*;
    use std::sync::Arc;

    fn request(projection: Projection, size_px: [u32; 2], tile: Option<Tile>) -> FrameRequest {
        let camera = Camera {
            projection,
            ..Camera::default()
        };
        FrameRequest {
            tile,
            ..FrameRequest::still(Arc::new(Scene::new()), camera, size_px, "")
        }
    }

    /// Pixel position and depth in the frame of a place in view space.
    fn pixel(request: &FrameRequest, position_view: DVec3) -> (DVec2, f64) {
        let ndc = request.clip_from_view().project_point3(position_view);
        let size = DVec2::from(request.size_px.map(f64::from));
        let place = (DVec2::splat(0.5) + DVec2::new(0.5, -0.5) * ndc.truncate()) * size;
        (place, ndc.z)
    }

    proptest! {
        #[test]
        fn a_tile_shows_what_the_image_shows_moved_by_its_corner(
            image in [1_u32..5000, 1_u32..5000],
            corner in [0.0_f64..1.0, 0.0_f64..1.0],
            extent in [0.0_f64..1.0, 0.0_f64..1.0],
            x in -2.0_f64..2.0, y in -2.0_f64..2.0, z in -9.0_f64..-0.5,
        ) {
            let part = |whole: u32, share: f64| (f64::from(whole) * share) as u32;
            let origin = [0, 1].map(|axis| part(image[axis] - 1, corner[axis]));
            let size = [0, 1].map(|axis| 1 + part(image[axis] - origin[axis] - 1, extent[axis]));
            let tile = Tile { origin_px: origin, image_size_px: image };
            prop_assert!(tile.check(size).is_ok());
            for projection in [
                Projection::Perspective { fov_y_rad: 0.7 },
                Projection::Orthographic { height: 3.0 },
            ] {
                let (whole, depth) = pixel(&request(projection, image, None), DVec3::new(x, y, z));
                let (part, same) = pixel(&request(projection, size, Some(tile)), DVec3::new(x, y, z));
                let moved = whole - DVec2::from(origin.map(f64::from));
                prop_assert!((part - moved).length() < 1e-6, "{part} is not {moved}");
                prop_assert!((depth - same).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn tiles_beyond_the_image_and_images_beyond_reason_are_refused_by_name() {
        let tile = |origin_px, image_size_px| Tile {
            origin_px,
            image_size_px,
        };
        for (tile, expected) in [
            (tile([0, 0], [0, 9]), "at least one"),
            (tile([0, 0], [70_000, 9]), "at most 65536"),
            (tile([5, 0], [9, 9]), "5×5 pixels at (5, 0)"),
            (tile([u32::MAX, 0], [9, 9]), "reaches beyond"),
        ] {
            let error = tile.check([5, 5]).expect_err("refused").to_string();
            assert!(error.contains(expected), "{error}");
        }
        assert!(tile([4, 4], [9, 9]).check([5, 5]).is_ok());
    }
}
