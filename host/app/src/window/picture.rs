//! The last picture as a texture of the window's toolkit.

use egui::{ColorImage, Context, TextureHandle, TextureId, TextureOptions};
use pointstage_engine::stage::Picture;

/// The texture, and which picture it holds.
#[derive(Default)]
pub(crate) struct PictureTexture {
    texture: Option<TextureHandle>,
    is_transparent: bool,
}

impl PictureTexture {
    /// Uploads a picture, in place of the one before.
    pub(crate) fn set(&mut self, ctx: &Context, picture: &Picture) {
        let size = picture.size_px.map(|side| side as usize);
        self.is_transparent = picture.rgba.chunks_exact(4).any(|pixel| pixel[3] != 255);
        // The picture's alpha is straight. Where it is 1 everywhere both are the same, and this one is a copy.
        let image = if self.is_transparent {
            ColorImage::from_rgba_unmultiplied(size, &picture.rgba)
        } else {
            ColorImage::from_rgba_premultiplied(size, &picture.rgba)
        };
        // A picture of another size than the viewport is shown while the next is drawn: smooth, not in blocks.
        let options = TextureOptions::LINEAR;
        match &mut self.texture {
            Some(texture) => texture.set(image, options),
            None => self.texture = Some(ctx.load_texture("picture", image, options)),
        }
    }

    /// The texture, once there is one.
    pub(crate) fn id(&self) -> Option<TextureId> {
        self.texture.as_ref().map(TextureHandle::id)
    }

    /// Whether any pixel is see-through.
    pub(crate) fn is_transparent(&self) -> bool {
        self.is_transparent
    }
}
