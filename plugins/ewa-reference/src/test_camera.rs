//! A camera for unit tests.

use pointstage_plugin_api::glam::{DMat4, DVec2};
use pointstage_plugin_api::twin::camera::Camera;

/// A square picture of 100 samples a side, near plane at 0.1, reversed z.
pub(crate) fn perspective() -> Camera {
    let focal = 1.5;
    let near = 0.1;
    Camera {
        clip_from_view: DMat4::from_cols_array_2d(&[
            [focal, 0.0, 0.0, 0.0],
            [0.0, focal, 0.0, 0.0],
            [0.0, 0.0, 0.0, -1.0],
            [0.0, 0.0, near, 0.0],
        ]),
        tile_size_px: DVec2::splat(100.0),
        pixels_per_unit: 50.0 * focal,
        is_orthographic: false,
    }
}
