//! Structural similarity, as published: that of Wang et al. (Structural Similarity 2004).
//!
//! Around each pixel a Gaussian window of 11×11 pixels, of deviation 1.5, gives both pictures' means μ, variances σ² and their
//! covariance; with `C₁ = (0.01 · 255)²` and `C₂ = (0.03 · 255)²`
//!
//! ```text
//! SSIM = (2 μa μb + C₁) (2 σab + C₂) / ((μa² + μb² + C₁) (σa² + σb² + C₂))
//! ```
//!
//! It is taken on luma: the weights of Rec. 709 over gamma-encoded sRGB, 0..255, not rounded. The paper leaves open what happens
//! at the picture's border; here a window that reaches over it is cut, and its weights sum to 1 again.
//!
//! Why our own: the crate `image-compare` has windows of 8×8 pixels side by side, and sums squares over a window where the paper
//! takes their mean, which makes K₂ of a whole window 0.00375 and not 0.03. Its values compare with no published ones.

use image::RgbImage;
use rayon::prelude::*;

/// How far the window reaches from its pixel, px: 11×11 in all.
const REACH: usize = 5;

/// Standard deviation of the window's Gaussian, px.
const SIGMA_PX: f64 = 1.5;

/// Keeps the quotient of means from 0/0; K₁ is 0.01.
const C1: f64 = (0.01 * 255.0) * (0.01 * 255.0);

/// Keeps the quotient of variances from 0/0; K₂ is 0.03.
const C2: f64 = (0.03 * 255.0) * (0.03 * 255.0);

/// Similarity around every pixel, −1..1, 1 where the windows are equal; rows from the top.
///
/// None if the pictures are of different sizes.
pub fn similarity_map(reference: &RgbImage, picture: &RgbImage) -> Option<Vec<f32>> {
    if reference.dimensions() != picture.dimensions() {
        return None;
    }
    let [width, height] = [reference.width(), reference.height()].map(|px| px as usize);
    let (a, b) = (luma(reference), luma(picture));
    let half = half_window();
    let mut map = vec![0.0; width * height];
    // At least 1, since there are no chunks of nothing.
    let rows = map.par_chunks_mut(width.max(1)).enumerate();
    rows.for_each(|(y, row)| {
        // The window is a product: columns first, then along the row.
        let columns: Vec<Moments> = (0..width)
            .map(|x| {
                weigh(&half, y, height, |y| {
                    moments(a[y * width + x], b[y * width + x])
                })
            })
            .collect();
        for (x, similarity) in row.iter_mut().enumerate() {
            *similarity = similarity_of(weigh(&half, x, width, |x| columns[x])) as f32;
        }
    });
    Some(map)
}

/// Luma of every pixel, 0..255.
fn luma(picture: &RgbImage) -> Vec<f64> {
    let of =
        |[r, g, b]: [u8; 3]| 0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b);
    picture.pixels().map(|pixel| of(pixel.0)).collect()
}

/// The window's weights along one axis, by distance from its pixel; the others follow by symmetry. Not normalised.
fn half_window() -> [f64; REACH + 1] {
    std::array::from_fn(|px| (-0.5 * (px as f64 / SIGMA_PX).powi(2)).exp())
}

/// Means of a, b, a², b² and ab.
type Moments = [f64; 5];

fn moments(a: f64, b: f64) -> Moments {
    [a, b, a * a, b * b, a * b]
}

/// Mean of `at` along one axis by the window around `centre`, cut to `0..len`.
fn weigh(
    half: &[f64; REACH + 1],
    centre: usize,
    len: usize,
    at: impl Fn(usize) -> Moments,
) -> Moments {
    let (mut sums, mut total) = (Moments::default(), 0.0);
    for index in centre.saturating_sub(REACH)..(centre + REACH + 1).min(len) {
        let weight = half[index.abs_diff(centre)];
        total += weight;
        for (sum, value) in sums.iter_mut().zip(at(index)) {
            *sum += weight * value;
        }
    }
    // The centre's weight is 1, so the total is no 0.
    sums.map(|sum| sum / total)
}

