//! Files through loaders that are plugins, without the program around them.

use std::path::Path;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, ensure};
use pointstage_engine::plugins::{self, DiscoverOptions, Registry};
use pointstage_scene::{Estimation, Job, LoadError, LoadOptions, Loaded, Loaders, load_with};

use crate::program::plugin_library;

/// Names of the first-party libraries of loaders.
pub const LIBRARIES: [&str; 2] = ["mesh_formats", "point_formats"];

/// The loaders that come with the program, and those of these libraries.
///
/// # Errors
/// When a library cannot be used.
pub fn with_libraries(files: &[impl AsRef<Path>]) -> Result<Loaders> {
    let registry = Arc::new(Registry::discover(&DiscoverOptions {
        files: files.iter().map(|file| file.as_ref().to_owned()).collect(),
        ..DiscoverOptions::default()
    }));
    for file in registry.files() {
        ensure!(file.verdict.is_usable(), "{}", file.verdict.message);
    }
    let loaders = plugins::loaders(&registry);
    Ok(Loaders::built_in().with_others(move || loaders.clone()))
}

/// The loaders that come with the program and all first-party ones.
///
/// # Errors
/// When a library was not built, or cannot be used.
pub fn first_party() -> Result<Loaders> {
    let files = LIBRARIES.iter().map(|name| plugin_library(name));
    with_libraries(&files.collect::<Result<Vec<_>>>()?)
}

/// Loads a file without estimating anything.
///
/// # Errors
/// As loading does.
pub fn load_as_it_is(loaders: &Loaders, path: &Path) -> Result<Loaded, LoadError> {
    let options = LoadOptions {
        estimation: Estimation::FileOnly,
        ..LoadOptions::default()
    };
    load_with(loaders, path, &options, &Job::new())
}

/// Writes `content` as `name` in `folder` and loads it without estimating anything.
///
/// # Errors
/// When it cannot be written, or loading fails.
pub fn load_bytes(loaders: &Loaders, folder: &Path, name: &str, content: &[u8]) -> Result<Loaded> {
    let path = folder.join(name);
    std::fs::write(&path, content).with_context(|| format!("writing {}", path.display()))?;
    Ok(load_as_it_is(loaders, &path)?)
}

/// Cancels a load, and checks that its thread says so soon.
///
/// # Panics
/// When it does not.
pub fn assert_cancelled_soon(job: &Job, worker: JoinHandle<Result<Loaded, LoadError>>) {
    job.cancel();
    let cancelled = Instant::now();
    let result = worker.join().expect("no panic");
    assert!(matches!(result, Err(LoadError::Cancelled(_))), "{result:?}");
    // 200 ms are promised; this machine may be busy.
    assert!(
        cancelled.elapsed() < Duration::from_secs(2),
        "{:?}",
        cancelled.elapsed()
    );
}
