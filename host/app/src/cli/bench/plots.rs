//! What was measured, as plots.

use pointstage_plot::{Axis, Bar, Bars, Look, Plot, Scale, Series, Stroke, colour};

use super::report::{LaneReport, Report};

/// Names of files, and what is in them.
pub(super) fn all(report: &Report) -> Vec<(String, String)> {
    let mut plots = vec![
        (
            "frames_per_second.svg".to_owned(),
            by_size(report, "Frames a second", "frames a second", |lane| {
                lane.frames_per_second
            }),
        ),
        (
            "splats_per_second.svg".to_owned(),
            by_size(report, "Splats a second", "splats a second", |lane| {
                lane.splats_per_second
            }),
        ),
    ];
    for (index, scene) in report.scenes.iter().enumerate() {
        let bars = scene.renderers.iter().enumerate();
        let bars = bars.filter_map(|(index, lane)| {
            let times = lane.times.as_ref()?;
            Some(Bar {
                name: lane.who.label.clone(),
                colour: colour(index),
                value: times.frame_ms.median,
                reach: Some(times.frame_ms.p99),
                text: format!("{:.2}", times.frame_ms.median),
            })
        });
        let bars = Bars {
            title: format!("{}: ms a picture, median and 99th percentile", scene.name),
            bars: bars.collect(),
        };
        plots.push((format!("times_{index}.svg"), bars.svg(Look::Document)));
    }
    plots
}

/// A number over the sizes of the scenes, a line for each renderer.
fn by_size(
    report: &Report,
    title: &str,
    y: &str,
    number: fn(&LaneReport) -> Option<f64>,
) -> String {
    let labels = report.labels();
    let series = labels.iter().enumerate().map(|(index, label)| {
        let points = report.scenes.iter().filter_map(|scene| {
            let number = number(scene.renderers.get(index)?)?;
            Some([scene.surfels as f64, number])
        });
        let mut points: Vec<[f64; 2]> = points.collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Series {
            name: (*label).to_owned(),
            colour: colour(index),
            stroke: Stroke::Solid,
            points,
        }
    });
    let axis = |title: &str| Axis {
        title: title.to_owned(),
        scale: Scale::Log,
    };
    let plot = Plot {
        title: title.to_owned(),
        x: axis("surfels"),
        y: axis(y),
        series: series.collect(),
        notes: Vec::new(),
    };
    plot.svg(Look::Document)
}
