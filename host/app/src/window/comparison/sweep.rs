//! The curve that `pointstage sweep` wrote: error against time, and a click on a value gives it to the active view.

use std::path::{Path, PathBuf};

use egui::{Align2, FontId, Rect, Sense, Stroke, Ui, pos2, vec2};
use serde::Deserialize;

use super::super::intent::{CompareIntent, Intents};
use super::super::rows::Rows;
use super::super::session::Session;
use crate::toml_form::read_small;

/// Size of the plot, points.
const PLOT: [f32; 2] = [360.0, 240.0];

/// Room for the numbers beside the plot, points.
const MARGIN: f32 = 34.0;

/// How near a click has to be to a point, points.
const REACH: f32 = 12.0;

/// A sweep on the screen.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SweepPanel {
    /// The file.
    pub(crate) path: PathBuf,
    sweep: Sweep,
}

/// What is read of `sweep.json`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
struct Sweep {
    format: u32,
    /// As the command line named it: an alias or an id.
    renderer: String,
    setting: String,
    #[serde(default)]
    unit: String,
    values: Vec<Value>,
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
struct Value {
    #[serde(rename = "value")]
    text: String,
    whole: Whole,
    times: Option<Times>,
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
struct Whole {
    ssim: Option<f64>,
    flip_mean: Option<f64>,
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
struct Times {
    frame_ms: Frame,
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
struct Frame {
    median: f64,
}

impl SweepPanel {
    /// Reads `sweep.json`.
    ///
    /// # Errors
    /// A sentence that names the file: it cannot be read, is no sweep, or is of another format.
    pub(crate) fn read(path: &Path) -> Result<Self, String> {
        let name = path.display();
        let text = read_small(path).map_err(|error| format!("{name}: cannot be read: {error}"))?;
        let sweep: Sweep = serde_json::from_slice(&text).map_err(|error| {
            format!(
                "{name}: is no sweep: {error}; open the sweep.json that 'pointstage sweep' wrote"
            )
        })?;
        if sweep.format != 1 {
            return Err(format!(
                "{name}: the sweep has format {}, this program reads format 1; sweep again with this program",
                sweep.format
            ));
        }
        Ok(Self {
            path: path.to_path_buf(),
            sweep,
        })
    }

    /// Whether a path's name says that it may be a sweep.
    pub(crate) fn is_named_like_one(path: &Path) -> bool {
        path.extension()
            .is_some_and(|extension| extension.eq_ignore_ascii_case("json"))
    }

    /// The id of the renderer that was swept, if it is there.
    fn renderer<'a>(&self, rows: &'a Rows) -> Option<&'a str> {
        // What stays the same during the sweep stands behind a colon.
        let name = self.sweep.renderer.split(':').next().unwrap_or_default();
        let mut found = rows.renderers.iter();
        let row = found.find(|row| row.id == name || row.alias == name)?;
        Some(&row.id)
    }

    /// The value that the active view draws with, if it draws with the renderer of the sweep.
    pub(crate) fn applied(&self, session: &Session, rows: &Rows) -> Option<String> {
        let pane = &session.panes.active;
        let id = self.renderer(rows).filter(|id| *id == pane.renderer)?;
        let settings = &rows.renderer(id)?.settings;
        let schema = settings
            .iter()
            .find(|schema| schema.id == self.sweep.setting)?;
        let own = pane.settings_of(id).get(&schema.id).cloned();
        let own = own.or_else(|| schema.default_value())?;
        let mut values = self.sweep.values.iter();
        let found = values.find(|value| schema.parse_text(&value.text).ok().as_ref() == Some(&own));
        found.map(|value| value.text.clone())
    }

