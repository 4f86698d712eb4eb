//! Structural similarity, by the crate `image-compare`.
//!
//! Which SSIM it is, for there are many: that of Wang et al. (Structural Similarity 2004) in its simple form, on luma (the
//! weights of Rec. 709 over gamma-encoded sRGB, cut to 8 bits), in windows of 8×8 pixels that do not overlap, with equal
//! weights (those at the right and lower border may be smaller). All pixels of a window have its similarity, so an interior or
//! an edge has the mean over its pixels of the windows that they lie in.
//!
//! Where the crate differs from the paper: it sums squares over a window where the paper takes their mean. For a window of N
//! pixels that is the paper's formula with `K₂ = 0.03/√N`, in a whole window 0.00375 (K₁ is 0.01 as there): faint structure
//! counts for more. Values compare among themselves, not with published ones.
//!
//! The crate is asked window by window: it makes a map of them by itself, but gives it away only in 8 bits.

use image::{GrayImage, RgbImage};
use image_compare::{Algorithm, gray_similarity_structure};
use rayon::prelude::*;

/// Side of a window, px: the crate's own, so that what is asked for one has one.
const WINDOW_PX: u32 = 8;

/// Similarity of every pixel's window, −1..1, 1 where the windows are equal; rows from the top.
///
/// None if the pictures are of different sizes.
pub fn similarity_map(reference: &RgbImage, picture: &RgbImage) -> Option<Vec<f32>> {
    if reference.dimensions() != picture.dimensions() {
        return None;
    }
    let luma = image::imageops::grayscale;
    let (reference, picture) = (luma(reference), luma(picture));
    let [across, down] = [reference.width(), reference.height()].map(|px| px.div_ceil(WINDOW_PX));
    // From within the thread pool, since the crate goes there for every window.
    let windows: Option<Vec<f32>> = (0..across * down)
        .into_par_iter()
        .map(|window| {
            let corner = [window % across, window / across].map(|window| window * WINDOW_PX);
            similarity_of_window(&reference, &picture, corner)
        })
        .collect();
    let windows = windows?;
    let pixels = reference.enumerate_pixels();
    let map = pixels.map(|(x, y, _)| windows[((y / WINDOW_PX) * across + x / WINDOW_PX) as usize]);
    Some(map.collect())
}

/// SSIM of the window whose upper left pixel is `corner`.
fn similarity_of_window(
    reference: &GrayImage,
    picture: &GrayImage,
    [x, y]: [u32; 2],
) -> Option<f32> {
    let cut = |of: &GrayImage| {
        let [width, height] = [of.width() - x, of.height() - y].map(|px| px.min(WINDOW_PX));
        image::imageops::crop_imm(of, x, y, width, height).to_image()
    };
    let (reference, picture) = (cut(reference), cut(picture));
    let similarity = gray_similarity_structure(&Algorithm::MSSIMSimple, &reference, &picture);
    Some(similarity.ok()?.score as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    fn grey(size: [u32; 2], value: impl Fn(u32, u32) -> u8) -> RgbImage {
        RgbImage::from_fn(size[0], size[1], |x, y| Rgb([value(x, y); 3]))
    }

    #[test]
    fn flat_pictures_differ_by_their_means_alone() {
        let (a, b) = (grey([8, 8], |_, _| 100), grey([8, 8], |_, _| 120));
        let map = similarity_map(&a, &b).expect("one size");
        // (2ab + C₁) / (a² + b² + C₁) with C₁ = (0.01 · 255)².
        let c1 = 2.55_f32 * 2.55;
        let expected = (2.0 * 100.0 * 120.0 + c1) / (100.0 * 100.0 + 120.0 * 120.0 + c1);
        assert!((map[0] - expected).abs() < 1e-5, "{} {expected}", map[0]);
    }

    #[test]
    fn squares_are_summed_over_a_window() {
        let board = |amplitude: u8| {
            grey([8, 8], move |x, y| match (x + y) % 2 {
                0 => 128 - amplitude,
                _ => 128 + amplitude,
            })
        };
        let map = similarity_map(&board(4), &board(2)).expect("one size");
        // Sums over 64 pixels: 16, 4 and 8 a pixel; C₂ = (0.03 · 255)².
        let c2 = 7.65_f32 * 7.65;
        let expected = (2.0 * 64.0 * 8.0 + c2) / (64.0 * 16.0 + 64.0 * 4.0 + c2);
        assert!((map[0] - expected).abs() < 1e-5, "{} {expected}", map[0]);
    }

    #[test]
    fn each_window_stands_alone_and_those_at_the_border_are_smaller() {
        let a = grey([19, 9], |x, y| (7 * x + 13 * y) as u8);
        let mut b = a.clone();
        b.put_pixel(18, 8, Rgb([255; 3]));
        let map = similarity_map(&a, &b).expect("one size");
        for (index, similarity) in map.iter().enumerate() {
            let [x, y] = [index % 19, index / 19];
            let is_in_last = x >= 16 && y >= 8;
            assert_eq!(*similarity < 1.0, is_in_last, "{x}, {y}: {similarity}");
        }
    }

    #[test]
    fn pictures_of_different_sizes_have_none() {
        assert_eq!(
            similarity_map(&RgbImage::new(2, 2), &RgbImage::new(3, 2)),
            None
        );
        assert_eq!(
            similarity_map(&RgbImage::new(0, 0), &RgbImage::new(0, 0)),
            Some(vec![])
        );
    }
}
