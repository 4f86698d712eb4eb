//! A picture, and smaller versions of it to take means from.
//!
//! The picture itself stays as sRGB bytes, 4 a texel. Each smaller version has half the texels of the one before in each direction,
//! rounded down, and at least one; a texel of it is the mean of exactly the part that it covers, also where sizes are odd. They
//! are kept as linear light times alpha in 16 bits a component: all of them together take less than 3 bytes for each texel of
//! the picture.

use std::io::Cursor;
use std::sync::Arc;

use image::{ImageFormat, ImageReader, Limits};
use rayon::prelude::*;

use crate::light::linear_of;

/// Texels of the largest picture that is read: 16 384 × 8192, which takes 0.9 GB.
pub const MOST_TEXELS: u64 = 1 << 27;

/// Texels that one byte of a file can at most make: deflate makes 1032 bytes of one, and a byte holds 8 texels of one bit.
const MOST_TEXELS_A_BYTE: u64 = 8 * 1032;

/// Why a picture is not read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// Neither format.
    #[error("it is neither PNG nor JPEG")]
    OtherFormat,
    /// It would take too much memory, or says more than it can hold.
    #[error(
        "it says that it has {width} × {height} texels, expected at most {MOST_TEXELS}, and no more than its {bytes} bytes can hold"
    )]
    TooLarge {
        /// Texels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// Bytes of the file.
        bytes: u64,
    },
    /// The decoder stopped.
    #[error("it is damaged or truncated: {0}")]
    Damaged(#[from] image::ImageError),
}

/// What is made of a picture's alpha.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Alpha {
    /// A texel counts as much as it covers.
    #[default]
    Respected,
    /// All texels count in full.
    Ignored,
}

/// A picture as its file holds it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PictureFile {
    /// What the mesh's file calls it.
    pub name: Arc<str>,
    /// A whole PNG or JPEG file.
    pub bytes: Arc<[u8]>,
}

impl PictureFile {
    /// Extension of a file of its kind: `png` or `jpg`.
    pub fn extension(&self) -> &'static str {
        match image::guess_format(&self.bytes) {
            Ok(ImageFormat::Png) => "png",
            _ => "jpg",
        }
    }
}

/// A picture.
#[derive(Debug)]
pub struct Picture {
    /// What it was decoded from, for those that keep it.
    file: Option<PictureFile>,
    /// The picture, then smaller and smaller ones down to one texel.
    levels: Vec<Level>,
}

#[derive(Debug)]
pub(crate) struct Level {
    pub(crate) width: usize,
    pub(crate) height: usize,
    texels: Texels,
}

#[derive(Debug)]
enum Texels {
    /// sRGB with straight alpha.
    Bytes(Vec<u8>),
    /// Linear light times alpha.
    Words(Vec<[u16; 4]>),
}

impl Picture {
    /// Decodes a PNG or JPEG file, and keeps it with its name.
    ///
    /// # Errors
    /// As of [`decode`](Self::decode).
    pub fn of_file(name: &str, bytes: Vec<u8>, alpha: Alpha) -> Result<Self, PictureError> {
        let mut picture = Self::decode(&bytes, alpha)?;
        picture.file = Some(PictureFile {
            name: name.into(),
            bytes: bytes.into(),
        });
        Ok(picture)
    }

    /// Decodes a PNG or JPEG file.
    ///
    /// # Errors
    /// It is of another format, too large, or damaged.
    pub fn decode(file: &[u8], alpha: Alpha) -> Result<Self, PictureError> {
        let format = image::guess_format(file).map_err(|_| PictureError::OtherFormat)?;
        if !matches!(format, ImageFormat::Png | ImageFormat::Jpeg) {
            return Err(PictureError::OtherFormat);
        }
        let (width, height) =
            ImageReader::with_format(Cursor::new(file), format).into_dimensions()?;
        let (texels, bytes) = (u64::from(width) * u64::from(height), file.len() as u64);
        if texels > MOST_TEXELS.min(bytes.saturating_mul(MOST_TEXELS_A_BYTE)) {
            return Err(PictureError::TooLarge {
                width,
                height,
                bytes,
            });
        }
        let mut reader = ImageReader::with_format(Cursor::new(file), format);
        let mut limits = Limits::default();
        // Up to 16 bits in four channels; what is decoded row by row takes little beside.
        limits.max_alloc = Some(8 * texels + (1 << 20));
        reader.limits(limits);
        let decoded = reader.decode()?.into_rgba8().into_raw();
        Ok(Self::from_rgba(
            width as usize,
            height as usize,
            decoded,
            alpha,
        ))
    }

