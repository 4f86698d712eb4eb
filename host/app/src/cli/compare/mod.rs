//! `pointstage compare`: how far renderers are from a reference, in pictures and numbers.
//!
//! Who draws is looked up and checked before a file is read ([`entries`], [`mod@reference`]). Then the scene is loaded once, and
//! each view is drawn by the reference and by every renderer, measured and written ([`view`]). What was found ends in
//! `metrics.json`, whose form is documented in `docs/user-guide/comparing.md` ([`report`]), and in a table ([`table`]).

mod entries;
mod reference;
mod report;
mod table;
mod view;

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::Context as _;
use clap::Args;
use pointstage_engine::stage::{Background, Stage};

use super::load::LoadArguments;
use super::values;
use super::{Failure, Globals, Outcome, named_plugins, views, write_out};
use crate::output::whole_file;
use crate::session_file::SceneFile;
use entries::EntryText;
use reference::Reference;
use report::Report;
use view::Comparison;

/// Arguments of `compare`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  pointstage compare scan.ply --renderers points,hqss --reference surfel --out apart
  pointstage compare scan.ply --renderers hqss,hqss:filter=false --reference surfel --views orbit:8 --out apart
  pointstage compare scan.ply --renderers points:size_mode=fixed:size=3 --reference surfel --views a.json,b.json --out apart
  pointstage compare scan.ply --renderers hqss --reference surfel --json --out apart
  pointstage compare scan.ply --renderers points,hqss --reference-images truth --views orbit:8 --out apart

A renderer is NAME, or NAME:SETTING=VALUE:SETTING=VALUE. All pictures of a view have the same scene, camera, lights, size,
exposure and background. DIR gets, for each view, reference_000.png and each renderer's hqss_000.png, its difference from
the reference hqss_000_difference.png (eight times brightened) and the map of FLIP's errors hqss_000_flip.png, and one
metrics.json: PSNR, SSIM and FLIP over the whole picture, the interior of what the reference covers, and its edge.")]
pub(crate) struct CompareArguments {
    /// PLY files; each becomes an object
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// Renderers to compare, separated by commas; the same one may stand there several times with different settings
    #[arg(long, value_name = "LIST", required = true, value_delimiter = ',', value_parser = entries::entry_text)]
    renderers: Vec<EntryText>,
    /// The renderer that the others are measured by
    #[arg(long, value_name = "RENDERER", value_parser = entries::entry_text, required_unless_present = "reference_images")]
    reference: Option<EntryText>,
    /// Folder of pictures to measure by instead: reference_000.png for the first view, and so on
    #[arg(long, value_name = "DIR", conflicts_with = "reference")]
    reference_images: Option<PathBuf>,
    /// Where to look from: view FILEs, or orbit:N for N views around the scene, separated by commas
    #[arg(
        long,
        value_name = "FILE|orbit:N",
        value_delimiter = ',',
        default_value = "orbit:1"
    )]
    views: Vec<String>,
    /// Size of every picture in pixels, whatever a view's file says
    #[arg(long, value_name = "WxH", value_parser = values::size, default_value = "800x580")]
    size: [u32; 2],
    /// Folder for pictures, maps and metrics.json; is made, and files of the same names are replaced
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// What lies behind: '#rrggbb', or '#rrggbb,#rrggbb' from top to bottom
    #[arg(long, value_name = "COLOUR", value_parser = values::opaque_background, default_value = "#ffffff")]
    background: Background,
    /// Factor on the colours
    #[arg(long, value_name = "FACTOR", value_parser = values::factor, default_value = "1")]
    exposure: f32,
    /// Factor on every surfel's radius
    #[arg(long, value_name = "FACTOR", value_parser = values::factor, default_value = "1")]
    radius_scale: f32,
    /// Print metrics.json on standard output in place of the table
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    load: LoadArguments,
}

/// Draws, measures and writes.
pub(crate) fn run(globals: &Globals, arguments: &CompareArguments) -> Outcome {
    let sources = arguments
        .views
        .iter()
        .map(|text| views::parse(text, &[]))
        .collect::<Outcome<Vec<_>>>()?;
    let mut stage = Stage::new(globals.stage_options())?;
    named_plugins::warn_of_unusable(&stage.registry(), globals);
    let reference = Reference::find(&stage, arguments)?;
    let renderers = entries::find_all(&stage, &arguments.renderers)?;
    check_size(&stage, arguments.size)?;
    let files: Vec<SceneFile> = arguments
        .files
        .iter()
        .cloned()
        .map(SceneFile::new)
        .collect();
    let (scene, warnings) = arguments.load.load_scene(&files)?;
    if let Reference::Renderer { entry, .. } = &reference {
        entry.check_scene(&stage, &scene)?;
    }
    renderers
        .iter()
        .try_for_each(|entry| entry.check_scene(&stage, &scene))?;
    let mut records = Vec::new();
    for source in &sources {
        records.extend(views::resolve(source, &scene, arguments.size, &[])?);
    }
    for view in &mut records {
        [view.width, view.height] = arguments.size;
    }
    reference.check_images(records.len(), arguments.size)?;
    std::fs::create_dir_all(&arguments.out).with_context(|| {
        format!(
            "{}: the folder cannot be made; name one in a place that may be written to",
            arguments.out.display()
        )
    })?;
    let comparison = Comparison {
        arguments,
        reference: &reference,
        renderers: &renderers,
        scene: &Arc::new(scene),
        warnings: &warnings,
        count: records.len(),
    };
    let mut found = Vec::new();
    for (index, view) in records.iter().enumerate() {
        found.push(comparison.view(&mut stage, index, view)?);
    }
    let report = Report::new(&stage, arguments, (&reference, &renderers), found);
    let json = serde_json::to_string_pretty(&report)?;
    whole_file::write(&arguments.out.join("metrics.json"), json.as_bytes())?;
    if arguments.json {
        write_out(&json)
    } else {
        write_out(&table::of(&report))
    }
}

/// Pictures are measured undivided, so they are drawn at once.
fn check_size(stage: &Stage, size_px: [u32; 2]) -> Outcome {
    let most = stage.largest_frame_px();
    if size_px.iter().any(|side| *side > most) {
        let [width, height] = size_px;
        return Err(Failure::usage(format!(
            "--size {width}x{height}: what is compared is drawn at once, up to {most} pixels a side here; choose a smaller size"
        )));
    }
    Ok(())
}
