//! Splats drawn by the CPU: several times as fast as a software device, which does the same on the same cores.
//!
//! A selection's surfels are sorted by the *bands* of rows that they can reach ([`Bins`]). Then threads take a band each: they
//! compute the images of its surfels, four at once ([`Surfels::load`], [`Camera4::project_ellipses`]), and draw them into that
//! band's pixels ([`Nearest`]) and, if the renderer blends, sums ([`Sums`]), which lie in the core's own cache meanwhile. No two
//! threads write to one pixel, so nothing is to be joined, and every band has its order: the picture does not depend on the
//! number of threads.
//!
//! [`Nearest`] has the layout of the compute path's pixels; the device goes on with shading. [`Nearest`], [`Sums`] and
//! [`share_out`] know nothing of surfels and serve splats of any other kind.

mod bins;
mod clip;
mod ellipse;
mod hidden;
mod image;
mod lanes;
mod nearest;
mod splats;
mod sums;
mod surfels;
mod workers;

pub use bins::{Bins, Candidate, Reach};
pub use clip::{clip_distance, clip_keeps};
pub use ellipse::{Axes4, Camera4, Clip4, Ellipses4};
pub use image::{Image, Rectangle, RowPlane};
pub use lanes::{LANES, Vec3x4, exp_near_zero, sqrt};
pub use nearest::{BAND_ROWS, Nearest, NearestBand, depth_of, id_of, packed};
pub use splats::Splats;
pub use sums::{FULL, Sum, Sums};
pub use surfels::{Stage, Surfels, Surfels4};
pub use workers::share_out;

#[cfg(test)]
mod tests {
    use super::{clip, ellipse};
    use crate::shader_checks::assert_constants;
    use pointstage_plugin_api::wgsl::LIBRARY;

    #[test]
    fn constants_are_those_of_the_shaders() {
        let module = |path: &str| {
            let mut modules = LIBRARY.iter();
            modules.find(|module| module.path == path).unwrap().source
        };
        let of_ellipses = [
            ("BOUNDS_MARGIN_PX", ellipse::BOUNDS_MARGIN_PX),
            ("CUT_MARGIN_PX", ellipse::CUT_MARGIN_PX),
            ("EDGE_ON", ellipse::EDGE_ON),
        ];
        assert_constants(
            module("lib::ellipse"),
            &of_ellipses.map(|(name, value)| (name, f64::from(value))),
        );
        let far = f64::from(clip::FAR_PX);
        assert_constants(module("lib::clip"), &[("FAR_PX", far)]);
    }
}