    /// A picture of sRGB bytes with straight alpha, row by row from the top.
    ///
    /// # Panics
    /// There are no texels, or another number of bytes than four for each.
    pub fn from_rgba(width: usize, height: usize, mut bytes: Vec<u8>, alpha: Alpha) -> Self {
        assert!(
            width > 0 && height > 0 && bytes.len() == width * height * 4,
            "four bytes a texel"
        );
        if alpha == Alpha::Ignored {
            for texel in bytes.as_chunks_mut::<4>().0 {
                texel[3] = 255;
            }
        }
        let mut levels = vec![Level {
            width,
            height,
            texels: Texels::Bytes(bytes),
        }];
        while let Some(last) = levels.last()
            && (last.width, last.height) != (1, 1)
        {
            let next = last.halved();
            levels.push(next);
        }
        Self { file: None, levels }
    }

    /// The file that it was made [of](Self::of_file).
    pub fn file(&self) -> Option<&PictureFile> {
        self.file.as_ref()
    }

    /// Texels in a row, and rows.
    pub fn size(&self) -> [usize; 2] {
        [self.levels[0].width, self.levels[0].height]
    }

    pub(crate) fn levels(&self) -> &[Level] {
        &self.levels
    }
}

impl Level {
    /// Linear light times alpha, and alpha, of a texel that is there.
    #[inline]
    pub(crate) fn texel(&self, x: usize, y: usize) -> [f32; 4] {
        let index = y * self.width + x;
        match &self.texels {
            Texels::Bytes(bytes) => {
                let [red, green, blue, alpha] = bytes.as_chunks::<4>().0[index];
                let cover = f32::from(alpha) / 255.0;
                let [red, green, blue] = [red, green, blue].map(|byte| linear_of(byte) * cover);
                [red, green, blue, cover]
            }
            Texels::Words(words) => words[index].map(|word| f32::from(word) / 65535.0),
        }
    }

    /// The level with half the texels in each direction.
    fn halved(&self) -> Self {
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        let columns = taps(self.width, width);
        let rows = taps(self.height, height);
        let mut words = vec![[0; 4]; width * height];
        let pairs = words.par_chunks_mut(width).zip(&rows);
        pairs.for_each(|(slots, row_taps)| {
            for (slot, column_taps) in slots.iter_mut().zip(&columns) {
                let mut sum = [0.0; 4];
                for (y, row_weight) in row_taps.weights() {
                    for (x, weight) in column_taps.weights() {
                        let texel = self.texel(x, y);
                        for (sum, value) in sum.iter_mut().zip(texel) {
                            *sum += value * row_weight * weight;
                        }
                    }
                }
                *slot = sum.map(|value: f32| (value * 65535.0 + 0.5) as u16);
            }
        });
        Self {
            width,
            height,
            texels: Texels::Words(words),
        }
    }
}

/// What a texel of a smaller level covers of a row or column of the larger one: texels from `first` on, and how much of each.
struct Taps {
    first: usize,
    /// Sums to 1. At most three texels to one, and one more where the two rows of texels do not begin together.
    parts: [f32; 4],
}

impl Taps {
    fn weights(&self) -> impl Iterator<Item = (usize, f32)> {
        let parts = self.parts.iter().enumerate();
        parts
            .filter(|(_, part)| **part > 0.0)
            .map(|(offset, part)| (self.first + offset, *part))
    }
}

