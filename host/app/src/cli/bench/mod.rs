//! `pointstage bench`: how fast renderers draw scenes along one path.
//!
//! Each scene gets a stage of its own, each renderer on it a [`lane::Lane`]. First every lane shows its first image in a stage of
//! its own that is new ([`first`]); then all draw along the [`path`] in rounds, forwards and backwards in turns, so that a
//! machine that slows down or warms up is fair to all ([`rounds`]). What was measured becomes `bench.json` ([`report`]), tables
//! ([`table`]) and [`plots`].

mod first;
mod guard;
mod lane;
mod memory;
mod path;
mod plots;
mod report;
mod rounds;
mod table;

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::Context as _;
use clap::Args;
use pointstage_engine::stage::Stage;
use pointstage_scene::{Loaders, Scene};

use super::load::{LoadArguments, loaders_of};
use super::measuring::entries::{self, Entry, EntryText};
use super::measuring::limits::Limit;
use super::measuring::look::LookArguments;
use super::measuring::made_by::MadeBy;
use super::{Failure, Globals, Outcome, named_plugins, write_out};
use crate::camera_path::PathSource;
use crate::output::whole_file;
use crate::session_file::SceneFile;
use lane::Lane;
use report::Report;

/// Arguments of `bench`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  pointstage bench scan.ply --renderers points,surfel,hqss
  pointstage bench a.ply b.ply c.ply --renderers all --frames 120 --out speed
  pointstage bench scan.ply --renderers hqss:path=raster,hqss:path=compute --path flight.json --json
  pointstage bench scan.ply --renderers mine,surfel --baseline surfel --fail-above ratio=1.5 --fail-above first_ms=2000

Every FILE is a scene of its own. A renderer is NAME, or NAME:SETTING=VALUE:SETTING=VALUE; 'all' stands for every renderer.
Pictures are drawn as fast as they can be (there is no display to wait for) and read back. Renderers and scenes take turns,
round by round. --path FILE holds a camera path (.toml), a view record (JSON), around whose pivot the eye turns once, or a list
of them ([ …, … ]), which the eye flies through. Pictures are spread evenly over its time. With --out, DIR gets bench.json, bench.md and plots (SVG).")]
pub(crate) struct BenchArguments {
    /// Files of points or meshes, each a scene of its own
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// Renderers to time, separated by commas; the same one may stand there several times with different settings
    #[arg(long, value_name = "LIST", required = true, value_delimiter = ',', value_parser = entries::entry_text)]
    renderers: Vec<EntryText>,
    /// The eye's way: once around the scene, or along a camera path or through the views of a FILE
    #[arg(
        long,
        value_name = "orbit[:N]|turntable:SECONDS[:DEGREES]|FILE",
        default_value = "orbit"
    )]
    path: PathSource,
    /// Pictures along the way that count
    #[arg(long, value_name = "N", default_value = "60", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    frames: u32,
    /// Turns in which they are drawn
    #[arg(long, value_name = "N", default_value = "5", value_parser = clap::value_parser!(u32).range(1..=1000))]
    rounds: u32,
    /// Pictures at the beginning of each turn that do not count
    #[arg(long, value_name = "N", default_value = "2", value_parser = clap::value_parser!(u32).range(0..=1000))]
    warm_up: u32,
    /// Time that a renderer gets on a scene: a slow one draws fewer pictures, at least one
    #[arg(long, value_name = "SECONDS", default_value = "30", value_parser = super::values::factor)]
    budget: f32,
    /// One of the renderers, as it stands in --renderers: all times are also given as ratios to its
    #[arg(long, value_name = "RENDERER", value_parser = entries::entry_text)]
    baseline: Option<EntryText>,
    /// Folder for bench.json, bench.md and plots; is made, and files of the same names are replaced
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print bench.json on standard output in place of the table
    #[arg(long)]
    json: bool,
    /// Fail (exit code 1) if a renderer on a scene is above this: ms, p95_ms, p99_ms, cpu_ms, gpu_ms, first_ms, switch_ms,
    /// ratio or bytes; may be given several times
    #[arg(long, value_name = "QUANTITY=NUMBER", help_heading = "Limits")]
    fail_above: Vec<Limit>,
    /// Fail (exit code 1) if a renderer on a scene is below this: fps or splats_per_second; may be given several times
    #[arg(long, value_name = "QUANTITY=NUMBER", help_heading = "Limits")]
    fail_below: Vec<Limit>,
    #[command(flatten)]
    look: LookArguments,
    #[command(flatten)]
    load: LoadArguments,
}

