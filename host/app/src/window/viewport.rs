//! The picture, and the gestures over it.

use egui::{EventFilter, Key, Modifiers, PointerButton, Pos2, Rect, Sense, Ui};
use pointstage_engine::stage::Background;
use pointstage_plugin_api::abi::Interaction;

use super::canvas;
use super::intent::{CameraIntent, Intents};
use super::navigation::{CameraMove, KEY_TURN_RAD};
use super::picture::Layer;

/// One notch of the wheel (50 points) brings the scene 1.25 times nearer: exp(50 · 0.00446).
const ZOOM_PER_POINT: f64 = 0.004_46;

/// One press of + or − sees this many times as much.
const ZOOM_PER_KEY: f64 = 1.25;

/// What the viewport shows.
pub(crate) struct Viewport<'a> {
    /// Pictures, from back to front.
    pub(crate) layers: &'a [Layer],
    /// What lies behind them where they do not reach.
    pub(crate) background: Background,
}

/// What the viewport found out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ViewportAnswer {
    /// The picture's widget.
    pub(crate) id: egui::Id,
    /// Where it is, points.
    pub(crate) rect: Rect,
    /// Its size, px; at least 1.
    pub(crate) size_px: [u32; 2],
    /// What the user does with the camera.
    pub(crate) interaction: Interaction,
    /// Where the pointer rests over the picture, points.
    pub(crate) hovered_at: Option<Pos2>,
    /// Where the picture was clicked in this pass, points, and how often in a row.
    pub(crate) clicked_at: Option<(Pos2, Clicks)>,
}

/// How often was clicked in a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Clicks {
    /// Once.
    One,
    /// Twice.
    Two,
}

/// Fills what is left of the window with the picture, and turns gestures into moves.
pub(crate) fn viewport_ui(
    ui: &mut Ui,
    viewport: &Viewport<'_>,
    out: &mut Intents,
) -> ViewportAnswer {
    let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Picture"));
    if response.clicked() || response.drag_started() {
        response.request_focus();
    }
    paint(ui, rect, viewport, response.has_focus());
    let pixels_per_point = ui.ctx().pixels_per_point();
    let to_px = |points: f32| ((points * pixels_per_point).round() as u32).max(1);
    let moved = drag_moves(ui, &response, rect, out) | wheel_moves(ui, &response, rect, out);
    if response.has_focus() {
        key_moves(ui, response.id, out);
    }
    let clicks = if response.double_clicked() {
        Some(Clicks::Two)
    } else {
        response.clicked().then_some(Clicks::One)
    };
    ViewportAnswer {
        hovered_at: response.hover_pos().filter(|_| !response.dragged()),
        clicked_at: response.interact_pointer_pos().zip(clicks),
        id: response.id,
        rect,
        size_px: [to_px(rect.width()), to_px(rect.height())],
        interaction: if moved {
            Interaction::MOVING
        } else if response.dragged() {
            Interaction::HELD
        } else {
            Interaction::STILL
        },
    }
}

fn paint(ui: &Ui, rect: Rect, viewport: &Viewport<'_>, has_focus: bool) {
    let painter = ui.painter_at(rect);
    canvas::paint(&painter, rect, viewport.background, viewport.layers);
    if has_focus {
        let stroke = ui.visuals().selection.stroke;
        painter.rect_stroke(rect, 0.0, (1.0, stroke.color), egui::StrokeKind::Inside);
    }
}

/// Left drag turns, middle drag and Shift+left drag shift. True if the camera moves.
fn drag_moves(ui: &Ui, response: &egui::Response, rect: Rect, out: &mut Intents) -> bool {
    let delta = response.drag_delta();
    if delta == egui::Vec2::ZERO {
        return false;
    }
    let height = f64::from(rect.height().max(1.0));
    let (right, up) = (f64::from(delta.x) / height, -f64::from(delta.y) / height);
    let is_shift = ui.input(|input| input.modifiers.shift);
    let is_left = response.dragged_by(PointerButton::Primary);
    let is_pan = response.dragged_by(PointerButton::Middle) || (is_left && is_shift);
    if is_pan {
        out.push(CameraIntent::Move(CameraMove::Pan { right, up }));
    } else if is_left {
        out.push(CameraIntent::Move(CameraMove::Drag { right, up }));
    }
    is_pan || is_left
}

/// The wheel and the pinch zoom to the pointer. True if the camera moves.
fn wheel_moves(ui: &Ui, response: &egui::Response, rect: Rect, out: &mut Intents) -> bool {
    let Some(pointer) = response.hover_pos() else {
        return false;
    };
    let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
    let factor = (-f64::from(scroll) * ZOOM_PER_POINT).exp() / f64::from(pinch);
    if factor == 1.0 {
        return false;
    }
    let from_middle = (pointer - rect.center()) / rect.height().max(1.0);
    out.push(CameraIntent::Move(CameraMove::Zoom {
        factor,
        right: f64::from(from_middle.x),
        up: -f64::from(from_middle.y),
    }));
    true
}

/// Arrow keys turn, with Shift they shift; + and − zoom.
fn key_moves(ui: &Ui, id: egui::Id, out: &mut Intents) {
    let filter = EventFilter {
        horizontal_arrows: true,
        vertical_arrows: true,
        ..EventFilter::default()
    };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(id, filter));
    let arrows = [
        (Key::ArrowLeft, -1.0, 0.0),
        (Key::ArrowRight, 1.0, 0.0),
        (Key::ArrowUp, 0.0, 1.0),
        (Key::ArrowDown, 0.0, -1.0),
    ];
    for (key, right, up) in arrows {
        if ui.input_mut(|input| input.consume_key(Modifiers::SHIFT, key)) {
            out.push(CameraIntent::Move(CameraMove::Pan {
                right: right * 0.05,
                up: up * 0.05,
            }));
        } else if ui.input_mut(|input| input.consume_key(Modifiers::NONE, key)) {
            out.push(CameraIntent::Move(CameraMove::Turn {
                yaw_rad: right * KEY_TURN_RAD,
                pitch_rad: up * KEY_TURN_RAD,
            }));
        }
    }
    let zooms = [
        (Key::Plus, 1.0 / ZOOM_PER_KEY),
        (Key::Equals, 1.0 / ZOOM_PER_KEY),
        (Key::Minus, ZOOM_PER_KEY),
    ];
    for (key, factor) in zooms {
        if ui.input(|input| input.key_pressed(key) && input.modifiers.is_none()) {
            out.push(CameraIntent::Move(CameraMove::Zoom {
                factor,
                right: 0.0,
                up: 0.0,
            }));
        }
    }
}
