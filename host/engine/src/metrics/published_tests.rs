//! Our numbers against those of the implementations that others publish with.
//!
//! The pictures are made by a formula, here and once in Python; the expected numbers came out of scikit-image 0.26.0
//! (`peak_signal_noise_ratio` and `structural_similarity` with Gaussian weights, σ 1.5, no sample covariance, on luma by the
//! weights of Rec. 709) and of NVIDIA's `flip-evaluator` 1.7 (`evaluate`, LDR, 67 pixels a degree).

use image::{Rgb, RgbImage};

use super::{Regions, measure, ssim::similarity_map};

const SIZE_PX: [u32; 2] = [96, 64];

/// How near ours have to be.
const NEAR: f64 = 1e-3;

/// Smooth ramps that wrap around, and the same with noise and a grey block.
fn pictures() -> [RgbImage; 2] {
    let [width, height] = SIZE_PX;
    let reference = RgbImage::from_fn(width, height, |x, y| {
        Rgb([2 * x + y, 3 * y + x / 2, (x * x + y * y) / 48].map(|value| (value % 256) as u8))
    });
    let picture = RgbImage::from_fn(width, height, |x, y| {
        if (30..50).contains(&x) && (20..40).contains(&y) {
            return Rgb([128; 3]);
        }
        let noise = ((7 * x + 13 * y) % 32) as i32 - 16;
        let Rgb(colour) = *reference.get_pixel(x, y);
        Rgb(colour.map(|channel| (i32::from(channel) + noise).clamp(0, 255) as u8))
    });
    [reference, picture]
}

fn assert_near(what: &str, ours: Option<f64>, published: f64) {
    let ours = ours.expect("there are pixels");
    assert!(
        (ours - published).abs() < NEAR,
        "{what}: ours is {ours}, published code says {published}"
    );
}

#[test]
fn psnr_is_scikit_images() {
    let [reference, picture] = pictures();
    let regions = Regions::new(SIZE_PX, &[true; 96 * 64]).expect("one a pixel");
    let measured = measure(&reference, &picture, &regions).expect("one size");
    assert_near("PSNR", measured.whole.psnr_db, 24.407_233_174_871_3);
}

#[test]
fn ssim_is_scikit_images_where_windows_are_whole() {
    let [reference, picture] = pictures();
    let map = similarity_map(&reference, &picture).expect("one size");
    let [width, height] = SIZE_PX.map(|side| side as usize);
    // scikit-image leaves out what its windows reach beyond: 5 pixels along the border.
    let rows = map.chunks_exact(width).skip(5).take(height - 10);
    let inner = rows.flat_map(|row| &row[5..width - 5]);
    let values: Vec<f64> = inner.map(|value| f64::from(*value)).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    assert_near("SSIM", Some(mean), 0.517_576_252_164_905);
}

#[test]
#[cfg(feature = "flip")]
fn flip_is_nvidias() {
    let [reference, picture] = pictures();
    let regions = Regions::new(SIZE_PX, &[true; 96 * 64]).expect("one a pixel");
    let measured = measure(&reference, &picture, &regions).expect("one size");
    assert_near("FLIP, mean", measured.whole.flip_mean, 0.092_895_053_327);
    assert_near(
        "FLIP, 99th percentile",
        measured.whole.flip_p99,
        0.622_572_66,
    );
}