fn similarity_of([a, b, aa, bb, ab]: Moments) -> f64 {
    let (variance_a, variance_b, covariance) = (aa - a * a, bb - b * b, ab - a * b);
    let means = (2.0 * (a * b) + C1) / (a * a + b * b + C1);
    means * ((2.0 * covariance + C2) / (variance_a + variance_b + C2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    fn grey(size: [u32; 2], value: impl Fn(u32, u32) -> u8) -> RgbImage {
        RgbImage::from_fn(size[0], size[1], |x, y| Rgb([value(x, y); 3]))
    }

    /// A picture without pattern.
    fn noise(size: [u32; 2], seed: u32) -> RgbImage {
        RgbImage::from_fn(size[0], size[1], |x, y| {
            let hash = (x + 131 * y + seed).wrapping_mul(0x9E37_79B1);
            Rgb([(hash >> 8) as u8, (hash >> 16) as u8, (hash >> 24) as u8])
        })
    }

    #[test]
    fn equal_pictures_are_1_to_the_last_bit() {
        let picture = noise([23, 14], 1);
        let map = similarity_map(&picture, &picture).expect("one size");
        assert_eq!(map, vec![1.0; 23 * 14]);
    }

    #[test]
    fn flat_pictures_differ_by_their_means_alone_up_to_the_border() {
        let (a, b) = (grey([17, 13], |_, _| 100), grey([17, 13], |_, _| 120));
        // (2ab + C₁) / (a² + b² + C₁) with C₁ = 2.55².
        let c1 = 2.55 * 2.55;
        let expected = (2.0 * 100.0 * 120.0 + c1) / (100.0 * 100.0 + 120.0 * 120.0 + c1);
        for similarity in similarity_map(&a, &b).expect("one size") {
            let off = (f64::from(similarity) - expected).abs();
            assert!(off < 1e-6, "{similarity} {expected}");
        }
    }

    #[test]
    fn ramps_of_two_contrasts_have_the_similarity_of_their_variances() {
        // Of equal means at the middle, and the window reaches no border there.
        let a = grey([31, 31], |x, _| (8 * x) as u8);
        let b = grey([31, 31], |x, _| (4 * x + 60) as u8);
        let map = similarity_map(&a, &b).expect("one size");
        // Variance of x in the window, px².
        let weight = |px: i32| (-f64::from(px * px) / (2.0 * 1.5 * 1.5)).exp();
        let total: f64 = (-5..=5).map(weight).sum();
        let variance = (-5..=5)
            .map(|px| f64::from(px * px) * weight(px))
            .sum::<f64>()
            / total;
        let c2 = 7.65 * 7.65;
        let expected = (2.0 * 8.0 * 4.0 * variance + c2) / ((64.0 + 16.0) * variance + c2);
        let similarity = f64::from(map[15 * 31 + 15]);
        assert!(
            (similarity - expected).abs() < 1e-6,
            "{similarity} {expected}"
        );
        assert!(expected < 0.9, "{expected}: contrast must matter here");
    }

    #[test]
    fn luma_has_the_weights_of_rec_709_and_is_not_rounded() {
        let picture = RgbImage::from_pixel(1, 1, Rgb([255, 1, 3]));
        let expected = 0.2126 * 255.0 + 0.7152 + 0.0722 * 3.0;
        assert!((luma(&picture)[0] - expected).abs() < 1e-9);
    }

    #[test]
    fn similarity_is_symmetrical() {
        let (a, b) = (noise([20, 15], 1), noise([20, 15], 2));
        let map = similarity_map(&a, &b).expect("one size");
        assert_eq!(similarity_map(&b, &a).as_ref(), Some(&map));
        let mean = map.iter().sum::<f32>() / map.len() as f32;
        assert!(mean.abs() < 0.2, "{mean}: noises have nothing in common");
    }

    #[test]
    fn a_pixel_counts_as_far_as_the_window_reaches() {
        let a = noise([31, 25], 1);
        let mut b = a.clone();
        b.put_pixel(12, 4, Rgb([b.get_pixel(12, 4)[0] ^ 255; 3]));
        let map = similarity_map(&a, &b).expect("one size");
        for (index, similarity) in map.iter().enumerate() {
            let [x, y] = [index % 31, index / 31];
            let is_near = x.abs_diff(12) <= 5 && y.abs_diff(4) <= 5;
            assert_eq!(*similarity < 1.0, is_near, "{x}, {y}: {similarity}");
        }
    }

    #[test]
    fn pictures_of_different_sizes_have_none() {
        let of = |a: [u32; 2], b: [u32; 2]| {
            similarity_map(&RgbImage::new(a[0], a[1]), &RgbImage::new(b[0], b[1]))
        };
        assert_eq!(of([2, 2], [3, 2]), None);
        assert_eq!(of([0, 0], [0, 0]), Some(vec![]));
        assert_eq!(of([0, 3], [0, 3]), Some(vec![]));
    }
}