    /// Error and time of each value that has both; whether the error is FLIP.
    fn points(&self) -> (Vec<(usize, [f64; 2])>, bool) {
        let has_flip = self
            .sweep
            .values
            .iter()
            .any(|value| value.whole.flip_mean.is_some());
        let error = |value: &Value| {
            if has_flip {
                value.whole.flip_mean
            } else {
                value.whole.ssim.map(|ssim| 1.0 - ssim)
            }
        };
        let values = self.sweep.values.iter().enumerate();
        let points = values.filter_map(|(index, value)| {
            let time = value
                .times
                .as_ref()
                .map_or(index as f64, |times| times.frame_ms.median);
            Some((index, [time, error(value)?]))
        });
        (points.collect(), has_flip)
    }
}

/// The plot and a button for each value.
pub(crate) fn sweep_ui(
    ui: &mut Ui,
    panel: &SweepPanel,
    rows: &Rows,
    applied: Option<&str>,
    out: &mut Intents,
) {
    let Sweep {
        renderer,
        setting,
        unit,
        values,
        ..
    } = &panel.sweep;
    ui.label(format!("{renderer}: {setting}"));
    let Some(id) = panel.renderer(rows) else {
        ui.label(format!(
            "The renderer '{renderer}' is not there: install its plugin to apply its values."
        ));
        return;
    };
    let (points, has_flip) = panel.points();
    let error_title = if has_flip { "FLIP, mean" } else { "1 − SSIM" };
    let has_times = values.iter().any(|value| value.times.is_some());
    let time_title = if has_times {
        "ms a picture"
    } else {
        "number of the value"
    };
    let clicked = plot_ui(ui, panel, &points, applied, [time_title, error_title]);
    let mut chosen = clicked;
    ui.horizontal_wrapped(|ui| {
        for (index, value) in values.iter().enumerate() {
            let text = format!("{} {unit}", value.text);
            let is_applied = applied == Some(value.text.as_str());
            if ui.selectable_label(is_applied, text.trim()).clicked() {
                chosen = Some(index);
            }
        }
    });
    ui.weak("A click on a point or a value gives it to the active view.");
    if let Some(value) = chosen.and_then(|index| values.get(index)) {
        out.push(CompareIntent::ApplySweep {
            renderer: id.to_owned(),
            setting: setting.clone(),
            value: value.text.clone(),
        });
    }
}

/// Draws the curve; the value whose point was clicked.
fn plot_ui(
    ui: &mut Ui,
    panel: &SweepPanel,
    points: &[(usize, [f64; 2])],
    applied: Option<&str>,
    titles: [&str; 2],
) -> Option<usize> {
    let (rect, response) = ui.allocate_exact_size(vec2(PLOT[0], PLOT[1]), Sense::click());
    response
        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Curve of the sweep"));
    let inner = Rect::from_min_max(rect.min + vec2(MARGIN, 8.0), rect.max - vec2(14.0, MARGIN));
    let painter = ui.painter_at(rect);
    let visuals = ui.visuals();
    painter.rect_filled(inner, 2.0, visuals.extreme_bg_color);
    let (weak, strong) = (visuals.weak_text_color(), visuals.strong_text_color());
    let line = visuals.selection.bg_fill;
    let most = most(points);
    let places: Vec<(usize, egui::Pos2)> = points
        .iter()
        .map(|(index, point)| (*index, place_of(inner, *point, most)))
        .collect();
    for pair in places.windows(2) {
        painter.line_segment([pair[0].1, pair[1].1], Stroke::new(1.5, line));
    }
    for (index, at) in &places {
        let value = &panel.sweep.values[*index].text;
        let is_applied = applied == Some(value.as_str());
        painter.circle(*at, if is_applied { 6.0 } else { 4.0 }, line, (1.0, strong));
        painter.text(
            *at + vec2(0.0, -7.0),
            Align2::CENTER_BOTTOM,
            value,
            FontId::proportional(11.0),
            strong,
        );
    }
    let font = FontId::proportional(11.0);
    let texts = [
        (
            inner.left_bottom() + vec2(0.0, 4.0),
            Align2::LEFT_TOP,
            "0".to_owned(),
        ),
        (
            inner.right_bottom() + vec2(0.0, 4.0),
            Align2::RIGHT_TOP,
            format!("{:.3}", most[0]),
        ),
        (
            inner.center_bottom() + vec2(0.0, 16.0),
            Align2::CENTER_TOP,
            titles[0].to_owned(),
        ),
        (
            inner.left_top() + vec2(4.0, 2.0),
            Align2::LEFT_TOP,
            format!("{:.4} {}", most[1], titles[1]),
        ),
    ];
    for (at, align, text) in texts {
        painter.text(at, align, text, font.clone(), weak);
    }
    let at = response
        .interact_pointer_pos()
        .filter(|_| response.clicked())?;
    nearest(&places, at)
}

/// The greatest time and error; 1 where there is none.
fn most(points: &[(usize, [f64; 2])]) -> [f64; 2] {
    std::array::from_fn(|axis| {
        let values = points.iter().map(|(_, point)| point[axis]);
        let most = values.filter(|value| value.is_finite()).fold(0.0, f64::max);
        if most > 0.0 { most } else { 1.0 }
    })
}

fn place_of(inner: Rect, point: [f64; 2], most: [f64; 2]) -> egui::Pos2 {
    let part = |axis: usize| (point[axis] / most[axis]).clamp(0.0, 1.0) as f32;
    pos2(
        inner.left() + part(0) * inner.width(),
        inner.bottom() - part(1) * inner.height(),
    )
}

fn nearest(places: &[(usize, egui::Pos2)], at: egui::Pos2) -> Option<usize> {
    let distances = places
        .iter()
        .map(|(index, place)| (*index, place.distance(at)));
    let near = distances.filter(|(_, distance)| *distance <= REACH);
    near.min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(index, _)| index)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(text: &str) -> Result<SweepPanel, String> {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("sweep.json");
        std::fs::write(&path, text).expect("written");
        SweepPanel::read(&path)
    }

