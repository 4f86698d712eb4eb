//! `pointstage compare`: how far renderers are from a reference, in pictures and numbers, and how long they take.
//!
//! Who draws is looked up and checked before a file is read ([`mod@reference`]). Then the scene is loaded once, and each view
//! is drawn by the reference and by every renderer, measured, timed and written ([`view`]). What was found ends in
//! `metrics.json`, whose form is documented in `docs/user-guide/comparing.md` ([`report`]), in a [`table`], and in
//! `report.html`, one file to show to others ([`page`]). [`guard`] holds it against limits.

mod arguments;
mod guard;
mod page;
mod reference;
mod report;
mod table;
mod targets;
mod view;

use std::sync::Arc;

use anyhow::Context as _;
use clap::Args;
use pointstage_engine::stage::Stage;

use super::load::loaders_of;
use super::measuring::entries::{self, Entry, EntryText};
use super::{Globals, Outcome, named_plugins, views, write_out};
use crate::output::whole_file;
use crate::session_file::SceneFile;
pub(crate) use arguments::ComparisonArguments;
pub(crate) use guard::check as check_limits;
use reference::Reference;
pub(crate) use report::Report;
use view::Comparison;

/// Arguments of `compare`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  pointstage compare scan.ply --renderers points,hqss --reference surfel --out apart
  pointstage compare scan.ply --renderers all --reference ewa-reference --views orbit:12 --targets all --out apart
  pointstage compare scan.ply --renderers hqss,hqss:filter=false --reference surfel --views orbit:8 --out apart
  pointstage compare scan.ply --renderers points:size_mode=fixed:size=3 --reference surfel --views a.json,b.json --out apart
  pointstage compare scan.ply --renderers hqss --reference surfel --json --out apart
  pointstage compare scan.ply --renderers points,hqss --reference-images truth --views orbit:8 --out apart
  pointstage compare scan.ply --renderers mine --reference surfel --fail-above flip=0.02 --fail-below psnr=35 --out apart

A renderer is NAME, or NAME:SETTING=VALUE:SETTING=VALUE; 'all' stands for every renderer that can draw the scene, without
the reference. All pictures of a view have the same scene, camera, lights, size, exposure and background. DIR gets, for each
view, reference_000.png and each renderer's hqss_000.png, its difference from the reference hqss_000_difference.png (eight
times brightened) and the map of FLIP's errors hqss_000_flip.png; metrics.json: PSNR, SSIM and FLIP over the whole picture,
the interior of what the reference covers, and its edge, and times; and report.html, all of it in one file for a browser.")]
pub(crate) struct CompareArguments {
    /// Renderers to compare, separated by commas; the same one may stand there several times with different settings
    #[arg(long, value_name = "LIST", required = true, value_delimiter = ',', value_parser = entries::entry_text)]
    renderers: Vec<EntryText>,
    /// Print metrics.json on standard output in place of the table
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    comparison: ComparisonArguments,
}

/// Draws, measures and writes.
pub(crate) fn run(globals: &Globals, arguments: &CompareArguments) -> Outcome {
    let find = |stage: &Stage| entries::find_all(stage, &arguments.renderers);
    let report = compare(globals, &arguments.comparison, find)?;
    if arguments.json {
        write_out(&report.json()?)?;
    } else {
        write_out(&table::of(&report))?;
    }
    guard::check(&arguments.comparison, &report)
}

/// Draws and measures all that `find` finds, and writes pictures, `metrics.json` and `report.html`.
///
/// * `find`: looks up who is compared, before a file is read.
pub(crate) fn compare(
    globals: &Globals,
    arguments: &ComparisonArguments,
    find: impl FnOnce(&Stage) -> Outcome<Vec<Entry>>,
) -> Outcome<Report> {
    guard::check_names(arguments)?;
    let sources = arguments
        .views
        .iter()
        .map(|text| views::parse(text, &[]))
        .collect::<Outcome<Vec<_>>>()?;
    let mut stage = Stage::new(globals.stage_options())?;
    named_plugins::warn_of_unusable(&stage.registry(), globals);
    let reference = Reference::find(&stage, arguments)?;
    let renderers = find(&stage)?;
    arguments.look.check_size(&stage)?;
    let files: Vec<SceneFile> = arguments
        .files
        .iter()
        .cloned()
        .map(SceneFile::new)
        .collect();
    let loaders = loaders_of(&stage);
    let (scene, warnings) = arguments.load.load_scene(&files, &loaders)?;
    if let Reference::Renderer { entry, .. } = &reference {
        entry.check_scene(&stage, &scene)?;
    }
    let renderers = entries::those_that_draw(&stage, renderers, &scene, reference.entry())?;
    let targets = targets::find(&stage, arguments, reference.entry(), &renderers)?;
    let mut records = Vec::new();
    for source in &sources {
        records.extend(views::resolve(source, &scene, arguments.look.size, &[])?);
    }
    for view in &mut records {
        [view.width, view.height] = arguments.look.size;
    }
    reference.check_images(records.len(), arguments.look.size)?;
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
        targets: &targets,
        scene: &Arc::new(scene),
        warnings: &warnings,
        count: records.len(),
    };
    let mut found = Vec::new();
    for (index, view) in records.iter().enumerate() {
        found.push(comparison.view(&mut stage, index, view)?);
    }
    let report = Report::new(&stage, &comparison, found)?;
    let json = report.json()?;
    whole_file::write(&arguments.out.join("metrics.json"), json.as_bytes())?;
    let page = page::of(&report, &targets, &arguments.out)?;
    whole_file::write(&arguments.out.join("report.html"), page.as_bytes())?;
    Ok(report)
}
