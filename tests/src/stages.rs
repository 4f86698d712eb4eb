//! The engine without the program around it: stages over the first-party plugins, and scenes for them.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context as _, Result};
use pointstage_engine::plugins::DiscoverOptions;
use pointstage_engine::stage::{FrameRequest, Patience, Role, Stage, StageOptions};
use pointstage_plugin_api::abi::{Interaction, Purpose};
use pointstage_scene::{Camera, Job, LoadOptions, Scene, load};

use crate::program::plugin_library;
use crate::scenes::{self, Surfel};

/// A stage with the first-party plugins of these names, and no other.
///
/// # Errors
/// When they were not built, or the stage does not open.
pub fn stage(plugins: &[&str]) -> Result<Stage> {
    let files = plugins.iter().map(|name| plugin_library(name));
    of_libraries(files.collect::<Result<_>>()?, true)
}

/// A stage with these plugins' libraries, and no other; with a graphics device if it may use one.
///
/// # Errors
/// When the stage does not open.
pub fn of_libraries(files: Vec<PathBuf>, use_device: bool) -> Result<Stage> {
    let plugins = DiscoverOptions {
        files,
        ..DiscoverOptions::default()
    };
    let options = StageOptions {
        use_device,
        plugins,
        ..StageOptions::default()
    };
    Stage::new(options).context("opening a stage")
}

/// A scene with one object of these surfels, through a file in `folder`.
///
/// # Errors
/// When the file cannot be written or read.
pub fn scene(folder: &Path, name: &str, surfels: &[Surfel]) -> Result<Arc<Scene>> {
    scene_of_file(&scenes::write(folder, name, surfels)?)
}

/// A scene with one object, read from a file by the built-in loaders.
///
/// # Errors
/// When the file cannot be read.
pub fn scene_of_file(path: &Path) -> Result<Arc<Scene>> {
    let loaded = load(path, &LoadOptions::default(), &Job::new())
        .with_context(|| format!("loading {}", path.display()))?;
    let mut scene = Scene::new();
    scene.add(loaded.object);
    Ok(Arc::new(scene))
}

/// A frame as a window's main view asks for it, but waited for.
pub fn window_frame(scene: &Arc<Scene>, size_px: [u32; 2], renderer: &str) -> FrameRequest {
    let mut camera = Camera::default();
    let aspect = f64::from(size_px[0]) / f64::from(size_px[1]);
    camera.frame(&scene.bounds_world(), aspect);
    FrameRequest {
        role: Role::Main,
        interaction: Interaction::STILL,
        purpose: Purpose::INTERACTIVE,
        patience: Patience::Wait,
        ..FrameRequest::still(Arc::clone(scene), camera, size_px, renderer)
    }
}
