//! PNG with the settings in its metadata, so that a picture can be made again.

use std::borrow::Cow;
use std::io::Write;

/// Why a picture has no PNG form.
#[derive(Debug, thiserror::Error)]
#[error("the picture cannot be encoded as PNG: {0}")]
pub(crate) struct PngError(#[from] png::EncodingError);

impl PngError {
    /// What the system said, if it is not about PNG at all.
    pub(crate) fn into_io(self) -> Result<std::io::Error, Self> {
        match self.0 {
            png::EncodingError::IoError(error) => Ok(error),
            other => Err(Self(other)),
        }
    }
}

/// Whether pixels have a fourth byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Alpha {
    /// Straight alpha.
    Straight,
    /// All pixels are opaque.
    None,
}

impl Alpha {
    /// Bytes of a pixel in the file.
    pub(crate) fn channels(self) -> usize {
        match self {
            Self::Straight => 4,
            Self::None => 3,
        }
    }
}

/// The bytes of a PNG file.
///
/// `rgba` is 4 bytes a pixel, sRGB with straight alpha, rows from the top; a picture without transparency is stored as RGB.
/// `record` goes into the text chunk `Pointstage` (UTF-8, JSON): what the picture was made from.
pub(crate) fn encode(
    size_px: [u32; 2],
    rgba: &[u8],
    record: &serde_json::Value,
) -> Result<Vec<u8>, PngError> {
    let is_opaque = rgba.chunks_exact(4).all(|pixel| pixel[3] == 255);
    let (alpha, pixels): (_, Cow<'_, [u8]>) = if is_opaque {
        let rgb = rgba.chunks_exact(4).flat_map(|pixel| &pixel[..3]).copied();
        (Alpha::None, rgb.collect())
    } else {
        (Alpha::Straight, rgba.into())
    };
    let mut bytes = Vec::new();
    let mut writer = begin(&mut bytes, size_px, alpha, record)?;
    writer.write_image_data(&pixels)?;
    writer.finish()?;
    Ok(bytes)
}

/// Writes all that comes before the pixels.
pub(crate) fn begin<W: Write>(
    file: W,
    [width, height]: [u32; 2],
    alpha: Alpha,
    record: &serde_json::Value,
) -> Result<png::Writer<W>, PngError> {
    let mut encoder = png::Encoder::new(file, width, height);
    encoder.set_color(match alpha {
        Alpha::Straight => png::ColorType::Rgba,
        Alpha::None => png::ColorType::Rgb,
    });
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.add_text_chunk(
        "Software".to_owned(),
        format!("Pointstage {}", env!("CARGO_PKG_VERSION")),
    )?;
    encoder.add_itxt_chunk("Pointstage".to_owned(), record.to_string())?;
    Ok(encoder.write_header()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(bytes: &[u8]) -> (png::ColorType, Vec<u8>, String) {
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
            .read_info()
            .expect("a PNG");
        let mut pixels = vec![0; reader.output_buffer_size().expect("small")];
        reader.next_frame(&mut pixels).expect("one frame");
        let chunk = &reader.info().utf8_text[0];
        let text = chunk.get_text().expect("UTF-8");
        (reader.info().color_type, pixels, text)
    }

    #[test]
    fn an_opaque_picture_is_rgb_and_carries_its_record() {
        let record = serde_json::json!({"renderer": "points", "file": "Büste.ply"});
        let bytes = encode([1, 2], &[1, 2, 3, 255, 4, 5, 6, 255], &record).expect("encodes");
        let (colour, pixels, text) = decoded(&bytes);
        assert_eq!(colour, png::ColorType::Rgb);
        assert_eq!(pixels, [1, 2, 3, 4, 5, 6]);
        assert_eq!(text, record.to_string());
    }

    #[test]
    fn transparency_is_kept() {
        let bytes = encode([1, 1], &[1, 2, 3, 4], &serde_json::Value::Null).expect("encodes");
        assert_eq!(decoded(&bytes).1, [1, 2, 3, 4]);
    }
}
