//! Files made up by tests.

use std::io::Write as _;

use pointstage_scene::{Job, LoadError, LoadOptions, Loaded, load};

/// Loads bytes as a file.
pub(crate) fn load_bytes(bytes: &[u8], options: &LoadOptions) -> Result<Loaded, LoadError> {
    let mut file = tempfile::Builder::new()
        .prefix("made-up")
        .suffix(".ply")
        .tempfile()
        .expect("a temporary file");
    file.write_all(bytes)
        .expect("the temporary file takes the bytes");
    load(file.path(), options, &Job::new())
}
