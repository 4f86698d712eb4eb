//! The picture, and the gestures over it.

use egui::{Pos2, Rect, Sense, Ui};
use pointstage_engine::stage::Background;
use pointstage_plugin_api::abi::Interaction;

use super::canvas;
use super::comparison::Zoom;
use super::comparison::zoom::part_of;
use super::intent::{CompareIntent, Intents};
use super::navigation::{Gestures, Hands, NavigationOptions, gestures};
use super::picture::Layer;
use super::selecting::Tool;

/// How much a turn of the wheel enlarges, per point: a notch of 50 points by a quarter.
const ZOOM_PER_POINT: f32 = 0.004_46;

/// What the viewport shows.
pub(crate) struct Viewport<'a> {
    /// Pictures, from back to front.
    pub(crate) layers: &'a [Layer],
    /// What lies behind them where they do not reach.
    pub(crate) background: Background,
    /// How the camera answers to gestures.
    pub(crate) navigation: &'a NavigationOptions,
    /// Whether the camera moves by itself.
    pub(crate) is_moving: bool,
    /// The part of the picture that is shown enlarged.
    pub(crate) zoom: Option<Zoom>,
    /// What a left drag does.
    pub(crate) tool: Tool,
}

impl ViewportAnswer {
    /// The same place without what the user does there.
    pub(crate) fn still(self) -> Self {
        Self {
            interaction: Interaction::STILL,
            is_flying: false,
            hovered_at: None,
            clicked_at: None,
            ..self
        }
    }
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
    /// Whether letters fly, since the right button is held.
    pub(crate) is_flying: bool,
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
    if response.clicked() || response.secondary_clicked() || response.drag_started() {
        response.request_focus();
    }
    paint(ui, rect, viewport, response.has_focus());
    let pixels_per_point = ui.ctx().pixels_per_point();
    let to_px = |points: f32| ((points * pixels_per_point).round() as u32).max(1);
    let picture = Gestures {
        response: &response,
        rect,
        options: viewport.navigation,
        is_moving: viewport.is_moving,
        tool: viewport.tool,
    };
    // With Alt the picture itself is moved and enlarged, not the camera.
    let Hands {
        interaction,
        is_flying,
    } = if ui.input(|input| input.modifiers.alt) {
        zoom_gestures(ui, &response, rect, out);
        Hands {
            interaction: Interaction::STILL,
            is_flying: false,
        }
    } else {
        gestures(ui, &picture, out)
    };
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
        interaction,
        is_flying,
    }
}

/// Alt and the wheel enlarge the pixels under the pointer, Alt and a drag move the enlarged part.
fn zoom_gestures(ui: &Ui, response: &egui::Response, rect: Rect, out: &mut Intents) {
    let scroll = ui.input(egui::InputState::smooth_scroll_delta);
    // The system may turn a wheel with Alt sideways.
    let turned = scroll.y + scroll.x;
    if let Some(pointer) = response.hover_pos().filter(|_| turned != 0.0) {
        let by = (turned * ZOOM_PER_POINT).exp();
        out.push(CompareIntent::Zoom(by, part_of(rect, pointer)));
    }
    let delta = response.drag_delta() / rect.size().max(egui::Vec2::splat(1.0));
    if delta != egui::Vec2::ZERO {
        out.push(CompareIntent::ShiftZoom([delta.x, delta.y]));
    }
}

fn paint(ui: &Ui, rect: Rect, viewport: &Viewport<'_>, has_focus: bool) {
    let painter = ui.painter_at(rect);
    canvas::paint(
        &painter,
        rect,
        viewport.background,
        viewport.layers,
        viewport.zoom,
    );
    if has_focus {
        let stroke = ui.visuals().selection.stroke;
        painter.rect_stroke(rect, 0.0, (1.0, stroke.color), egui::StrokeKind::Inside);
    }
}
