//! `pointstage render`: files to pictures, without a window.
//!
//! What can be wrong with the command line is checked before a file is read ([`choice`]). Then the scene is loaded once,
//! each view is drawn, and its files are written whole ([`files`]).

mod choice;
mod files;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
use pointstage_engine::stage::{Background, Stage};
use pointstage_plugin_api::nearest::{did_you_mean, nearest_names};
use pointstage_scene::{Scene, ViewRecord, ViewRecordError, ViewSource, ViewSourceError};

use super::load::LoadArguments;
use super::values::{self, AovFile};
use super::{Failure, Globals, Outcome, named_plugins, write_out};
use crate::output::whole_file;
use choice::{Choice, check_targets};
use files::Place;

/// Size of a picture when neither `--size` nor the view says one, px.
const DEFAULT_SIZE: [u32; 2] = [1280, 720];

/// Arguments of `render`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  pointstage render scan.ply --renderer surfel --out scan.png
  pointstage render scan.ply --renderer points --set size_mode=fixed --set size=3 --out scan.png
  pointstage render scan.ply --out scan.png --aov depth=depth.exr --aov normal=normal.png
  pointstage render a.ply b.ply --view orbit:8 --size 800x600 --out turn.png
  pointstage render scan.ply --view view.json --stats stats.json --out scan.png
  pointstage render scan.ply --size 20000x20000 --out poster.png
  pointstage render scan.ply --out scan.exr

Several views (orbit:N) number their files: turn_000.png, turn_001.png, …
EXR files hold the target's values: depth as the distance along the line of sight in scene units (infinite where
nothing is), normals in view space, ids as whole numbers. PNG files show them as the window's legend does.
--out FILE.exr writes all targets that the renderer gives, as layers of one file.
Images beyond the device's limit are drawn in tiles and look the same.
Images carry the renderer, settings and view that made them, as JSON: PNG in the text chunk 'Pointstage', EXR in the
attribute of that name.")]
pub(crate) struct RenderArguments {
    /// PLY files; each becomes an object
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// Renderer: an id, a short name, id@version or id#hash [default: the first that can draw]
    #[arg(long, value_name = "ID")]
    renderer: Option<String>,
    /// Structure that selects levels of detail
    #[arg(long, value_name = "ID")]
    structure: Option<String>,
    /// Image to write: the picture (.png), or all targets (.exr)
    #[arg(long, value_name = "FILE", value_parser = values::image_path)]
    out: PathBuf,
    /// Size of the image in pixels, each side up to 65536 [default: the view's, else 1280x720]
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    size: Option<[u32; 2]>,
    /// Where to look from: a view FILE, or orbit:N for N views around the scene
    #[arg(long, value_name = "FILE|orbit:N", default_value = "orbit:1")]
    view: String,
    /// A setting of the renderer; may be given several times
    #[arg(long = "set", value_name = "ID=VALUE", value_parser = values::assignment)]
    settings: Vec<(String, String)>,
    /// A setting of the structure; may be given several times
    #[arg(long = "set-structure", value_name = "ID=VALUE", value_parser = values::assignment, requires = "structure")]
    structure_settings: Vec<(String, String)>,
    /// Another target to write, as values (.exr) or colours (.png); may be given several times
    #[arg(long = "aov", value_name = "KEY=FILE", value_parser = values::aov)]
    aovs: Vec<AovFile>,
    /// What the picture shows: 'colours' or the key of a target
    #[arg(long, value_name = "KEY", default_value = "colours")]
    show: String,
    /// What lies behind: 'transparent', '#rrggbb', or '#rrggbb,#rrggbb' from top to bottom
    #[arg(long, value_name = "COLOUR", value_parser = values::background, default_value = "#4d545e,#171a1f")]
    background: Background,
    /// Factor on the colours
    #[arg(long, value_name = "FACTOR", value_parser = values::factor, default_value = "1")]
    exposure: f32,
    /// Factor on every surfel's radius
    #[arg(long, value_name = "FACTOR", value_parser = values::factor, default_value = "1")]
    radius_scale: f32,
    /// Write times and counts of every view as JSON
    #[arg(long, value_name = "FILE.json")]
    stats: Option<PathBuf>,
    /// Say as JSON on standard output what was written
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    load: LoadArguments,
}

