//! What the pictures of each view cost: a plot of the last seconds, medians, and memory.

use std::time::{Duration, Instant};

use egui::{Align2, Color32, FontId, Grid, Rect, Sense, Stroke, Ui, pos2, vec2};

use super::frame_log::{FrameCost, FrameLog, SPAN, Spread};

/// Size of a plot, points.
const PLOT: [f32; 2] = [300.0, 84.0];

/// Colours of the three parts, of Okabe and Ito's palette.
const TOTAL: Color32 = Color32::from_rgb(0x56, 0xb4, 0xe9);
const CPU: Color32 = Color32::from_rgb(0xe6, 0x9f, 0x00);
const DEVICE: Color32 = Color32::from_rgb(0x00, 0x9e, 0x73);

/// A part of what a picture took.
type Part = fn(&FrameCost) -> Duration;

/// The plot and the numbers of one view.
pub(crate) fn times_ui(ui: &mut Ui, title: &str, log: &FrameLog, now: Instant) {
    ui.strong(title);
    let Some(last) = log.last() else {
        ui.weak("no picture yet");
        return;
    };
    plot_ui(ui, log, now);
    Grid::new(("times", title))
        .num_columns(3)
        .striped(true)
        .show(ui, |ui| {
            ui.label("");
            ui.label("median");
            ui.label("95 %");
            ui.end_row();
            let parts: [(&str, Color32, Part); 3] = [
                ("whole picture", TOTAL, |cost| cost.total),
                ("renderer on the CPU", CPU, |cost| cost.cpu),
                ("device, by wall clock", DEVICE, |cost| cost.device),
            ];
            for (name, colour, part) in parts {
                if let Some(spread) = log.spread(part) {
                    spread_ui(ui, name, Some(colour), spread);
                }
            }
            for (name, spread) in log.passes() {
                spread_ui(ui, &format!("pass {name}"), None, spread);
            }
        });
    let [plugin, scene, targets] = last.bytes.map(megabytes);
    ui.label(format!(
        "On the device: renderer {plugin}, view's targets {targets}; the scene, held once for all views, {scene}"
    ));
}

fn spread_ui(ui: &mut Ui, name: &str, colour: Option<Color32>, spread: Spread) {
    ui.horizontal(|ui| {
        if let Some(colour) = colour {
            let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
            ui.painter().rect_filled(rect, 2.0, colour);
        }
        ui.label(name);
    });
    ui.monospace(millis(spread.median));
    ui.monospace(millis(spread.p95));
    ui.end_row();
}

fn plot_ui(ui: &mut Ui, log: &FrameLog, now: Instant) {
    let (rect, response) = ui.allocate_exact_size(vec2(PLOT[0], PLOT[1]), Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Frame times"));
    let visuals = ui.visuals();
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 2.0, visuals.extreme_bg_color);
    let greatest = log.frames(now).map(|(_, cost)| cost.total).max();
    let top = round_up(greatest.unwrap_or_default().as_secs_f32() * 1e3);
    let parts: [(Color32, Part); 3] = [
        (DEVICE, |cost| cost.device),
        (CPU, |cost| cost.cpu),
        (TOTAL, |cost| cost.total),
    ];
    for (colour, part) in parts {
        for (age, cost) in log.frames(now) {
            let place = place_of(rect, age, part(cost), top);
            painter.circle_filled(place, 1.8, colour);
            let foot = pos2(place.x, rect.bottom());
            painter.line_segment([foot, place], Stroke::new(0.5, colour.gamma_multiply(0.35)));
        }
    }
    let font = FontId::proportional(10.0);
    let colour = visuals.weak_text_color();
    let texts = [
        (rect.left_top(), Align2::LEFT_TOP, format!("{top} ms")),
        (
            rect.left_bottom(),
            Align2::LEFT_BOTTOM,
            format!("{} s ago", SPAN.as_secs()),
        ),
        (rect.right_bottom(), Align2::RIGHT_BOTTOM, "now".to_owned()),
    ];
    for (at, align, text) in texts {
        painter.text(at, align, text, font.clone(), colour);
    }
}

/// Where a picture stands in the plot: the newest right, the longest at the top.
fn place_of(rect: Rect, age: Duration, time: Duration, top_ms: f32) -> egui::Pos2 {
    let age = (age.as_secs_f32() / SPAN.as_secs_f32()).min(1.0);
    let height = (time.as_secs_f32() * 1e3 / top_ms).min(1.0);
    pos2(
        rect.right() - age * rect.width(),
        rect.bottom() - height * rect.height(),
    )
}

/// The next of 1, 2 and 5 times a power of ten, at least 1.
fn round_up(value: f32) -> f32 {
    let power = 10.0_f32.powf(value.max(1.0).log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|step| step * power)
        .find(|step| *step >= value)
        .unwrap_or(10.0 * power)
}

fn millis(time: Duration) -> String {
    format!("{:.1} ms", time.as_secs_f64() * 1e3)
}

fn megabytes(bytes: u64) -> String {
    format!("{:.1} MB", bytes as f64 / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_ends_at_a_round_number_above_all() {
        for (value, top) in [
            (0.0, 1.0),
            (1.0, 1.0),
            (1.2, 2.0),
            (33.0, 50.0),
            (99.0, 100.0),
            (101.0, 200.0),
        ] {
            assert_eq!(round_up(value), top, "{value}");
        }
    }

    #[test]
    fn new_pictures_stand_right_and_slow_ones_above() {
        let rect = Rect::from_min_size(pos2(10.0, 20.0), vec2(100.0, 50.0));
        let millis = Duration::from_millis;
        assert_eq!(
            place_of(rect, millis(0), millis(50), 100.0),
            pos2(110.0, 45.0)
        );
        assert_eq!(place_of(rect, SPAN, millis(500), 100.0), pos2(10.0, 20.0));
    }
}
