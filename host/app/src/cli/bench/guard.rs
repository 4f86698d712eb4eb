//! Limits on what a benchmark measured.

use super::BenchArguments;
use super::report::{LaneReport, MemoryReport, Report};
use crate::cli::Outcome;
use crate::cli::measuring::limits::{self, Found, Side};

/// What `--fail-above` limits.
const ABOVE: [&str; 9] = [
    "ms",
    "p95_ms",
    "p99_ms",
    "cpu_ms",
    "gpu_ms",
    "first_ms",
    "switch_ms",
    "ratio",
    "bytes",
];
/// What `--fail-below` limits.
const BELOW: [&str; 2] = ["fps", "splats_per_second"];

/// Refuses limits on what is not measured, before anything is drawn.
pub(super) fn check_names(arguments: &BenchArguments) -> Outcome {
    limits::check_names(&arguments.fail_above, Side::Above, &ABOVE)?;
    limits::check_names(&arguments.fail_below, Side::Below, &BELOW)
}

/// Fails if a renderer on a scene is beyond a limit.
pub(super) fn check(arguments: &BenchArguments, report: &Report) -> Outcome {
    let found = |quantity: &str| {
        let lanes = report.scenes.iter().flat_map(|scene| {
            let lanes = scene.renderers.iter();
            // What cannot draw a scene is not slow on it.
            lanes
                .filter(|lane| lane.unsuitable.is_none())
                .map(move |lane| Found {
                    of: format!("{} on {}", lane.who.label, scene.name),
                    value: value(lane, quantity),
                })
        });
        lanes.collect()
    };
    let mut broken = limits::broken(&arguments.fail_above, Side::Above, found);
    broken.extend(limits::broken(&arguments.fail_below, Side::Below, found));
    limits::check(&broken)
}

fn value(lane: &LaneReport, quantity: &str) -> Option<f64> {
    let times = lane.times.as_ref();
    match quantity {
        "ms" => Some(times?.frame_ms.median),
        "p95_ms" => Some(times?.frame_ms.p95),
        "p99_ms" => Some(times?.frame_ms.p99),
        "cpu_ms" => Some(times?.cpu_ms.median),
        "gpu_ms" => Some(times?.gpu_ms?.median),
        "first_ms" => lane.first_image_ms,
        "switch_ms" => Some(lane.switch_ms?.median),
        "ratio" => lane.ratio,
        "bytes" => lane
            .memory
            .as_ref()
            .map(MemoryReport::peak_bytes)
            .map(|bytes| bytes as f64),
        "fps" => lane.frames_per_second,
        "splats_per_second" => lane.splats_per_second,
        _ => None,
    }
}
