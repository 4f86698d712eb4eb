//! Peak signal-to-noise ratio.

use image::RgbImage;

/// PSNR of `picture` over the pixels of `mask`, dB: `10 · log₁₀(255² / mean square difference)`, the mean over pixels and
/// the three channels of 8-bit sRGB.
///
/// Infinite where the pictures are equal; none where the mask has no pixels. The pictures and the mask are of one size.
pub fn psnr_db(reference: &RgbImage, picture: &RgbImage, mask: &[bool]) -> Option<f64> {
    let pairs = reference.pixels().zip(picture.pixels()).zip(mask);
    let (mut squares, mut count) = (0_u64, 0_u64);
    for ((a, b), _) in pairs.filter(|(_, is_in)| **is_in) {
        count += 3;
        squares += (0..3)
            .map(|channel| u64::from(a[channel].abs_diff(b[channel])).pow(2))
            .sum::<u64>();
    }
    // 255² over 0 is infinity, as it should be.
    (count > 0).then(|| 10.0 * (255.0 * 255.0 / (squares as f64 / count as f64)).log10())
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    fn grey(value: u8) -> RgbImage {
        RgbImage::from_pixel(4, 2, Rgb([value; 3]))
    }

    #[test]
    fn a_constant_offset_has_its_closed_form() {
        let db = psnr_db(&grey(100), &grey(110), &[true; 8]).expect("pixels");
        // 20 · log₁₀(255 / 10).
        assert!((db - 20.0 * 25.5_f64.log10()).abs() < 1e-9, "{db} dB");
        let worst = psnr_db(&grey(0), &grey(255), &[true; 8]);
        assert_eq!(worst, Some(0.0), "black against white");
    }

    #[test]
    fn equal_pictures_are_infinitely_close() {
        assert_eq!(psnr_db(&grey(7), &grey(7), &[true; 8]), Some(f64::INFINITY));
    }

    #[test]
    fn only_the_mask_counts() {
        let mut picture = grey(100);
        picture.put_pixel(0, 0, Rgb([255; 3]));
        let mut mask = [true; 8];
        mask[0] = false;
        assert_eq!(psnr_db(&grey(100), &picture, &mask), Some(f64::INFINITY));
        assert_eq!(psnr_db(&grey(100), &picture, &[false; 8]), None);
    }
}
