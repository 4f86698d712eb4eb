//! Files into a scene, for commands.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use pointstage_engine::stage::Stage;
use pointstage_scene::{
    Estimation, Job, LoadOptions, Loaded, LoaderChoice, Loaders, ObjectId, Scene, Warnings,
    Winding, load_with,
};

use super::drawing::set_values;
use super::{Failure, Outcome, values};
use crate::file_loaders::loaders;
use crate::session_file::SceneFile;

/// Options of commands that load files to draw or to measure them.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct LoadArguments {
    /// Estimate normals and radii where the file has none [default: below 2 million surfels]
    #[arg(long, value_enum, value_name = "WHEN", help_heading = "Loading")]
    estimate: Option<WhenToEstimate>,
    #[command(flatten)]
    reading: ReadArguments,
}

/// Options of all commands that read files: what is done to their contents, and by whom they are read.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ReadArguments {
    /// Turn meshes inside out, and normals around: for files whose faces are wound inward
    #[arg(long, help_heading = "Loading")]
    flip: bool,
    /// Read the files with this loader, whatever they look like [default: by content, then by extension]
    #[arg(long, value_name = "ID", help_heading = "Loading")]
    loader: Option<String>,
    /// An option of that loader; may be given several times
    #[arg(long = "set-loader", value_name = "ID=VALUE", value_parser = values::assignment, requires = "loader", help_heading = "Loading")]
    loader_settings: Vec<(String, String)>,
}

/// The loaders of the program and of a stage's plugins.
pub(crate) fn loaders_of(stage: &Stage) -> Loaders {
    let registry = stage.registry();
    loaders(move || Some(Arc::clone(&registry)))
}

/// The loader of this name, with options of its own.
fn loader_choice(
    key: &str,
    settings: &[(String, String)],
    loaders: &Loaders,
) -> Outcome<LoaderChoice> {
    let mut choice = LoaderChoice {
        loader: key.to_owned(),
        ..LoaderChoice::default()
    };
    if !settings.is_empty() {
        let info = loaders.named(key).map_err(Failure::usage_from)?;
        set_values(&mut choice.settings, &info.settings, settings).map_err(Failure::usage_from)?;
    }
    Ok(choice)
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

impl ReadArguments {
    /// Sets what the command line says; the rest of the options stay.
    pub(super) fn apply(&self, options: &mut LoadOptions, loaders: &Loaders) -> Outcome {
        if self.flip {
            options.winding = Winding::Flipped;
        }
        if let Some(key) = &self.loader {
            options.loader = Some(loader_choice(key, &self.loader_settings, loaders)?);
        }
        Ok(())
    }
}

impl LoadArguments {
    /// How to load an entry: as it says, unless the command line says otherwise.
    fn options(&self, entry: &SceneFile, loaders: &Loaders) -> Outcome<LoadOptions> {
        let mut options = entry.load_options();
        match self.estimate {
            None => {}
            Some(WhenToEstimate::Auto) => options.estimation = Estimation::Automatic,
            Some(WhenToEstimate::Always) => options.estimation = Estimation::Always,
            Some(WhenToEstimate::Never) => options.estimation = Estimation::Never,
        }
        self.reading.apply(&mut options, loaders)?;
        Ok(options)
    }

    /// Loads one file and says its warnings on standard error.
    pub(crate) fn load(&self, path: &Path, loaders: &Loaders) -> Outcome<Loaded> {
        self.load_entry(&SceneFile::new(path.to_path_buf()), loaders)
    }

    /// Loads an object of a scene and says its warnings on standard error.
    fn load_entry(&self, entry: &SceneFile, loaders: &Loaders) -> Outcome<Loaded> {
        let options = self.options(entry, loaders)?;
        let mut loaded = load_with(loaders, &entry.file, &options, &Job::new())?;
        for warning in loaded.warnings.iter() {
            eprintln!("warning: {}: {warning}", entry.file.display());
        }
        entry.dress(&mut loaded.object);
        tracing::info!(
            "scene loaded: {}, {} surfels",
            loaded.object.name,
            loaded.object.geometry.surfel_count
        );
        Ok(loaded)
    }

    /// Loads files into one scene, each as an object, with what loading each gave to say.
    pub(crate) fn load_scene(
        &self,
        entries: &[SceneFile],
        loaders: &Loaders,
    ) -> Outcome<(Scene, BTreeMap<ObjectId, Warnings>)> {
        if entries.is_empty() {
            return Err(Failure::Failed(anyhow::anyhow!(
                "the session's scene is empty; name FILEs to draw with its view and settings"
            )));
        }
        let (mut scene, mut warnings) = (Scene::new(), BTreeMap::new());
        for entry in entries {
            let loaded = self.load_entry(entry, loaders)?;
            warnings.insert(scene.add(loaded.object), loaded.warnings);
        }
        if scene.surfel_count() == 0 {
            return Err(Failure::Failed(anyhow::anyhow!(
                "the scene has no surfels to draw; see 'pointstage info' for what is in the files"
            )));
        }
        Ok((scene, warnings))
    }
}
