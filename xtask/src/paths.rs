//! Where things are in the repository.

use std::path::PathBuf;

use crate::process;

/// The repository's root folder.
pub(crate) fn root() -> PathBuf {
    // Cargo gives the package's folder to what it runs; the one of build time serves a binary started by hand.
    let package = std::env::var_os("CARGO_MANIFEST_DIR")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")), PathBuf::from);
    package
        .parent()
        .map_or_else(|| PathBuf::from("."), PathBuf::from)
}

/// Cargo's output folder.
pub(crate) fn target() -> PathBuf {
    match std::env::var_os("CARGO_TARGET_DIR") {
        Some(folder) => root().join(folder),
        None => root().join("target"),
    }
}

/// The model that `cargo xtask run` shows.
pub(crate) fn sample() -> PathBuf {
    root().join("sample-data").join("bust_200k.ply")
}

/// The file `path` of the shared test data folder, if it is there: the folder that the environment variable
/// `POINTSTAGE_TEST_DATA` names, or `../shared/data` beside the checkout, as for the tests.
pub(crate) fn shared_data(path: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("POINTSTAGE_TEST_DATA")
        .map_or_else(|| root().join("../shared/data"), PathBuf::from);
    let file = std::path::absolute(folder.join(path)).ok()?;
    file.is_file().then_some(file)
}

/// The same; says so where it is not.
pub(crate) fn shared_data_or_say(path: &str) -> Option<PathBuf> {
    let file = shared_data(path);
    if file.is_none() {
        process::say(&no_shared_data(path));
    }
    file
}

/// What to say where it is not.
pub(crate) fn no_shared_data(path: &str) -> String {
    format!("skipped: no {path} in the shared test data folder; POINTSTAGE_TEST_DATA names it")
}

/// `path` as a person would type it: relative to the current folder where it lies below it.
pub(crate) fn shown(path: &std::path::Path) -> String {
    let relative = std::env::current_dir()
        .ok()
        .and_then(|here| path.strip_prefix(here).ok().map(PathBuf::from));
    relative
        .unwrap_or_else(|| path.to_path_buf())
        .display()
        .to_string()
}
