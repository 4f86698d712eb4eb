//! Limits on what a comparison found.

use super::arguments::ComparisonArguments;
use super::report::{Mean, Report};
use crate::cli::Outcome;
use crate::cli::measuring::limits::{self, Found, Side};
use crate::cli::measuring::times::{Spread, Times};

/// What `--fail-above` limits: less is better.
const ABOVE: [&str; 5] = ["flip", "flip_p99", "ms", "cpu_ms", "gpu_ms"];
/// What `--fail-below` limits: more is better.
const BELOW: [&str; 2] = ["psnr", "ssim"];

/// Refuses limits on what is not measured, before anything is drawn.
pub(super) fn check_names(arguments: &ComparisonArguments) -> Outcome {
    limits::check_names(&arguments.fail_above, Side::Above, &ABOVE)?;
    limits::check_names(&arguments.fail_below, Side::Below, &BELOW)
}

/// Fails if a renderer's mean over the views is beyond a limit.
pub(crate) fn check(arguments: &ComparisonArguments, report: &Report) -> Outcome {
    let found = |quantity: &str| {
        let means = report.means.iter();
        let found = means.map(|mean| Found {
            of: mean.label.clone(),
            value: value(mean, quantity),
        });
        found.collect()
    };
    let mut broken = limits::broken(&arguments.fail_above, Side::Above, found);
    broken.extend(limits::broken(&arguments.fail_below, Side::Below, found));
    limits::check(&broken)
}

fn value(mean: &Mean, quantity: &str) -> Option<f64> {
    let whole = &mean.whole;
    let of_times = |part: fn(&Times) -> Option<Spread>| {
        let spread = mean.times.as_ref().and_then(part);
        spread.map(|spread| spread.median)
    };
    match quantity {
        "flip" => whole.flip_mean,
        "flip_p99" => whole.flip_p99,
        // Means leave out identical views, whose PSNR has no end.
        "psnr" if whole.identical => Some(f64::INFINITY),
        "psnr" => whole.psnr_db,
        "ssim" => whole.ssim,
        "ms" => of_times(|times| Some(times.frame_ms)),
        "cpu_ms" => of_times(|times| Some(times.cpu_ms)),
        "gpu_ms" => of_times(|times| times.gpu_ms),
        _ => None,
    }
}