/// Draws and writes every view.
pub(crate) fn run(globals: &Globals, arguments: &RenderArguments) -> Outcome {
    arguments.check_files()?;
    let view_source = ViewSource::parse(&arguments.view, []).map_err(Failure::usage_from)?;
    let mut stage = Stage::new(globals.stage_options())?;
    named_plugins::warn_of_unusable(&stage.registry(), globals);
    let choice = Choice::new(&stage, arguments)?;
    let scene = Arc::new(arguments.load.load_scene(&arguments.files)?);
    let renderer = choice.renderer_for(&stage, &scene);
    if let Ok(info) = stage.registry().find_renderer(&renderer) {
        check_targets(&info, arguments)?;
    }
    let views = arguments.views(&view_source, &scene)?;
    let mut written = Vec::new();
    for (index, view) in views.iter().enumerate() {
        let request = choice.request(&scene, view, renderer.clone(), arguments);
        let place = Place {
            arguments,
            index,
            count: views.len(),
        };
        written.push(place.draw_and_write(&mut stage, view, &request)?);
    }
    if let Some(path) = &arguments.stats {
        let text = serde_json::to_string_pretty(&written)?;
        whole_file::write(path, text.as_bytes())?;
    }
    if arguments.json {
        write_out(&serde_json::to_string_pretty(&written)?)?;
    }
    Ok(())
}

impl RenderArguments {
    /// Refuses to write two things to one file.
    fn check_files(&self) -> Outcome {
        let aovs = self.aovs.iter().map(|aov| &aov.path);
        let all: Vec<&PathBuf> = [&self.out]
            .into_iter()
            .chain(aovs)
            .chain(&self.stats)
            .collect();
        for (index, path) in all.iter().enumerate() {
            if all[..index].contains(path) {
                return Err(Failure::usage(format!(
                    "'{}' is named twice; each picture, target and statistics needs a file of its own",
                    path.display()
                )));
            }
        }
        Ok(())
    }

    /// The views, in the size that was asked for.
    fn views(&self, source: &ViewSource, scene: &Scene) -> Outcome<Vec<ViewRecord>> {
        let size_px = self.size.unwrap_or(DEFAULT_SIZE);
        let mut views = source
            .resolve(&scene.bounds_world(), size_px, &[])
            .map_err(view_failure)?;
        if let Some([width, height]) = self.size {
            for view in &mut views {
                (view.width, view.height) = (width, height);
            }
        }
        Ok(views)
    }
}

/// A view that cannot be had: a file that cannot be read is no wrong use.
fn view_failure(error: ViewSourceError) -> Failure {
    match error {
        ViewSourceError::Record { path, source } => {
            let near = match source {
                ViewRecordError::Io { .. } => did_you_mean(&neighbours_like(&path)),
                _ => String::new(),
            };
            let error = ViewSourceError::Record { path, source };
            Failure::Failed(anyhow::anyhow!("{error}{near}"))
        }
        other => Failure::usage_from(other),
    }
}

/// View files beside `path` whose names resemble its name.
fn neighbours_like(path: &Path) -> Vec<String> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let name_of = |path: &Path| Some(path.file_name()?.to_string_lossy().into_owned());
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    let names = entries.filter_map(|entry| {
        let path = entry.ok()?.path();
        let is_view = path
            .extension()
            .is_some_and(|extension| extension == "json");
        is_view.then(|| name_of(&path)).flatten()
    });
    name_of(path).map_or_else(Vec::new, |name| nearest_names(&name, names))
}
