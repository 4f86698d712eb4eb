//! Texels of base colours, and sRGB.

use gltf::image::{Data as Picture, Format};

/// The texel nearest to texture coordinates, linear; the picture repeats.
pub(crate) fn texel(picture: &Picture, [u, v]: [f32; 2]) -> [f32; 3] {
    let (width, height) = (picture.width as usize, picture.height as usize);
    let at = |coordinate: f32, size: usize| {
        let inside = coordinate.rem_euclid(1.0) * size as f32;
        // NaN gives 0.
        (inside as usize).min(size.saturating_sub(1))
    };
    let pixel = at(v, height) * width + at(u, width);
    let byte = |channel: usize, channels: usize, bytes: usize| {
        // Of 16 bits the upper byte is enough.
        let offset = (pixel * channels + channel) * bytes
            + if cfg!(target_endian = "big") {
                0
            } else {
                bytes - 1
            };
        picture.pixels.get(offset).copied().unwrap_or(255)
    };
    let rgb = |channels: usize, bytes: usize| {
        let grey = channels < 3;
        std::array::from_fn(|channel| {
            let channel = if grey { 0 } else { channel };
            linear(f32::from(byte(channel, channels, bytes)) / 255.0)
        })
    };
    match picture.format {
        Format::R8 => rgb(1, 1),
        Format::R8G8 => rgb(2, 1),
        Format::R8G8B8 => rgb(3, 1),
        Format::R8G8B8A8 => rgb(4, 1),
        Format::R16 => rgb(1, 2),
        Format::R16G16 => rgb(2, 2),
        Format::R16G16B16 => rgb(3, 2),
        Format::R16G16B16A16 => rgb(4, 2),
        // No base colour is kept in floats.
        Format::R32G32B32FLOAT | Format::R32G32B32A32FLOAT => [1.0; 3],
    }
}

/// Linear light of an sRGB value, IEC 61966-2-1; both 0 to 1.
fn linear(value: f32) -> f32 {
    if value <= 0.04045 {
        value / 12.92
    } else {
        ((value + 0.055) / 1.055).powf(2.4)
    }
}

/// sRGB value of linear light, IEC 61966-2-1; clamped to 0 to 1.
pub(crate) fn srgb(light: f32) -> f32 {
    let light = light.clamp(0.0, 1.0);
    if light <= 0.003_130_8 {
        light * 12.92
    } else {
        1.055 * light.powf(1.0 / 2.4) - 0.055
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_texel_is_taken_and_the_picture_repeats() {
        let picture = Picture {
            pixels: vec![0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0, 255],
            format: Format::R8G8B8,
            width: 2,
            height: 2,
        };
        for (uv, expected) in [
            ([0.1, 0.1], [0.0, 0.0, 0.0]),
            ([0.9, 0.4], [1.0, 0.0, 0.0]),
            ([-0.9, 1.6], [0.0, 1.0, 0.0]),
            ([1.75, 0.75], [0.0, 0.0, 1.0]),
            ([f32::NAN, 0.75], [0.0, 1.0, 0.0]),
        ] {
            assert_eq!(texel(&picture, uv), expected, "{uv:?}");
        }
    }

    #[test]
    fn srgb_and_linear_undo_each_other() {
        for step in 0..=255_u8 {
            let value = f32::from(step) / 255.0;
            assert!((srgb(linear(value)) - value).abs() < 1e-5, "{value}");
        }
    }
}
