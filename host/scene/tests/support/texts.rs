//! Made-up files of text, loaded without estimation.

use glam::DVec3;
use pointstage_scene::{Estimation, FaceRadius, LoadOptions, Loaded, Winding};

use crate::support::load_bytes;

/// Nothing but what the file has.
pub(crate) const FILE_ONLY: LoadOptions = LoadOptions {
    loader: None,
    estimation: Estimation::FileOnly,
    face_radius: FaceRadius::EnclosingCircle,
    winding: Winding::AsInFile,
};

/// Coordinates of a vertex.
pub(crate) const XYZ: &str = "property float x\nproperty float y\nproperty float z";

/// Loads a text body under a header of `elements`, without estimation.
pub(crate) fn text(elements: &str, body: &str) -> Result<Loaded, String> {
    let file = format!("ply\nformat ascii 1.0\n{elements}\nend_header\n{body}");
    load_bytes(file.as_bytes(), &FILE_ONLY).map_err(|error| error.to_string())
}

/// Centre of a surfel, world space.
pub(crate) fn world(loaded: &Loaded, surfel: usize) -> DVec3 {
    loaded.object.origin
        + loaded
            .object
            .geometry
            .centre(surfel)
            .expect("the surfel exists")
}
