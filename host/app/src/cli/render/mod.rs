//! `pointstage render`: files to pictures, without a window.
//!
//! A session file and the options that override it make a [`plan`]. What can be wrong with it is checked before a scene file
//! is read ([`choice`]). Then the scene is loaded once, each view is drawn, and its files are written whole ([`files`]).
//! With `--path` the views are the pictures of a [`film`].

mod choice;
mod files;
mod film;
mod plan;

use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use pointstage_engine::stage::{Background, Stage};

use super::load::{LoadArguments, loaders_of};
use super::values::{self, AovFile};
use super::{Failure, Globals, Outcome, named_plugins, write_out};
use crate::camera_path::{PathSource, ValuesAt};
use crate::output::whole_file;
use choice::{Choice, check_targets};
use files::Place;
use plan::Plan;

/// Arguments of `render`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  pointstage render scan.ply --renderer surfel --out scan.png
  pointstage render scan.ply --renderer points --set size_mode=fixed --set size=3 --out scan.png
  pointstage render scan.ply --out scan.png --aov depth=depth.exr --aov normal=normal.png
  pointstage render a.ply b.ply --view orbit:8 --size 800x600 --out turn.png
  pointstage render scan.ply --path turntable:4 --fps 30 --out frames/turn_%04d.png
  pointstage render --session work.pointstage.toml --path session --out frames/work.png
  pointstage render scan.ply --view view.json --stats stats.json --out scan.png
  pointstage render --session work.pointstage.toml --out work.png
  pointstage render --session work.pointstage.toml --view front --renderer surfel --out front.png
  pointstage render scan.ply --size 20000x20000 --out poster.png
  pointstage render scan.ply --out scan.exr

Several views (orbit:N) number their files: turn_000.png, turn_001.png, …
--path FILE takes a camera path (.toml), a session that has one, or views as JSON: one picture every 1/fps seconds, numbered where
--out says %04d, else as views are. The folder of the pictures is made. Tracks of the path set renderer settings per picture.
EXR files hold the target's values: depth as the distance along the line of sight in scene units (infinite where
nothing is), normals in view space, ids as whole numbers. PNG files show them as the window's legend does.
--out FILE.exr writes all targets that the renderer gives, as layers of one file.
Images beyond the device's limit are drawn in tiles and look the same.
Images carry the renderer, settings and view that made them, as JSON: PNG in the text chunk 'Pointstage', EXR in the
attribute of that name. --session takes such a PNG too, and draws it again.")]
pub(crate) struct RenderArguments {
    /// Files of points or meshes; each becomes an object [default: the session's]
    #[arg(value_name = "FILE", required_unless_present = "session")]
    files: Vec<PathBuf>,
    /// Session that the window saved, or a picture of Pointstage; the other options override what it says
    #[arg(long, value_name = "FILE.pointstage.toml")]
    session: Option<PathBuf>,
    /// Renderer: an id, a short name, id@version or id#hash [default: the session's, else the first that can draw]
    #[arg(long, value_name = "ID")]
    renderer: Option<String>,
    /// Structure that selects levels of detail
    #[arg(long, value_name = "ID")]
    structure: Option<String>,
    /// Image to write: the picture (.png), or all targets (.exr); with --path %04d stands for the picture's number
    #[arg(long, value_name = "FILE", value_parser = values::image_path)]
    out: PathBuf,
    /// Size of the image in pixels, each side up to 65536 [default: the view's, else the session's, else 1280x720]
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    size: Option<[u32; 2]>,
    /// Where to look from: a view FILE, orbit:N for N views around the scene, or the name or number of a view that the
    /// session stores [default: the session's view, else orbit:1]
    #[arg(long, value_name = "FILE|orbit:N|NAME")]
    view: Option<String>,
    /// Draw the pictures of a camera path: a FILE, once around the scene in so many seconds, N views around it, or that of the
    /// session. --view is where a turntable begins
    #[arg(long, value_name = "FILE|turntable:SECONDS[:DEGREES]|orbit:N|session")]
    path: Option<PathSource>,
    /// Pictures a second along the path [default: the path's, else 30]
    #[arg(long, value_name = "RATE", value_parser = film::rate, requires = "path")]
    fps: Option<f64>,
    /// A setting of the renderer; may be given several times
    #[arg(long = "set", value_name = "ID=VALUE", value_parser = values::assignment)]
    settings: Vec<(String, String)>,
    /// A setting of the structure; may be given several times
    #[arg(long = "set-structure", value_name = "ID=VALUE", value_parser = values::assignment)]
    structure_settings: Vec<(String, String)>,
    /// Another target to write, as values (.exr) or colours (.png); may be given several times
    #[arg(long = "aov", value_name = "KEY=FILE", value_parser = values::aov)]
    aovs: Vec<AovFile>,
    /// What the picture shows: 'colours' or the key of a target [default: the session's, else colours]
    #[arg(long, value_name = "KEY")]
    show: Option<String>,
    /// What lies behind: 'transparent', '#rrggbb', or '#rrggbb,#rrggbb' from top to bottom (default: the session's, else
    /// '#4d545e,#171a1f')
    #[arg(long, value_name = "COLOUR", value_parser = values::background)]
    background: Option<Background>,
    /// Factor on the colours [default: the session's, else 1]
    #[arg(long, value_name = "FACTOR", value_parser = values::factor)]
    exposure: Option<f32>,
    /// Factor on every surfel's radius [default: the session's, else 1]
    #[arg(long, value_name = "FACTOR", value_parser = values::factor)]
    radius_scale: Option<f32>,
    /// Tint the surfels that the session has selected
    #[arg(long)]
    show_selection: bool,
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
    let plan = Plan::new(arguments)?;
    let mut stage = Stage::new(globals.stage_options())?;
    named_plugins::warn_of_unusable(&stage.registry(), globals);
    let choice = Choice::new(&stage, arguments, &plan)?;
    let loaders = loaders_of(&stage);
    let (scene, warnings) = arguments.load.load_scene(&plan.files, &loaders)?;
    let scene = Arc::new(scene);
    let renderer = choice.renderer_for(&stage, &scene);
    if let Ok(info) = stage.registry().find_renderer(&renderer) {
        check_targets(&info, arguments, &plan.look.show)?;
    }
    let mut views = plan.views(&scene, arguments.size)?;
    let mut changes = Vec::new();
    if let Some(film) = &plan.film {
        let info = stage.registry().find_renderer(&renderer).ok();
        let drawers = choice.drawers(&renderer, info.as_deref());
        let shots = film.shots(&scene, &views, arguments, &drawers)?;
        (views, changes) = shots.into_iter().unzip();
        film::make_folder(&arguments.out)?;
    }
    let mut written = Vec::new();
    for (index, view) in views.iter().enumerate() {
        let mut request = choice.request(&scene, view, renderer.clone(), arguments, &plan);
        if let Some(ValuesAt {
            renderer,
            structure,
        }) = changes.get(index)
        {
            request.settings.extend(renderer.clone());
            request.structure_settings.extend(structure.clone());
        }
        let place = Place {
            arguments,
            warnings: &warnings,
            index,
            count: views.len(),
            is_film: plan.film.is_some(),
        };
        if plan.film.is_some() {
            film::tell_progress(index, views.len());
        }
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
}
