//! A small picture of a view, for lists.

use std::sync::{Arc, OnceLock};

use egui::{ColorImage, Context, TextureHandle, TextureOptions};
use image::{ImageBuffer, Rgba, imageops};
use pointstage_engine::stage::Picture;

/// Width of a thumbnail, px.
const WIDTH_PX: u32 = 96;

/// Greatest height, px: of a picture twice as high as wide.
const MAX_HEIGHT_PX: u32 = 192;

/// A small picture; clones share it.
#[derive(Clone)]
pub(crate) struct Thumbnail(Arc<Pixels>);

struct Pixels {
    size_px: [u32; 2],
    /// sRGB with straight alpha, rows from the top.
    rgba: Vec<u8>,
    /// Made when it is shown first, and gone with the pixels.
    texture: OnceLock<TextureHandle>,
}

impl Thumbnail {
    /// A picture made small. `None` for one without pixels.
    pub(crate) fn of(picture: &Picture) -> Option<Self> {
        let [width, height] = picture.size_px;
        let pixels = &*picture.rgba;
        let whole: ImageBuffer<Rgba<u8>, &[u8]> = ImageBuffer::from_raw(width, height, pixels)?;
        if width == 0 || height == 0 {
            return None;
        }
        let small_width = WIDTH_PX.min(width);
        let small_height = u64::from(height) * u64::from(small_width) / u64::from(width);
        let small_height = small_height.clamp(1, u64::from(MAX_HEIGHT_PX)) as u32;
        let small = imageops::thumbnail(&whole, small_width, small_height);
        Some(Self(Arc::new(Pixels {
            size_px: [small_width, small_height],
            rgba: small.into_raw(),
            texture: OnceLock::new(),
        })))
    }

    /// Its pixels for the toolkit.
    pub(crate) fn texture(&self, ctx: &Context) -> &TextureHandle {
        self.0.texture.get_or_init(|| {
            let size = self.0.size_px.map(|side| side as usize);
            let image = ColorImage::from_rgba_unmultiplied(size, &self.0.rgba);
            ctx.load_texture("thumbnail", image, TextureOptions::LINEAR)
        })
    }
}

impl PartialEq for Thumbnail {
    fn eq(&self, other: &Self) -> bool {
        self.0.size_px == other.0.size_px && self.0.rgba == other.0.rgba
    }
}

impl std::fmt::Debug for Thumbnail {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [width, height] = self.0.size_px;
        write!(formatter, "Thumbnail({width}×{height})")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(size_px: [u32; 2]) -> Picture {
        let [width, height] = size_px;
        let row = |y: u32| if y < height / 2 { [255, 0, 0, 255] } else { [0, 0, 255, 128] };
        let rgba = (0..height).flat_map(|y| (0..width).flat_map(move |_| row(y)));
        Picture {
            size_px,
            rgba: rgba.collect(),
        }
    }

    #[test]
    fn a_picture_gets_small_and_keeps_its_shape_and_colours() {
        let small = Thumbnail::of(&picture([960, 640])).expect("pixels");
        assert_eq!(small.0.size_px, [96, 64]);
        assert_eq!(small.0.rgba[..4], [255, 0, 0, 255]);
        assert_eq!(small.0.rgba[small.0.rgba.len() - 4..], [0, 0, 255, 128]);
    }

    #[test]
    fn odd_shapes_are_fine_and_nothing_has_none() {
        let size_of = |size_px| Thumbnail::of(&picture(size_px)).map(|small| small.0.size_px);
        assert_eq!(size_of([10, 4]), Some([10, 4]));
        assert_eq!(size_of([500, 2]), Some([96, 1]));
        assert_eq!(size_of([4, 1000]), Some([4, 192]));
        assert_eq!(size_of([0, 5]), None);
        let lying = Picture {
            size_px: [5, 5],
            rgba: vec![0; 7].into(),
        };
        assert_eq!(Thumbnail::of(&lying), None);
    }
}
