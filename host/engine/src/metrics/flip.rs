//! FLIP: how much two pictures seem to differ when one is shown in the other's place, by NVIDIA's own code.
//!
//! The crate `nv-flip` wraps the C++ of Andersson et al. (FLIP 2020), in its form for pictures of low dynamic range. Errors
//! are 0 (no difference to be seen) … 1, for an observer who sees [`PIXELS_PER_DEGREE`] pixels a degree. Without the cargo
//! feature `flip` there are no errors and no maps: building it takes a C++17 compiler.

use image::RgbImage;

/// The library's default: a 4K screen 0.7 m wide, seen from 0.7 m.
pub const PIXELS_PER_DEGREE: f32 = 67.0;

/// Eighths of *magma*, from 0 to 1, 8-bit sRGB: for legends.
pub const MAGMA: [[u8; 3]; 9] = [
    [0x00, 0x00, 0x04],
    [0x1c, 0x10, 0x44],
    [0x4f, 0x12, 0x7b],
    [0x81, 0x25, 0x81],
    [0xb5, 0x36, 0x7a],
    [0xe5, 0x50, 0x64],
    [0xfb, 0x87, 0x61],
    [0xfe, 0xc2, 0x87],
    [0xfc, 0xfd, 0xbf],
];

/// Errors of a picture, and how they are shown.
#[derive(Clone, Debug, PartialEq)]
pub struct FlipErrors {
    /// One a pixel, 0..1, rows from the top.
    pub errors: Vec<f32>,
    /// The errors in colours: *magma*, from black at 0 to pale yellow at 1, as the paper's figures show them.
    pub map: RgbImage,
}

/// FLIP of `picture` against `reference`.
///
/// None if the program was built without FLIP, or if the pictures are of different sizes or have no pixels.
#[cfg(feature = "flip")]
pub fn flip(reference: &RgbImage, picture: &RgbImage) -> Option<FlipErrors> {
    let (width, height) = reference.dimensions();
    // The library counts bytes in 32 bits.
    let fits = width.checked_mul(height)?.checked_mul(3).is_some();
    if (width, height) != picture.dimensions() || width == 0 || height == 0 || !fits {
        return None;
    }
    let own = |picture: &RgbImage| nv_flip::FlipImageRgb8::with_data(width, height, picture);
    let errors = nv_flip::flip(own(reference), own(picture), PIXELS_PER_DEGREE);
    let colours = errors.apply_color_lut(&nv_flip::magma_lut());
    Some(FlipErrors {
        errors: errors.to_vec(),
        map: RgbImage::from_raw(width, height, colours.to_vec())?,
    })
}

/// FLIP of `picture` against `reference`: none, the program was built without it.
#[cfg(not(feature = "flip"))]
pub fn flip(_reference: &RgbImage, _picture: &RgbImage) -> Option<FlipErrors> {
    None
}

#[cfg(all(test, feature = "flip"))]
mod tests {
    use super::*;
    use image::Rgb;

    fn grey(value: u8) -> RgbImage {
        RgbImage::from_pixel(24, 16, Rgb([value; 3]))
    }

    #[test]
    fn the_observer_is_the_librarys_own() {
        assert_eq!(PIXELS_PER_DEGREE, nv_flip::DEFAULT_PIXELS_PER_DEGREE);
    }

    #[test]
    fn equal_pictures_have_no_error_and_a_black_map() {
        let flip = flip(&grey(90), &grey(90)).expect("equal sizes");
        assert!(flip.errors.iter().all(|error| *error == 0.0));
        let Rgb(darkest) = *flip.map.get_pixel(3, 3);
        assert!(darkest.iter().all(|channel| *channel < 8), "{darkest:?}");
    }

    #[test]
    fn black_in_place_of_white_is_the_greatest_error() {
        let flip = flip(&grey(255), &grey(0)).expect("equal sizes");
        let least = flip.errors.iter().copied().fold(f32::INFINITY, f32::min);
        let most = flip.errors.iter().copied().fold(0.0, f32::max);
        assert!(least > 0.95 && most <= 1.0, "errors from {least} to {most}");
    }

    #[test]
    fn a_small_step_is_a_small_error() {
        let flip = flip(&grey(128), &grey(132)).expect("equal sizes");
        let most = flip.errors.iter().copied().fold(0.0, f32::max);
        assert!(most > 0.0 && most < 0.2, "{most}");
    }

    #[test]
    fn pictures_of_different_sizes_have_none() {
        assert_eq!(flip(&grey(0), &RgbImage::new(3, 3)), None);
        assert_eq!(flip(&RgbImage::new(0, 0), &RgbImage::new(0, 0)), None);
    }
}
