//! The picture, and the gestures over it.

use egui::{Color32, Pos2, Rect, Sense, TextureId, Ui, pos2};
use pointstage_plugin_api::abi::Interaction;

use super::intent::Intents;
use super::navigation::{Gestures, Hands, NavigationOptions, gestures};

/// Side of the squares behind a transparent picture, points.
const CHECKER: f32 = 12.0;

/// What the viewport shows.
pub(crate) struct Viewport<'a> {
    /// The picture, if there is one.
    pub(crate) picture: Option<TextureId>,
    /// Whether the picture may be see-through.
    pub(crate) is_transparent: bool,
    /// How the camera answers to gestures.
    pub(crate) navigation: &'a NavigationOptions,
    /// Whether the camera moves by itself.
    pub(crate) is_moving: bool,
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
    };
    let Hands {
        interaction,
        is_flying,
    } = gestures(ui, &picture, out);
    ViewportAnswer {
        id: response.id,
        rect,
        size_px: [to_px(rect.width()), to_px(rect.height())],
        interaction,
        is_flying,
    }
}

fn paint(ui: &Ui, rect: Rect, viewport: &Viewport<'_>, has_focus: bool) {
    let painter = ui.painter_at(rect);
    if viewport.is_transparent {
        paint_checkers(&painter, rect);
    }
    if let Some(picture) = viewport.picture {
        let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
        painter.image(picture, rect, whole, Color32::WHITE);
    }
    if has_focus {
        let stroke = ui.visuals().selection.stroke;
        painter.rect_stroke(rect, 0.0, (1.0, stroke.color), egui::StrokeKind::Inside);
    }
}

/// The squares that stand for transparency.
fn paint_checkers(painter: &egui::Painter, rect: Rect) {
    painter.rect_filled(rect, 0.0, Color32::from_gray(110));
    let columns = (rect.width() / CHECKER).ceil() as usize;
    let rows = (rect.height() / CHECKER).ceil() as usize;
    for row in 0..rows {
        for column in (row % 2..columns).step_by(2) {
            let corner = rect.min + egui::vec2(column as f32, row as f32) * CHECKER;
            let square = Rect::from_min_size(corner, egui::Vec2::splat(CHECKER));
            painter.rect_filled(square, 0.0, Color32::from_gray(140));
        }
    }
}