fn taps(from: usize, to: usize) -> Vec<Taps> {
    // In units of 1/to of a texel all borders are whole numbers.
    let of = |index: usize| {
        let (start, end) = (index * from, (index + 1) * from);
        let first = start / to;
        let parts = std::array::from_fn(|offset| {
            let texel = first + offset;
            let covered = end
                .min((texel + 1) * to)
                .saturating_sub(start.max(texel * to));
            covered as f32 / from as f32
        });
        Taps { first, parts }
    };
    (0..to).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::srgb_byte;

    fn png(width: u32, height: u32) -> Vec<u8> {
        let mut file = Vec::new();
        image::RgbImage::from_fn(width, height, |x, y| image::Rgb([x as u8, y as u8, 7]))
            .write_to(&mut Cursor::new(&mut file), ImageFormat::Png)
            .unwrap();
        file
    }

    #[test]
    fn the_last_level_is_the_mean_of_all_whatever_the_size() {
        for (width, height) in [(1, 1), (8, 8), (7, 5), (3, 1), (13, 2), (1, 9)] {
            let bytes: Vec<u8> = (0..width * height * 4)
                .map(|index| {
                    if index % 4 == 3 {
                        255
                    } else {
                        (index * 37 % 251) as u8
                    }
                })
                .collect();
            let mut expected = [0.0; 3];
            for texel in bytes.as_chunks::<4>().0 {
                for (sum, byte) in expected.iter_mut().zip(texel) {
                    *sum += linear_of(*byte) / (width * height) as f32;
                }
            }
            let picture = Picture::from_rgba(width, height, bytes, Alpha::Respected);
            let last = picture.levels.last().unwrap();
            assert_eq!((last.width, last.height), (1, 1));
            let found = last.texel(0, 0);
            for (found, expected) in found.iter().zip(expected) {
                // A level rounds by half a step of 16 bits.
                assert!(
                    (found - expected).abs() < 5e-5,
                    "{width}×{height}: {found} {expected}"
                );
            }
        }
    }

    #[test]
    fn png_and_jpeg_are_decoded_and_others_are_refused() {
        let picture = Picture::decode(&png(40, 20), Alpha::Respected).unwrap();
        assert_eq!(picture.size(), [40, 20]);
        let texel = picture.levels[0].texel(30, 10);
        assert_eq!(texel.map(srgb_byte)[..3], [30, 10, 7]);
        let mut jpeg = Vec::new();
        image::RgbImage::from_pixel(16, 16, image::Rgb([200, 100, 50]))
            .write_to(&mut Cursor::new(&mut jpeg), ImageFormat::Jpeg)
            .unwrap();
        let picture = Picture::decode(&jpeg, Alpha::Respected).unwrap();
        for (found, expected) in picture.levels[0].texel(8, 8).iter().zip([200_u8, 100, 50]) {
            assert!(
                srgb_byte(*found).abs_diff(expected) <= 2,
                "{found} {expected}"
            );
        }
        for file in [&b"GIF89a............"[..], b"", b"hello"] {
            let error = Picture::decode(file, Alpha::Respected).unwrap_err();
            assert!(matches!(error, PictureError::OtherFormat), "{error}");
        }
        let mut cut = png(40, 20);
        cut.truncate(60);
        let error = Picture::decode(&cut, Alpha::Respected).unwrap_err();
        assert!(matches!(error, PictureError::Damaged(_)), "{error}");
    }

    #[test]
    fn sizes_are_looked_at_before_memory_is_taken() {
        for (width, height) in [(60_000_u32, 60_000_u32), (11_000, 11_000)] {
            let mut file = png(4, 4);
            file[16..20].copy_from_slice(&width.to_be_bytes());
            file[20..24].copy_from_slice(&height.to_be_bytes());
            // The header's own checksum.
            let crc = crc32(&file[12..29]);
            file[29..33].copy_from_slice(&crc.to_be_bytes());
            let error = Picture::decode(&file, Alpha::Respected).unwrap_err();
            assert!(matches!(error, PictureError::TooLarge { .. }), "{error}");
        }
    }

    fn crc32(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(!0, |crc, byte| {
            (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
                if crc & 1 == 1 {
                    (crc >> 1) ^ 0xedb8_8320
                } else {
                    crc >> 1
                }
            })
        })
    }

    #[test]
    fn alpha_can_be_ignored() {
        let bytes = vec![255, 0, 0, 0, 0, 255, 0, 255];
        let respected = Picture::from_rgba(2, 1, bytes.clone(), Alpha::Respected);
        assert_eq!(respected.levels[0].texel(0, 0), [0.0; 4]);
        let ignored = Picture::from_rgba(2, 1, bytes, Alpha::Ignored);
        assert_eq!(ignored.levels[0].texel(0, 0), [1.0, 0.0, 0.0, 1.0]);
    }
}
