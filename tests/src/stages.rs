//! The engine without the program around it: stages over the first-party plugins, and scenes for them.

use std::path::Path;
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
    let plugins = DiscoverOptions {
        files: files.collect::<Result<_>>()?,
        ..DiscoverOptions::default()
    };
    let options = StageOptions {
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
    let path = scenes::write(folder, name, surfels)?;
    let loaded = load(&path, &LoadOptions::default(), &Job::new())
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
