//! The plain difference of two pictures, to look at.

use image::{Rgb, RgbImage};

/// How much differences are brightened: one step of 8 bits shows as 8, and from 32 steps on it is full.
pub const AMPLIFICATION: u8 = 8;

/// `|a − b|` of each channel in 8-bit sRGB, times [`AMPLIFICATION`]; black where the pictures are equal.
///
/// The result has the size of the smaller picture in each direction.
pub fn difference_map(a: &RgbImage, b: &RgbImage) -> RgbImage {
    let [width, height] = [a.width().min(b.width()), a.height().min(b.height())];
    RgbImage::from_fn(width, height, |x, y| {
        let (a, b) = (a.get_pixel(x, y), b.get_pixel(x, y));
        Rgb(std::array::from_fn(|channel| {
            a[channel]
                .abs_diff(b[channel])
                .saturating_mul(AMPLIFICATION)
        }))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_shown_eightfold_and_end_at_white() {
        let a = RgbImage::from_pixel(2, 1, Rgb([100, 100, 100]));
        let mut b = a.clone();
        b.put_pixel(1, 0, Rgb([98, 103, 200]));
        let map = difference_map(&a, &b);
        assert_eq!(map.get_pixel(0, 0).0, [0, 0, 0]);
        assert_eq!(map.get_pixel(1, 0).0, [16, 24, 255]);
    }
}