/// A scene to draw.
struct Stand {
    /// Names it in tables.
    name: String,
    file: PathBuf,
    scene: Arc<Scene>,
}

/// Times and writes.
pub(crate) fn run(globals: &Globals, arguments: &BenchArguments) -> Outcome {
    guard::check_names(arguments)?;
    let mut stage = Stage::new(globals.stage_options())?;
    named_plugins::warn_of_unusable(&stage.registry(), globals);
    let entries = entries::find_all(&stage, &arguments.renderers)?;
    let baseline = baseline(&stage, arguments, &entries)?;
    arguments.look.check_size(&stage)?;
    let stands = stands(arguments, &loaders_of(&stage))?;
    let paths = stands
        .iter()
        .map(|stand| {
            path::cameras(
                &arguments.path,
                &stand.scene,
                arguments.look.size,
                arguments.frames,
            )
        })
        .collect::<Outcome<Vec<_>>>()?;
    if let Some(folder) = &arguments.out {
        std::fs::create_dir_all(folder).with_context(|| {
            format!(
                "{}: the folder cannot be made; name one in a place that may be written to",
                folder.display()
            )
        })?;
    }
    let entries = first::make_contact(&mut stage, arguments, entries, &stands)?;
    let made_by = MadeBy::now(&stage);
    let mut lanes = Lane::all(&stage, &entries, &stands);
    // Its plugins and their memory are gone before anything is measured.
    drop(stage);
    first::measure(globals, arguments, (&stands, &paths), &mut lanes)?;
    rounds::measure(globals, arguments, (&stands, &paths), &mut lanes)?;
    let report = Report::new(arguments, made_by, &stands, &lanes, baseline.as_deref())?;
    let json = serde_json::to_string_pretty(&report)?;
    if let Some(folder) = &arguments.out {
        whole_file::write(&folder.join("bench.json"), json.as_bytes())?;
        whole_file::write(
            &folder.join("bench.md"),
            table::markdown(&report).as_bytes(),
        )?;
        for (name, svg) in plots::all(&report) {
            whole_file::write(&folder.join(name), svg.as_bytes())?;
        }
    }
    if arguments.json {
        write_out(&json)?;
    } else {
        write_out(&table::of(&report))?;
    }
    guard::check(arguments, &report)
}

/// The label of the renderer that the others are held against.
fn baseline(
    stage: &Stage,
    arguments: &BenchArguments,
    entries: &[Entry],
) -> Outcome<Option<String>> {
    let Some(text) = &arguments.baseline else {
        return Ok(None);
    };
    let wanted = Entry::find(stage, text)?;
    let same = |entry: &&Entry| entry.id == wanted.id && entry.settings == wanted.settings;
    match entries.iter().find(same) {
        Some(entry) => Ok(Some(entry.label.clone())),
        None => Err(Failure::usage(format!(
            "--baseline {}: it is not among --renderers; name one of those, written the same",
            wanted.label
        ))),
    }
}

/// Loads every scene, and names them apart.
fn stands(arguments: &BenchArguments, loaders: &Loaders) -> Outcome<Vec<Stand>> {
    let mut stands: Vec<Stand> = Vec::new();
    for file in &arguments.files {
        let (scene, _) = arguments
            .load
            .load_scene(&[SceneFile::new(file.clone())], loaders)?;
        let stem = file.file_stem().unwrap_or(file.as_os_str());
        let stem = stem.to_string_lossy().into_owned();
        let is_taken = |name: &str| stands.iter().any(|stand| stand.name == name);
        let numbered = (2..).map(|number| format!("{stem}-{number}"));
        let mut names = std::iter::once(stem.clone()).chain(numbered);
        let name = names.find(|name| !is_taken(name)).unwrap_or(stem.clone());
        stands.push(Stand {
            name,
            file: file.clone(),
            scene: Arc::new(scene),
        });
    }
    Ok(stands)
}
