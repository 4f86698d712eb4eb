//! The setting's curve.

use pointstage_plot::{Axis, Look, Plot, Scale, Series, Stroke, colour};

use super::{Point, Sweep};

/// How wrong whole pictures are: FLIP, or without it what SSIM misses.
fn error(point: &Point<'_>) -> Option<f64> {
    let ssim = point.whole.ssim.map(|ssim| 1.0 - ssim);
    point.whole.flip_mean.or(ssim)
}

fn time(point: &Point<'_>) -> Option<f64> {
    Some(point.times.as_ref()?.frame_ms.median)
}

/// Names of files, and what is in them.
pub(super) fn all(sweep: &Sweep<'_>) -> Vec<(&'static str, String)> {
    let has_flip = sweep
        .values
        .iter()
        .any(|point| point.whole.flip_mean.is_some());
    let error_title = if has_flip { "FLIP, mean" } else { "1 − SSIM" };
    let setting = match sweep.unit.as_str() {
        "" => sweep.setting.to_owned(),
        unit => format!("{}, {unit}", sweep.setting),
    };
    let title = format!("{}: {}", sweep.renderer, sweep.setting);
    let by_time = plot(
        format!("{title}, error against time"),
        ["ms a picture, median", error_title],
        sweep,
        &|_, point| Some([time(point)?, error(point)?]),
    );
    // Values that are no numbers stand in their order.
    let abscissa = |index: usize, point: &Point<'_>| {
        let number = point.value.parse::<f64>().ok();
        number.unwrap_or(index as f64)
    };
    let quality = plot(
        format!("{title}, error"),
        [&setting, error_title],
        sweep,
        &|index, point| Some([abscissa(index, point), error(point)?]),
    );
    let time = plot(
        format!("{title}, time"),
        [&setting, "ms a picture, median"],
        sweep,
        &|index, point| Some([abscissa(index, point), time(point)?]),
    );
    vec![
        ("quality_by_time.svg", by_time),
        ("quality.svg", quality),
        ("time.svg", time),
    ]
}

/// One line through all values, each with its value beside it.
fn plot(
    title: String,
    [x, y]: [&str; 2],
    sweep: &Sweep<'_>,
    at: &dyn Fn(usize, &Point<'_>) -> Option<[f64; 2]>,
) -> String {
    let points = sweep.values.iter().enumerate();
    let points: Vec<([f64; 2], String)> = points
        .filter_map(|(index, point)| Some((at(index, point)?, point.value.clone())))
        .collect();
    let axis = |title: &str| Axis {
        title: title.to_owned(),
        scale: Scale::Linear,
    };
    let plot = Plot {
        title,
        x: axis(x),
        y: axis(y),
        series: vec![Series {
            name: sweep.setting.to_owned(),
            colour: colour(0),
            stroke: Stroke::Solid,
            points: points.iter().map(|(point, _)| *point).collect(),
        }],
        notes: points,
    };
    plot.svg(Look::Document)
}
