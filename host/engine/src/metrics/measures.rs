//! All metrics of a picture, over every region.

use image::RgbImage;
use serde::Serialize;

use super::difference::difference_map;
use super::flip::flip;
use super::pool::{mean, percentile, values_in};
use super::psnr::psnr_db;
use super::regions::Regions;
use super::ssim::similarity_map;

/// Where 'the worst' of FLIP is read: beyond it are single pixels.
const WORST: f64 = 0.99;

/// How far a picture is from the reference within a region. Written as JSON, a number that is none or infinite is `null`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Measures {
    /// Pixels of the region.
    pub pixels: usize,
    /// See [`psnr`](super::psnr); infinite where `identical`, none without pixels.
    pub psnr_db: Option<f64>,
    /// Whether there are pixels and all of them are equal.
    pub identical: bool,
    /// Mean of [`ssim`](super::ssim); none without pixels.
    pub ssim: Option<f64>,
    /// Mean of [`flip`](super::flip); none without pixels or without FLIP.
    pub flip_mean: Option<f64>,
    /// 99th percentile of the same.
    pub flip_p99: Option<f64>,
}

/// What [`measure`] finds.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Over every pixel.
    pub whole: Measures,
    /// Over the silhouette's interior.
    pub interior: Measures,
    /// Over its edge.
    pub edge: Measures,
    /// FLIP's errors in colours; none if the program was built without FLIP.
    pub flip_map: Option<RgbImage>,
    /// [`difference_map`] of the two.
    pub difference_map: RgbImage,
}

/// Why pictures cannot be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MetricsError {
    /// The pictures or the masks are not of one size.
    #[error(
        "pictures of {}×{} and {}×{} pixels with masks of {mask_len} pixels cannot be compared; draw them in one size",
        reference.0, reference.1, picture.0, picture.1
    )]
    Sizes {
        /// Width and height, px.
        reference: (u32, u32),
        /// Width and height, px.
        picture: (u32, u32),
        /// Pixels of the masks.
        mask_len: usize,
    },
}

/// Measures how far `picture` is from `reference`.
///
/// # Errors
/// When pictures and regions are not of one size.
pub fn measure(
    reference: &RgbImage,
    picture: &RgbImage,
    regions: &Regions,
) -> Result<Measured, MetricsError> {
    let pixels = u64::from(reference.width()) * u64::from(reference.height());
    let Regions {
        whole,
        interior,
        edge,
    } = regions;
    let masks = [whole, interior, edge];
    let odd = masks.into_iter().find(|mask| mask.len() as u64 != pixels);
    if odd.is_some() || reference.dimensions() != picture.dimensions() {
        return Err(MetricsError::Sizes {
            reference: reference.dimensions(),
            picture: picture.dimensions(),
            mask_len: odd.unwrap_or(whole).len(),
        });
    }
    let similarities = similarity_map(reference, picture);
    let flip = flip(reference, picture);
    let over = |mask: &[bool]| {
        let psnr_db = psnr_db(reference, picture, mask);
        let similarities = similarities.as_ref().map(|map| values_in(map, mask));
        let mut errors = flip.as_ref().map(|flip| values_in(&flip.errors, mask));
        Measures {
            pixels: mask.iter().filter(|is_in| **is_in).count(),
            psnr_db,
            identical: psnr_db == Some(f64::INFINITY),
            ssim: similarities.and_then(|values| mean(&values)),
            flip_mean: errors.as_ref().and_then(|values| mean(values)),
            flip_p99: errors.as_mut().and_then(|values| percentile(values, WORST)),
        }
    };
    Ok(Measured {
        whole: over(whole),
        interior: over(interior),
        edge: over(edge),
        flip_map: flip.map(|flip| flip.map),
        difference_map: difference_map(reference, picture),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    /// A disk of a gradient before white, 40 by 30 pixels, and which pixels it covers.
    fn scene(shift: u8) -> (RgbImage, Regions) {
        let is_in = |x: u32, y: u32| (x as i32 - 20).pow(2) + (y as i32 - 15).pow(2) <= 100;
        let picture = RgbImage::from_fn(40, 30, |x, y| {
            if is_in(x, y) {
                Rgb([(4 * x) as u8, (5 * y) as u8 + shift, 90])
            } else {
                Rgb([255; 3])
            }
        });
        let covered: Vec<bool> = (0..40 * 30).map(|i| is_in(i % 40, i / 40)).collect();
        let regions = Regions::new([40, 30], &covered).expect("one a pixel");
        (picture, regions)
    }

    #[test]
    fn a_picture_is_identical_to_itself() {
        let (picture, regions) = scene(0);
        let measured = measure(&picture, &picture, &regions).expect("one size");
        for measures in [measured.whole, measured.interior, measured.edge] {
            assert!(measures.identical && measures.pixels > 0);
            assert_eq!(measures.psnr_db, Some(f64::INFINITY));
            // Of equal pictures, dividend and divisor are equal to the last bit.
            assert_eq!(measures.ssim, Some(1.0));
            if cfg!(feature = "flip") {
                assert_eq!(
                    (measures.flip_mean, measures.flip_p99),
                    (Some(0.0), Some(0.0))
                );
            }
        }
        assert!(
            measured
                .difference_map
                .pixels()
                .all(|pixel| pixel.0 == [0; 3])
        );
    }

    #[test]
    fn a_fault_of_the_shading_weighs_more_in_the_interior() {
        let ((reference, regions), (picture, _)) = (scene(0), scene(12));
        let measured = measure(&reference, &picture, &regions).expect("one size");
        let of = |measures: Measures| measures.psnr_db.expect("pixels");
        // All of the interior is off by 12 in one channel of three.
        let expected = 10.0 * (255.0_f64 * 255.0 / (144.0 / 3.0)).log10();
        assert!((of(measured.interior) - expected).abs() < 1e-9);
        assert!(of(measured.whole) > of(measured.edge), "{measured:?}");
        assert!(of(measured.edge) > of(measured.interior), "{measured:?}");
        let similar = measured.interior.ssim.expect("pixels");
        assert!(similar > 0.5 && similar < 1.0, "{similar}");
    }

    #[test]
    fn a_region_without_pixels_has_no_numbers() {
        let (picture, _) = scene(0);
        let regions = Regions::new([40, 30], &[false; 1200]).expect("one a pixel");
        let measured = measure(&picture, &picture, &regions).expect("one size");
        assert_eq!(measured.interior, Measures::default());
        assert!(measured.whole.identical);
    }

    #[test]
    fn json_has_null_for_what_is_none_or_infinite() {
        let measures = Measures {
            pixels: 3,
            psnr_db: Some(f64::INFINITY),
            identical: true,
            ..Measures::default()
        };
        let json = serde_json::to_value(measures).expect("plain data");
        assert_eq!(json["psnr_db"], serde_json::Value::Null);
        assert_eq!(json["ssim"], serde_json::Value::Null);
        assert_eq!(json["identical"], true);
    }

    #[test]
    fn pictures_of_one_pixel_have_numbers_and_other_sizes_an_error() {
        let one = RgbImage::from_pixel(1, 1, Rgb([9; 3]));
        let regions = Regions::new([1, 1], &[true]).expect("one a pixel");
        let measured = measure(&one, &one, &regions).expect("one size");
        assert_eq!(measured.whole.ssim, Some(1.0));
        let error = measure(&one, &scene(0).0, &regions).expect_err("two sizes");
        assert!(error.to_string().contains("1×1 and 40×30"), "{error}");
    }
}
