//! How far two pictures are apart.

use std::fmt;
use std::path::Path;

use anyhow::{Context as _, Result, ensure};
use image::{Rgba, RgbaImage};

/// How much a difference is brightened in [`difference_image`]: 8 steps of 255 show as a quarter of full.
const AMPLIFICATION: u8 = 8;

/// The distance between two pictures of equal size, in 8-bit sRGB, over all four channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Peak signal-to-noise ratio, dB; infinite for equal pictures.
    pub psnr_db: f64,
    /// The largest difference of a channel, 0..=255.
    pub largest: u8,
    /// Fraction of the pixels that differ at all, 0..=1.
    pub differing: f64,
}

impl fmt::Display for Difference {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            psnr_db,
            largest,
            differing,
        } = self;
        write!(
            formatter,
            "{psnr_db:.1} dB, largest difference {largest}, {:.3} % of the pixels",
            differing * 100.0
        )
    }
}

/// Measures how far `actual` is from `expected`.
///
/// # Errors
/// When the sizes differ.
pub fn compare(actual: &RgbaImage, expected: &RgbaImage) -> Result<Difference> {
    same_size(actual, expected)?;
    let mut squares = 0.0;
    let mut largest = 0;
    let mut differing = 0_u64;
    for (a, b) in actual.pixels().zip(expected.pixels()) {
        let apart = distances(*a, *b);
        differing += u64::from(apart != [0; 4]);
        for channel in apart {
            squares += f64::from(channel) * f64::from(channel);
            largest = largest.max(channel);
        }
    }
    let pixels = f64::from(actual.width()) * f64::from(actual.height());
    ensure!(pixels > 0.0, "both pictures are empty");
    let mean_square = squares / (4.0 * pixels);
    // 255² over 0 is infinity, as it should be.
    let psnr_db = 10.0 * (255.0 * 255.0 / mean_square).log10();
    Ok(Difference {
        psnr_db,
        largest,
        differing: differing as f64 / pixels,
    })
}

/// Where two pictures differ: black where they are equal, colour by channel, brightened, where they are not.
///
/// # Errors
/// When the sizes differ.
pub fn difference_image(actual: &RgbaImage, expected: &RgbaImage) -> Result<RgbaImage> {
    same_size(actual, expected)?;
    Ok(RgbaImage::from_fn(
        actual.width(),
        actual.height(),
        |x, y| {
            let [red, green, blue, alpha] =
                distances(*actual.get_pixel(x, y), *expected.get_pixel(x, y));
            // A difference of alpha alone shows as grey.
            let shown = |channel: u8| channel.max(alpha).saturating_mul(AMPLIFICATION);
            Rgba([shown(red), shown(green), shown(blue), 255])
        },
    ))
}

/// Reads a picture of any depth as 8-bit RGBA.
///
/// # Errors
/// When there is no such picture or it cannot be read.
pub fn read(path: &Path) -> Result<RgbaImage> {
    let picture = image::open(path).with_context(|| format!("reading {}", path.display()))?;
    Ok(picture.into_rgba8())
}

/// Fraction of the pixels whose colour differs from `background` by more than `tolerance` in some channel.
pub fn covered(picture: &RgbaImage, background: Rgba<u8>, tolerance: u8) -> f64 {
    let count = picture
        .pixels()
        .filter(|pixel| {
            distances(**pixel, background)
                .iter()
                .any(|&d| d > tolerance)
        })
        .count();
    count as f64 / (f64::from(picture.width()) * f64::from(picture.height())).max(1.0)
}

fn distances(a: Rgba<u8>, b: Rgba<u8>) -> [u8; 4] {
    std::array::from_fn(|channel| a.0[channel].abs_diff(b.0[channel]))
}

fn same_size(actual: &RgbaImage, expected: &RgbaImage) -> Result<()> {
    let (a, b) = (actual.dimensions(), expected.dimensions());
    ensure!(
        a == b,
        "the picture is {}×{}, expected {}×{}",
        a.0,
        a.1,
        b.0,
        b.1
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(value: u8) -> RgbaImage {
        RgbaImage::from_pixel(4, 2, Rgba([value, value, value, 255]))
    }

    #[test]
    fn equal_pictures_are_infinitely_close() {
        let difference = compare(&grey(7), &grey(7)).unwrap();
        assert_eq!(
            difference,
            Difference {
                psnr_db: f64::INFINITY,
                largest: 0,
                differing: 0.0
            }
        );
    }

    #[test]
    fn one_pixel_counts_once() {
        let mut picture = grey(100);
        picture.put_pixel(1, 1, Rgba([110, 100, 100, 255]));
        let difference = compare(&picture, &grey(100)).unwrap();
        // Mean square 10² over 8 pixels of 4 channels.
        let expected = 10.0 * (255.0 * 255.0 / (100.0_f64 / 32.0)).log10();
        assert!((difference.psnr_db - expected).abs() < 1e-9, "{difference}");
        assert_eq!((difference.largest, difference.differing), (10, 0.125));
    }

    #[test]
    fn sizes_must_agree() {
        let error = compare(&grey(0), &RgbaImage::new(2, 2))
            .unwrap_err()
            .to_string();
        assert_eq!(error, "the picture is 4×2, expected 2×2");
    }

    #[test]
    fn the_difference_image_is_black_but_where_they_differ() {
        let mut picture = grey(100);
        picture.put_pixel(3, 0, Rgba([100, 102, 100, 255]));
        let difference = difference_image(&picture, &grey(100)).unwrap();
        assert_eq!(difference.get_pixel(3, 0).0, [0, 16, 0, 255]);
        assert_eq!(difference.get_pixel(0, 0).0, [0, 0, 0, 255]);
    }

    #[test]
    fn covered_counts_what_is_not_background() {
        let mut picture = grey(10);
        picture.put_pixel(0, 0, Rgba([200, 10, 10, 255]));
        picture.put_pixel(1, 0, Rgba([12, 10, 10, 255]));
        assert_eq!(covered(&picture, Rgba([10, 10, 10, 255]), 4), 0.125);
    }
}
