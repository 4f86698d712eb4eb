//! Targets that are copied to memory as they are, and colours that are composed there: the way of software devices, where a
//! pass over a target is so much slower than this that it would cost more than many a renderer.

use std::sync::Arc;

use glam::Vec4;
use half::f16;
use rayon::prelude::*;

use super::compose_cpu::{Behind, over_background};
use super::composition::{Composition, positive};
use super::picture::Picture;
use super::srgb::srgb8_from_linear;

/// Bytes of a row in a buffer that a texture is copied to, as WebGPU wants them.
pub(super) fn row_bytes(texture: &wgpu::Texture) -> u32 {
    let texel = texture.format().block_copy_size(None).unwrap_or(4);
    let whole = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT;
    (texture.width() * texel).next_multiple_of(whole)
}

/// Whether a texel is one word, which means the same in a texture and in a plane.
pub(super) fn is_word(format: wgpu::TextureFormat) -> bool {
    use wgpu::TextureFormat::{Depth32Float, R32Float, R32Uint};
    matches!(format, Depth32Float | R32Float | R32Uint)
}

/// The words of a texture of one word a texel, from its padded rows.
pub(super) fn words(texture: &wgpu::Texture, mapped: &[u32]) -> Vec<u32> {
    let rows = mapped.chunks_exact(row_bytes(texture) as usize / 4);
    let width = texture.width() as usize;
    let mut words = Vec::with_capacity(width * texture.height() as usize);
    rows.for_each(|row| words.extend_from_slice(&row[..width]));
    words
}

/// The 8-bit sRGB codes of all half floats, at one exposure.
#[derive(Debug)]
pub(super) struct Codes {
    exposure: f32,
    codes: Vec<u8>,
}

impl Codes {
    /// At this exposure; kept from last time if that is the same.
    pub(super) fn at(kept: &mut Option<Self>, exposure: f32) -> &Self {
        let same = |codes: &mut Self| codes.exposure.to_bits() == exposure.to_bits();
        if !kept.as_mut().is_some_and(same) {
            *kept = None;
        }
        kept.get_or_insert_with(|| Self {
            exposure,
            codes: (0..=u16::MAX)
                .map(|bits| {
                    let light = positive(f16::from_bits(bits).to_f32() * exposure);
                    srgb8_from_linear(light)
                })
                .collect(),
        })
    }
}

/// Lays a texture of `rgba16float` over the background, from its padded rows; byte for byte what
/// [`compose_cpu`](super::compose_cpu) makes of the same values.
pub(super) fn compose(
    texture: &wgpu::Texture,
    mapped: &[u32],
    composition: &Composition,
    codes: &Codes,
) -> Picture {
    let size_px = [texture.width(), texture.height()];
    let [width, height] = size_px.map(|side| side as usize);
    let mut rgba: Arc<[u8]> = std::iter::repeat_n(0, width * height * 4).collect();
    let rows = Arc::make_mut(&mut rgba).par_chunks_mut(width.max(1) * 4);
    let texels = mapped.par_chunks_exact(row_bytes(texture) as usize / 4);
    rows.zip(texels).enumerate().for_each(|(y, (row, texels))| {
        let behind = Behind::of_row(composition, y);
        let texels = texels.as_chunks::<2>().0;
        for (pixel, texel) in row.as_chunks_mut::<4>().0.iter_mut().zip(texels) {
            *pixel = show(*texel, composition, codes, &behind);
        }
    });
    Picture { size_px, rgba }
}

/// The pixel of a texel of four half floats.
#[inline]
fn show(texel: [u32; 2], composition: &Composition, codes: &Codes, behind: &Behind) -> [u8; 4] {
    const OPAQUE: u16 = f16::ONE.to_bits();
    let [red_green, blue_alpha] = texel;
    let halves = [red_green, red_green >> 16, blue_alpha, blue_alpha >> 16].map(|bits| bits as u16);
    if texel == [0, 0] {
        behind.bytes
    } else if halves[3] == OPAQUE {
        let [red, green, blue, _] = halves.map(|bits| codes.codes[usize::from(bits)]);
        [red, green, blue, 255]
    } else {
        let colour = Vec4::from_array(halves.map(|bits| f16::from_bits(bits).to_f32()));
        over_background(colour, composition.exposure, behind)
    }
}
