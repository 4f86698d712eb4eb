//! Where test files come from: the repository's samples, and the shared test data folder beside the checkout.

use std::path::{Path, PathBuf};

/// The repository's root folder.
pub fn repository() -> PathBuf {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR"));
    tests.parent().unwrap_or(tests).to_path_buf()
}

/// A file of `sample-data/`, which is always there.
pub fn sample(name: &str) -> PathBuf {
    repository().join("sample-data").join(name)
}

/// The file or folder `path` of the shared test data folder.
///
/// The folder is named by the environment variable `POINTSTAGE_TEST_DATA`, or is `../shared/data` beside the
/// checkout. `None`, with a line that counts as a skip, when the folder or the file is not there.
///
/// ```
/// # fn load(file: &std::path::Path) {}
/// let Some(file) = pointstage_tests::data::shared("mesh/bunny_zipper_ascii.ply") else { return };
/// load(&file);
/// ```
pub fn shared(path: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("POINTSTAGE_TEST_DATA")
        .map_or_else(|| repository().join("../shared/data"), PathBuf::from);
    let file = folder.join(path);
    if file.exists() {
        return Some(file);
    }
    skip(&format!(
        "no {path} in the shared test data folder; POINTSTAGE_TEST_DATA names it"
    ));
    None
}

/// Says why a test does not run here.
pub fn skip(why: &str) {
    // In one write, so that tests that run beside this one cannot come between.
    eprint!("{}", format_args!("skipped: {why}\n"));
}

/// Whether the slow sweeps were asked for (`cargo xtask test --long`).
pub fn long() -> bool {
    std::env::var_os("POINTSTAGE_LONG").is_some_and(|value| value == "1")
}
