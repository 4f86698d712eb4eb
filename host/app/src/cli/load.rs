//! Files into a scene, for commands.

use std::path::{Path, PathBuf};

use pointstage_scene::{Estimation, Job, LoadOptions, Loaded, Scene, Winding, load};

use super::{Failure, Outcome};

/// Options of commands that load files.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct LoadArguments {
    /// Estimate normals and radii where the file has none [default: below 2 million surfels]
    #[arg(
        long,
        value_enum,
        default_value = "auto",
        value_name = "WHEN",
        help_heading = "Loading"
    )]
    estimate: WhenToEstimate,
    /// Turn meshes inside out: for files whose faces are wound inward
    #[arg(long, help_heading = "Loading")]
    flip: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum WhenToEstimate {
    /// Below 2 million surfels
    Auto,
    /// However long it takes
    Always,
    /// Show positions as they are
    Never,
}

impl LoadArguments {
    fn options(&self) -> LoadOptions {
        LoadOptions {
            estimation: match self.estimate {
                WhenToEstimate::Auto => Estimation::Automatic,
                WhenToEstimate::Always => Estimation::Always,
                WhenToEstimate::Never => Estimation::Never,
            },
            winding: if self.flip {
                Winding::Flipped
            } else {
                Winding::AsInFile
            },
            ..LoadOptions::default()
        }
    }

    /// What was asked for, for an image's record.
    pub(crate) fn record(&self) -> serde_json::Value {
        let estimate = match self.estimate {
            WhenToEstimate::Auto => "auto",
            WhenToEstimate::Always => "always",
            WhenToEstimate::Never => "never",
        };
        serde_json::json!({ "estimate": estimate, "flip": self.flip })
    }

    /// Loads one file and says its warnings on standard error.
    pub(crate) fn load(&self, path: &Path) -> Outcome<Loaded> {
        let loaded = load(path, &self.options(), &Job::new())?;
        for warning in loaded.warnings.iter() {
            eprintln!("warning: {}: {warning}", path.display());
        }
        tracing::info!(
            "scene loaded: {}, {} surfels",
            loaded.object.name,
            loaded.object.geometry.surfel_count
        );
        Ok(loaded)
    }

    /// Loads files into one scene, each as an object.
    pub(crate) fn load_scene(&self, paths: &[PathBuf]) -> Outcome<Scene> {
        let mut scene = Scene::new();
        for path in paths {
            scene.add(self.load(path)?.object);
        }
        if scene.surfel_count() == 0 {
            return Err(Failure::Failed(anyhow::anyhow!(
                "the scene has no surfels to draw; see 'pointstage info' for what is in the files"
            )));
        }
        Ok(scene)
    }
}
