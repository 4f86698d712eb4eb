//! The last picture as a texture of the window's toolkit, and the one before while it fades out.

use std::time::{Duration, Instant};

use egui::{ColorImage, Context, TextureHandle, TextureId, TextureOptions};
use pointstage_engine::stage::Picture;

/// How long one picture takes to fade into the next.
const FADE: Duration = Duration::from_millis(150);

/// How a picture takes the place of the one before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Transition {
    /// At once. A fade that is under way goes on with the new picture.
    Cut,
    /// It fades in over the one before.
    CrossFade,
}

/// The textures, and which pictures they hold.
#[derive(Default)]
pub(crate) struct PictureTexture {
    front: Option<Plate>,
    back: Option<Plate>,
    /// When the front began to fade in, if it does.
    fade_start: Option<Instant>,
}

/// A picture on the device of the toolkit.
struct Plate {
    texture: TextureHandle,
    size_px: [u32; 2],
    is_transparent: bool,
    /// Its pixels are shown as squares.
    is_zoomed: bool,
}

/// A picture to paint, over those before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Layer {
    /// The texture.
    pub(crate) texture: TextureId,
    /// Its size, px.
    pub(crate) size_px: [u32; 2],
    /// How much it covers, 0..1.
    pub(crate) opacity: f32,
}

impl PictureTexture {
    /// Uploads a picture, in place of the one before or over it. `is_zoomed`: its pixels are shown as squares.
    pub(crate) fn set(
        &mut self,
        ctx: &Context,
        picture: &Picture,
        transition: Transition,
        is_zoomed: bool,
        now: Instant,
    ) {
        if transition == Transition::CrossFade && self.front.is_some() {
            std::mem::swap(&mut self.front, &mut self.back);
            self.fade_start = Some(now);
        }
        let size = picture.size_px.map(|side| side as usize);
        let is_transparent = picture.rgba.chunks_exact(4).any(|pixel| pixel[3] != 255);
        // The picture's alpha is straight. Where it is 1 everywhere both are the same, and this one is a copy.
        let image = if is_transparent {
            ColorImage::from_rgba_unmultiplied(size, &picture.rgba)
        } else {
            ColorImage::from_rgba_premultiplied(size, &picture.rgba)
        };
        // A picture of another size than the viewport is shown while the next is drawn: smooth, not in blocks. Zoomed in, the
        // pixels themselves are looked at.
        let options = if is_zoomed {
            TextureOptions::NEAREST
        } else {
            TextureOptions::LINEAR
        };
        let texture = match self.front.take() {
            Some(Plate { mut texture, .. }) => {
                texture.set(image, options);
                texture
            }
            None => ctx.load_texture("picture", image, options),
        };
        self.front = Some(Plate {
            texture,
            size_px: picture.size_px,
            is_transparent,
            is_zoomed,
        });
    }

    /// Shows the pixels of `picture`, which is the present one, as squares or smooth.
    pub(crate) fn match_zoom(&mut self, ctx: &Context, picture: &Picture, is_zoomed: bool) {
        let front = self.front.as_ref();
        if front.is_some_and(|front| front.is_zoomed != is_zoomed) {
            let fade_start = self.fade_start;
            self.set(ctx, picture, Transition::Cut, is_zoomed, Instant::now());
            self.fade_start = fade_start;
        }
    }

    /// What to paint, from back to front. A fade that has ended is forgotten.
    pub(crate) fn layers(&mut self, now: Instant) -> Vec<Layer> {
        let progress = self.fade_start.map_or(1.0, |start| {
            (now - start).as_secs_f32() / FADE.as_secs_f32()
        });
        if progress >= 1.0 {
            self.fade_start = None;
        }
        let layer = |plate: &Plate, opacity| Layer {
            texture: plate.texture.id(),
            size_px: plate.size_px,
            opacity,
        };
        let back = self.back.iter().filter(|_| progress < 1.0);
        let front = self.front.iter();
        back.map(|plate| layer(plate, 1.0))
            .chain(front.map(|plate| layer(plate, progress.clamp(0.0, 1.0))))
            .collect()
    }

    /// Whether one picture is fading into another.
    pub(crate) fn is_fading(&self) -> bool {
        self.fade_start.is_some()
    }

    /// Whether any pixel is see-through.
    pub(crate) fn is_transparent(&self) -> bool {
        self.front
            .as_ref()
            .is_some_and(|plate| plate.is_transparent)
    }
}