    #[test]
    fn a_click_finds_the_nearest_value_and_nothing_far_from_all() {
        let panel = written(
            r#"{ "format": 1, "renderer": "hqss", "setting": "splat_scale", "unit": "", "size": [8, 8], "values": [
                { "value": "0.5", "label": "a", "whole": { "ssim": 0.5, "flip_mean": 0.4 }, "times": { "frame_ms": { "median": 2.0 } } },
                { "value": "1", "label": "b", "whole": { "ssim": 0.9, "flip_mean": 0.1 }, "times": { "frame_ms": { "median": 4.0 } } }
            ] }"#,
        )
        .expect("a sweep");
        let (points, has_flip) = panel.points();
        assert!(has_flip);
        assert_eq!(points, [(0, [2.0, 0.4]), (1, [4.0, 0.1])]);
        let inner = Rect::from_min_size(pos2(0.0, 0.0), vec2(200.0, 100.0));
        let places: Vec<_> = points
            .iter()
            .map(|(index, point)| (*index, place_of(inner, *point, most(&points))))
            .collect();
        assert_eq!(places, [(0, pos2(100.0, 0.0)), (1, pos2(200.0, 75.0))]);
        assert_eq!(nearest(&places, pos2(104.0, 5.0)), Some(0));
        assert_eq!(nearest(&places, pos2(195.0, 75.0)), Some(1));
        assert_eq!(nearest(&places, pos2(20.0, 60.0)), None);
    }

    #[test]
    fn what_is_no_sweep_is_refused_with_a_sentence() {
        for (text, expected) in [
            ("{}", "is no sweep"),
            ("not JSON", "is no sweep"),
            (
                r#"{ "format": 7, "renderer": "a", "setting": "b", "values": [] }"#,
                "format 7",
            ),
        ] {
            let error = written(text).expect_err(text);
            assert!(
                error.contains(expected) && error.contains("sweep.json"),
                "{error}"
            );
        }
    }
}
