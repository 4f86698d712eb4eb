//! Small pictures of views, as PNG, for lists.

use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::io::Cursor;

use egui::{ColorImage, Context, Id, TextureHandle, TextureOptions};
use image::{ImageBuffer, ImageFormat, ImageReader, Limits, Rgba, imageops};
use pointstage_engine::stage::Picture;

/// Width of a thumbnail, px.
const WIDTH_PX: u32 = 96;

/// Greatest height, px: of a picture twice as high as wide.
const MAX_HEIGHT_PX: u32 = 192;

/// A picture made small, as PNG; empty for one without pixels.
pub(crate) fn encode(picture: &Picture) -> Vec<u8> {
    let [width, height] = picture.size_px;
    let whole: Option<ImageBuffer<Rgba<u8>, &[u8]>> =
        ImageBuffer::from_raw(width, height, &*picture.rgba);
    let Some(whole) = whole.filter(|_| width > 0 && height > 0) else {
        return Vec::new();
    };
    let small_width = WIDTH_PX.min(width);
    let small_height = u64::from(height) * u64::from(small_width) / u64::from(width);
    let small_height = small_height.clamp(1, u64::from(MAX_HEIGHT_PX)) as u32;
    let small = imageops::thumbnail(&whole, small_width, small_height);
    let mut bytes = Cursor::new(Vec::new());
    match small.write_to(&mut bytes, ImageFormat::Png) {
        Ok(()) => bytes.into_inner(),
        Err(error) => {
            tracing::warn!("a view is kept without its small picture: {error}");
            Vec::new()
        }
    }
}

/// The texture of a thumbnail, made when it is shown first. `place` says where: a place holds one texture, and gives it back when
/// another picture is shown there. `None` for one that is empty or cannot be read.
pub(crate) fn texture(ctx: &Context, place: Id, png: &[u8]) -> Option<TextureHandle> {
    let mut hasher = DefaultHasher::new();
    png.hash(&mut hasher);
    let hash = hasher.finish();
    let held: Option<(u64, Option<TextureHandle>)> = ctx.data(|data| data.get_temp(place));
    if let Some((_, texture)) = held.filter(|(of, _)| *of == hash) {
        return texture;
    }
    let texture =
        decode(png).map(|image| ctx.load_texture("thumbnail", image, TextureOptions::LINEAR));
    ctx.data_mut(|data| data.insert_temp(place, (hash, texture.clone())));
    texture
}

/// Gives back the texture that a place holds. True if it held one.
pub(crate) fn forget(ctx: &Context, place: Id) -> bool {
    let held: Option<(u64, Option<TextureHandle>)> = ctx.data_mut(|data| data.remove_temp(place));
    held.is_some()
}

/// Thumbnails come out of files too: one that is larger than ours are is not read.
fn decode(png: &[u8]) -> Option<ColorImage> {
    let mut limits = Limits::default();
    limits.max_image_width = Some(WIDTH_PX);
    limits.max_image_height = Some(MAX_HEIGHT_PX);
    let mut reader = ImageReader::with_format(Cursor::new(png), ImageFormat::Png);
    reader.limits(limits);
    let image = reader.decode().ok()?.into_rgba8();
    let size = [image.width() as usize, image.height() as usize];
    Some(ColorImage::from_rgba_unmultiplied(size, image.as_raw()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::Color32;

    fn picture(size_px: [u32; 2]) -> Picture {
        let [width, height] = size_px;
        let row = move |y: u32| {
            if y < height / 2 {
                [255, 0, 0, 255]
            } else {
                [0, 0, 255, 255]
            }
        };
        let rgba = (0..height).flat_map(|y| (0..width).flat_map(move |_| row(y)));
        Picture {
            size_px,
            rgba: rgba.collect(),
        }
    }

    #[test]
    fn a_picture_gets_small_and_keeps_its_shape_and_colours() {
        let small = decode(&encode(&picture([960, 640]))).expect("a picture");
        assert_eq!(small.size, [96, 64]);
        assert_eq!(small.pixels.first(), Some(&Color32::RED));
        assert_eq!(small.pixels.last(), Some(&Color32::BLUE));
    }

    #[test]
    fn odd_shapes_are_fine_and_nothing_has_none() {
        let size_of = |size_px| decode(&encode(&picture(size_px))).map(|small| small.size);
        assert_eq!(size_of([10, 4]), Some([10, 4]));
        assert_eq!(size_of([500, 2]), Some([96, 1]));
        assert_eq!(size_of([4, 1000]), Some([4, 192]));
        assert_eq!(size_of([0, 5]), None);
        let lying = Picture {
            size_px: [5, 5],
            rgba: vec![0; 7].into(),
        };
        assert!(encode(&lying).is_empty());
    }

    #[test]
    fn what_is_no_picture_or_a_huge_one_is_not_shown() {
        assert!(decode(b"not a picture").is_none());
        let mut huge = Cursor::new(Vec::new());
        ImageBuffer::<Rgba<u8>, _>::from_raw(300, 300, vec![0; 360_000])
            .expect("enough pixels")
            .write_to(&mut huge, ImageFormat::Png)
            .expect("written");
        assert!(decode(huge.get_ref()).is_none());
    }

    #[test]
    fn a_place_holds_one_texture_and_gives_it_back() {
        let ctx = Context::default();
        let place = Id::unique("place");
        let (first, second) = (encode(&picture([8, 8])), encode(&picture([9, 8])));
        let id = |png: &[u8]| texture(&ctx, place, png).expect("a texture").id();
        let first_id = id(&first);
        assert_eq!(id(&first), first_id, "made once");
        let second_id = id(&second);
        assert_ne!(second_id, first_id);
        let is_held = |id| ctx.tex_manager().read().meta(id).is_some();
        assert!(!is_held(first_id) && is_held(second_id));
        assert!(forget(&ctx, place) && !forget(&ctx, place));
        assert!(!is_held(second_id));
    }
}
