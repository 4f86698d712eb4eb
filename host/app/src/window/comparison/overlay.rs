//! Two views in one place: which part of whom is seen, the wipe's handle, and the legend of a difference.

use egui::{Color32, CursorIcon, Rect, Sense, Ui, pos2, vec2};
use pointstage_engine::frame::legend::{Legend, Scale, Stop};
use pointstage_engine::metrics::difference::AMPLIFICATION;
use pointstage_engine::metrics::flip::MAGMA;

use super::measurer::{SIGNED_FULL, signed_colour};
use super::{Measure, Way};

/// How far beside the handle it can be taken, points.
const REACH: f32 = 6.0;

/// Radius of the handle's knob, points.
const KNOB: f32 = 11.0;

/// The line between the two halves, with its handle; where it is to be, as a part of the width, if it was moved. Arrow keys
/// move it too while it has the keyboard.
pub(crate) fn wipe_handle_ui(ui: &mut Ui, view: Rect, wipe: f32) -> Option<f32> {
    let x = view.left() + view.width() * wipe;
    let zone = Rect::from_min_max(pos2(x - REACH, view.top()), pos2(x + REACH, view.bottom()));
    let id = ui.scope_id().with("wipe");
    let response = ui
        .interact(zone, id, Sense::click_and_drag())
        .on_hover_cursor(CursorIcon::ResizeHorizontal);
    response.widget_info(|| egui::WidgetInfo::slider(true, f64::from(wipe), "Wipe"));
    if response.is_pointer_button_down_on() {
        response.request_focus();
    }
    let painter = ui.painter_at(view);
    let line = [pos2(x, view.top()), pos2(x, view.bottom())];
    painter.line_segment(line, (3.0, Color32::BLACK));
    painter.line_segment(line, (1.0, Color32::WHITE));
    let middle = pos2(x, view.center().y);
    let fill = if response.hovered() || response.has_focus() {
        Color32::WHITE
    } else {
        Color32::from_gray(215)
    };
    painter.circle(middle, KNOB, fill, (1.5, Color32::BLACK));
    for side in [-1.0, 1.0] {
        let tip = middle + vec2(side * 7.0, 0.0);
        for end in [vec2(-side * 4.0, -4.0), vec2(-side * 4.0, 4.0)] {
            painter.line_segment([tip, tip + end], (1.5, Color32::BLACK));
        }
    }
    let by_keys = if response.has_focus() {
        ui.input_mut(|input| {
            let mut steps = 0.0;
            for (key, step) in [(egui::Key::ArrowLeft, -0.02), (egui::Key::ArrowRight, 0.02)] {
                steps += step * input.count_and_consume_key(egui::Modifiers::NONE, key) as f32;
            }
            steps
        })
    } else {
        0.0
    };
    let by_pointer = response
        .dragged()
        .then(|| response.interact_pointer_pos())
        .flatten()
        .map(|at| (at.x - view.left()) / view.width().max(1.0));
    let to = by_pointer.unwrap_or(wipe + by_keys).clamp(0.0, 1.0);
    (to != wipe).then_some(to)
}

/// What the colours of a difference mean.
pub(crate) fn difference_legend(way: Way) -> Option<Legend> {
    let Way::Difference(measure) = way else {
        return None;
    };
    let stop = |position: f32, colour: [u8; 3], label: String| Stop {
        position,
        colour,
        label,
    };
    let (title, stops) = match measure {
        Measure::Absolute => {
            let full = 255 / u32::from(AMPLIFICATION);
            let stops = vec![
                stop(0.0, [0; 3], "0".to_owned()),
                stop(1.0, [255; 3], format!("{full} of 255 and more")),
            ];
            ("Absolute difference of each channel", stops)
        }
        Measure::Signed => {
            let at = |part: f32| signed_colour(part);
            let full = SIGNED_FULL as u32;
            let stops = vec![
                stop(0.0, at(-1.0), format!("{full} darker")),
                stop(0.5, at(0.0), "equal".to_owned()),
                stop(1.0, at(1.0), format!("{full} brighter")),
            ];
            ("The view against the reference, of 255", stops)
        }
        Measure::Flip => {
            let last = MAGMA.len() - 1;
            let stops = MAGMA.iter().enumerate().map(|(index, colour)| {
                let label = match index {
                    0 => "0, nothing to be seen",
                    _ if index == last => "1",
                    _ => "",
                };
                stop(index as f32 / last as f32, *colour, label.to_owned())
            });
            ("FLIP: how visible the difference is", stops.collect())
        }
    };
    Some(Legend {
        title: title.to_owned(),
        scale: Scale::Ramp(stops),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_difference_has_a_legend_from_0_to_1() {
        for (way, name) in Way::ALL {
            let Some(legend) = difference_legend(way) else {
                assert!(!name.contains("ifference"), "{name}");
                continue;
            };
            let Scale::Ramp(stops) = legend.scale else {
                panic!("{name}: a ramp");
            };
            assert_eq!(stops.first().map(|stop| stop.position), Some(0.0), "{name}");
            assert_eq!(stops.last().map(|stop| stop.position), Some(1.0), "{name}");
            assert!(stops.is_sorted_by(|a, b| a.position < b.position), "{name}");
        }
    }
}
