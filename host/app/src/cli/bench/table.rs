//! What was measured, as tables for people: one to print, and a page of Markdown.

use std::fmt::Write as _;

use super::report::{LaneReport, MemoryReport, Report, SceneReport};

const HEAD: [&str; 12] = [
    "scene", "renderer", "fps", "splats/s", "ms", "p95", "p99", "CPU ms", "GPU ms", "first",
    "switch", "MB",
];
/// Columns of words before those of numbers.
const WORDS: usize = 2;

/// Rows for each scene and renderer.
fn rows(report: &Report) -> Vec<Vec<String>> {
    let of_scene = |scene: &SceneReport| -> Vec<Vec<String>> {
        let lanes = scene.renderers.iter();
        lanes.map(|lane| row(scene, lane)).collect()
    };
    report.scenes.iter().flat_map(of_scene).collect()
}

fn row(scene: &SceneReport, lane: &LaneReport) -> Vec<String> {
    let times = lane.times.as_ref();
    let memory = lane.memory.as_ref().map(MemoryReport::peak_bytes);
    vec![
        scene.name.clone(),
        lane.who.label.clone(),
        rate(lane.frames_per_second),
        splats(lane.splats_per_second),
        millis(times.map(|times| times.frame_ms.median)),
        millis(times.map(|times| times.frame_ms.p95)),
        millis(times.map(|times| times.frame_ms.p99)),
        millis(times.map(|times| times.cpu_ms.median)),
        millis(times.and_then(|times| Some(times.gpu_ms?.median))),
        millis(lane.first_image_ms),
        millis(lane.switch_ms.map(|switch| switch.median)),
        memory.map_or_else(dash, |bytes| format!("{:.0}", bytes as f64 / 1e6)),
    ]
}

fn dash() -> String {
    "–".to_owned()
}

/// Frames a second: 0.45, 7.3, 80.
fn rate(rate: Option<f64>) -> String {
    match rate {
        None => dash(),
        Some(rate) if rate < 1.0 => format!("{rate:.2}"),
        Some(rate) if rate < 10.0 => format!("{rate:.1}"),
        Some(rate) => format!("{rate:.0}"),
    }
}

/// Splats a second, in millions.
fn splats(rate: Option<f64>) -> String {
    rate.map_or_else(dash, |rate| format!("{:.2} M", rate / 1e6))
}

fn millis(ms: Option<f64>) -> String {
    match ms {
        None => dash(),
        Some(ms) if ms < 10.0 => format!("{ms:.2}"),
        Some(ms) if ms < 100.0 => format!("{ms:.1}"),
        Some(ms) => format!("{ms:.0}"),
    }
}

/// The table to print, and why renderers are missing in it.
pub(super) fn of(report: &Report) -> String {
    let head: Vec<String> = HEAD.map(str::to_owned).to_vec();
    let all: Vec<Vec<String>> = std::iter::once(head).chain(rows(report)).collect();
    let width = |column: usize| {
        let cells = all.iter().map(|row| row[column].chars().count());
        cells.max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..HEAD.len()).map(width).collect();
    let mut text = String::new();
    for row in &all {
        for (column, (cell, width)) in row.iter().zip(&widths).enumerate() {
            let width = *width;
            let _ = if column < WORDS {
                write!(text, "{cell:width$}  ")
            } else {
                write!(text, "{cell:>width$}  ")
            };
        }
        text.truncate(text.trim_end().len());
        text.push('\n');
    }
    text + &reasons(report)
}

/// Why renderers did not draw.
fn reasons(report: &Report) -> String {
    let mut text = String::new();
    for scene in &report.scenes {
        for lane in &scene.renderers {
            if let Some(reason) = &lane.unsuitable {
                let _ = writeln!(
                    text,
                    "{} does not draw {}: {reason}",
                    lane.who.label, scene.name
                );
            }
        }
    }
    text
}

/// `bench.md`: how it was measured, frames and splats a second by renderer, and all numbers.
pub(super) fn markdown(report: &Report) -> String {
    let [width, height] = report.size;
    let labels = report.labels();
    let mut page = format!(
        "# Speed\n\n`{}`\n\nOn {}, {}, {} threads. {width}×{height} pixels, path '{}', up to {} pictures in {} rounds; times in \
         ms, of whole pictures until they are in memory. First: the first image in a new session. Switch: the picture after \
         another renderer's. MB: the most memory, on the device or in the process.\n",
        cell(&report.made_by.command),
        cell(&report.made_by.device_in_words()),
        report.made_by.system,
        report.made_by.threads,
        cell(&report.path),
        report.frames,
        report.rounds,
    );
    let matrix = |title: &str, number: fn(&LaneReport) -> String| {
        let head = ["scene", "surfels"]
            .into_iter()
            .chain(labels.iter().copied());
        let rows = report.scenes.iter().map(|scene| {
            let words = [scene.name.clone(), scene.surfels.to_string()];
            let numbers = scene.renderers.iter().map(number);
            words.into_iter().chain(numbers).collect()
        });
        let table = table(
            1,
            &head.map(str::to_owned).collect::<Vec<_>>(),
            rows.collect(),
        );
        format!("\n## {title}\n\n{table}")
    };
    page += &matrix("Frames a second", |lane| rate(lane.frames_per_second));
    page += &matrix("Splats a second", |lane| splats(lane.splats_per_second));
    if let Some(baseline) = &report.baseline {
        let title = format!("Time, as a multiple of {}'s", cell(baseline));
        page += &matrix(&title, |lane| {
            lane.ratio.map_or_else(dash, |ratio| format!("{ratio:.2}"))
        });
    }
    page += "\n## All numbers\n\n";
    page += &table(WORDS, &HEAD.map(str::to_owned), rows(report));
    let reasons = reasons(report);
    if !reasons.is_empty() {
        let _ = write!(page, "\n{}", reasons.replace('\n', "  \n"));
    }
    page
}

/// A text that ends no cell and no code.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
        .replace('`', "'")
        .replace('\n', " ")
}

fn table(words: usize, head: &[String], rows: Vec<Vec<String>>) -> String {
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let rules = (0..head.len()).map(|column| if column < words { "---" } else { "---:" });
    let rules = rules.map(str::to_owned).collect();
    let mut table = line(head.iter().map(|text| cell(text)).collect()) + &line(rules);
    for row in rows {
        table += &line(row.iter().map(|text| cell(text)).collect());
    }
    table
}
