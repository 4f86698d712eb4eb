//! `pointstage sweep`: what one setting does to quality and time.
//!
//! The values of a [`range`] make one renderer into several, which are compared like any others ([`compare`]):
//! with pictures, `metrics.json` and `report.html`. On top of that come `sweep.json` and [`plots`]: quality against time, and
//! both over the setting's values.

mod plots;
mod range;

use clap::Args;
use pointstage_engine::metrics::Measures;
use pointstage_engine::stage::Stage;
use serde::Serialize;

use super::compare::{self, ComparisonArguments, Report};
use super::measuring::entries::{self, Entry, EntryText};
use super::measuring::made_by::MadeBy;
use super::measuring::times::Times;
use super::{Failure, Globals, Outcome, write_out};
use crate::output::whole_file;
use range::SetRange;

/// Version of the form of `sweep.json`, which is documented in `docs/user-guide/comparing.md`.
const FORMAT: u32 = 1;

/// Arguments of `sweep`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  pointstage sweep scan.ply --renderer hqss --set-range splat_scale=0.5:2:9 --reference ewa-reference --out sweep
  pointstage sweep scan.ply --renderer pop --set-range threshold=1,2,4,8 --reference ewa-reference:surface=triangles --out sweep
  pointstage sweep scan.ply --renderer hqss:filter=false --set-range path=raster,compute --reference hqss --out sweep

FROM:TO:COUNT is COUNT values from FROM to TO, in equal steps, or in equal factors where the setting's own slider is
logarithmic; or name the values, separated by commas. DIR gets what 'compare' writes, with a picture of each value, and
sweep.json, quality_by_time.svg, quality.svg and time.svg.")]
pub(crate) struct SweepArguments {
    /// The renderer: NAME, or NAME:SETTING=VALUE for what stays the same
    #[arg(long, value_name = "RENDERER", value_parser = entries::entry_text)]
    renderer: EntryText,
    /// The setting, and its values
    #[arg(long, value_name = "ID=FROM:TO:COUNT|ID=A,B,…")]
    set_range: SetRange,
    /// Print sweep.json on standard output in place of the table
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    comparison: ComparisonArguments,
}

/// What one setting does.
#[derive(Debug, Serialize)]
struct Sweep<'a> {
    format: u32,
    made_by: &'a MadeBy,
    size: [u32; 2],
    renderer: String,
    setting: &'a str,
    /// The setting's unit; empty for none.
    unit: String,
    values: Vec<Point<'a>>,
}

/// One value.
#[derive(Debug, Serialize)]
struct Point<'a> {
    value: String,
    /// Names the files of this value.
    label: &'a str,
    /// Means over the views, of whole pictures.
    whole: Measures,
    times: Option<Times>,
}

/// What the values are, once the setting is known.
struct Values {
    renderer: String,
    unit: String,
    texts: Vec<String>,
}

/// Draws, measures and writes.
pub(crate) fn run(globals: &Globals, arguments: &SweepArguments) -> Outcome {
    let range = &arguments.set_range;
    let mut values = None;
    let find = |stage: &Stage| {
        let base = Entry::find(stage, &arguments.renderer)?;
        let setting =
            super::drawing::find_setting(base.schema(), &range.id).map_err(Failure::usage_from)?;
        let texts = range.texts(setting).map_err(Failure::usage)?;
        let of_values: Vec<EntryText> = texts
            .iter()
            .map(|text| arguments.renderer.with(&range.id, text))
            .collect();
        values = Some(Values {
            renderer: base.label.clone(),
            unit: range::unit(setting).to_owned(),
            texts,
        });
        entries::find_all(stage, &of_values)
    };
    let report = compare::compare(globals, &arguments.comparison, find)?;
    let Some(values) = values else {
        return Ok(());
    };
    let sweep = Sweep::new(&report, range, values);
    let folder = &arguments.comparison.out;
    let json = serde_json::to_string_pretty(&sweep)?;
    whole_file::write(&folder.join("sweep.json"), json.as_bytes())?;
    for (name, svg) in plots::all(&sweep) {
        whole_file::write(&folder.join(name), svg.as_bytes())?;
    }
    if arguments.json {
        write_out(&json)?;
    } else {
        write_out(&sweep.table())?;
    }
    compare::check_limits(&arguments.comparison, &report)
}

impl<'a> Sweep<'a> {
    fn new(report: &'a Report, range: &'a SetRange, values: Values) -> Self {
        let means = values.texts.into_iter().zip(&report.means);
        let points = means.map(|(value, mean)| Point {
            value,
            label: &mean.label,
            whole: mean.whole,
            times: mean.times,
        });
        Self {
            format: FORMAT,
            made_by: &report.made_by,
            size: report.size,
            renderer: values.renderer,
            setting: &range.id,
            unit: values.unit,
            values: points.collect(),
        }
    }

    /// For people.
    fn table(&self) -> String {
        let number = |number: Option<f64>, decimals: usize| match number {
            Some(number) if number.is_finite() => format!("{number:.decimals$}"),
            _ => "–".to_owned(),
        };
        let head = format!(
            "{:>14}  {:>8}  {:>7}  {:>7}  {:>8}  {:>8}",
            self.setting, "PSNR dB", "SSIM", "FLIP", "ms", "GPU ms"
        );
        let rows = self.values.iter().map(|point| {
            let psnr = if point.whole.identical {
                "equal".to_owned()
            } else {
                number(point.whole.psnr_db, 2)
            };
            let times = point.times.as_ref();
            format!(
                "{:>14}  {psnr:>8}  {:>7}  {:>7}  {:>8}  {:>8}",
                point.value,
                number(point.whole.ssim, 4),
                number(point.whole.flip_mean, 4),
                number(times.map(|times| times.frame_ms.median), 2),
                number(times.and_then(|times| Some(times.gpu_ms?.median)), 2),
            )
        });
        let lines: Vec<String> = std::iter::once(head).chain(rows).collect();
        lines.join("\n")
    }
}
