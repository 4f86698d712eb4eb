//! The page's charts.

use pointstage_plot::{Axis, Bar, Bars, Look, Plot, Scale, Series, Stroke, colour};

use super::html;
use crate::cli::compare::report::{Mean, RendererReport, Report};

/// All charts that there is something to show in.
pub(super) fn all(report: &Report) -> String {
    let charts = [
        error_by_time(report),
        times(report),
        by_view(report, "PSNR by view", "dB, whole picture", |found| {
            found.found.whole.psnr_db
        }),
        by_view(
            report,
            "FLIP by view",
            "mean error, whole picture",
            |found| found.found.whole.flip_mean,
        ),
    ];
    let figures = charts
        .into_iter()
        .flatten()
        .map(|svg| format!("<figure>{svg}</figure>\n"));
    format!(
        "<h2 id=charts>Charts</h2>\n<div class=charts>{}</div>\n",
        figures.collect::<String>()
    )
}

/// How wrong against how long: the renderers nearest to the lower left corner leave the others behind.
fn error_by_time(report: &Report) -> Option<String> {
    let error = |mean: &Mean| match mean.whole.flip_mean {
        Some(flip) => Some(flip),
        None => mean.whole.ssim.map(|ssim| 1.0 - ssim),
    };
    let series: Vec<Series> = report
        .means
        .iter()
        .enumerate()
        .filter_map(|(index, mean)| {
            let time = mean.times.as_ref()?.frame_ms.median;
            Some(Series {
                name: mean.label.clone(),
                colour: colour(index),
                stroke: Stroke::Dots,
                points: vec![[time, error(mean)?]],
            })
        })
        .collect();
    let has_flip = report
        .means
        .iter()
        .any(|mean| mean.whole.flip_mean.is_some());
    let error = if has_flip { "FLIP, mean" } else { "1 − SSIM" };
    let plot = Plot {
        title: "Error against time".to_owned(),
        x: axis("ms a picture, median", Scale::Log),
        y: axis(error, Scale::Linear),
        series,
        notes: Vec::new(),
    };
    (!plot.series.is_empty()).then(|| plot.svg(Look::Page))
}

/// Medians, with the 95th percentile as a whisker.
fn times(report: &Report) -> Option<String> {
    let bars: Vec<Bar> = report
        .means
        .iter()
        .enumerate()
        .filter_map(|(index, mean)| {
            let times = mean.times.as_ref()?;
            Some(Bar {
                name: mean.label.clone(),
                colour: colour(index),
                value: times.frame_ms.median,
                reach: Some(times.frame_ms.p95),
                text: html::millis(Some(times.frame_ms.median)),
            })
        })
        .collect();
    let title = "ms a picture: median, to the 95th percentile".to_owned();
    (!bars.is_empty()).then(|| Bars { title, bars }.svg(Look::Page))
}

/// A number over the views, a line for each renderer; nothing for one view alone.
fn by_view(
    report: &Report,
    title: &str,
    y: &str,
    number: fn(&RendererReport) -> Option<f64>,
) -> Option<String> {
    if report.views.len() < 2 {
        return None;
    }
    let series = report.means.iter().enumerate().map(|(index, mean)| {
        let views = report.views.iter().enumerate();
        let points = views.filter_map(|(view, found)| {
            let number = number(found.renderers.get(index)?)?;
            number.is_finite().then_some([view as f64, number])
        });
        Series {
            name: mean.label.clone(),
            colour: colour(index),
            stroke: Stroke::Solid,
            points: points.collect(),
        }
    });
    let series: Vec<Series> = series.filter(|series| !series.points.is_empty()).collect();
    let scale = if y.starts_with("dB") {
        Scale::Span
    } else {
        Scale::Linear
    };
    let plot = Plot {
        title: title.to_owned(),
        x: axis("view", Scale::Whole),
        y: axis(y, scale),
        series,
        notes: Vec::new(),
    };
    (!plot.series.is_empty()).then(|| plot.svg(Look::Page))
}

fn axis(title: &str, scale: Scale) -> Axis {
    Axis {
        title: title.to_owned(),
        scale,
    }
}
