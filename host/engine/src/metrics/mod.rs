//! How far pictures are from a reference: PSNR, SSIM and FLIP, each over the whole picture, the interior and the edge.
//!
//! Pure functions over 8-bit sRGB pictures of equal size that were composed over the same opaque background.
//! [`Regions`] says which pixels count where, from what the reference covers. Each metric has a file: [`psnr`] and
//! [`ssim`] are ours, [`flip`] is a library's. [`difference`] and [`flip`] make the maps to look at beside the
//! numbers. [`measure`] does all of it:
//!
//! ```
//! use image::{Rgb, RgbImage};
//! use pointstage_engine::metrics::{Regions, measure};
//!
//! let reference = RgbImage::from_pixel(16, 16, Rgb([200, 200, 200]));
//! let picture = RgbImage::from_pixel(16, 16, Rgb([190, 200, 200]));
//! // A reference that covers the whole picture has no outline in it: the edge has no pixels.
//! let regions = Regions::new([16, 16], &[true; 256]).expect("one bool a pixel");
//! let measured = measure(&reference, &picture, &regions)?;
//! // 10² in one of three channels.
//! let expected = 10.0 * (255.0_f64 * 255.0 / (100.0 / 3.0)).log10();
//! assert_eq!(measured.whole.psnr_db, Some(expected));
//! assert_eq!(measured.edge.psnr_db, None);
//! # Ok::<(), pointstage_engine::metrics::MetricsError>(())
//! ```

pub mod difference;
pub mod flip;
mod measures;
mod pool;
pub mod psnr;
#[cfg(test)]
mod published_tests;
mod regions;
pub mod ssim;

pub use measures::{Measured, Measures, MetricsError, measure};
pub use regions::{REACH_PX, Regions, silhouette};
