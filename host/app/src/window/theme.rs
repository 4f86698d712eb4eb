//! Colours and spacing of the window, and the few widgets that carry them.

use egui::{Color32, Context, CornerRadius, RichText, Stroke, StrokeKind, Ui};
use pointstage_engine::stage::Severity;

use crate::preferences::TEXT_SCALE_RANGE;

/// Smallest text scale.
pub(crate) const SMALLEST: f32 = TEXT_SCALE_RANGE[0];

/// Largest text scale.
pub(crate) const LARGEST: f32 = TEXT_SCALE_RANGE[1];

/// The steps that keys and menu take.
pub(crate) const TEXT_SCALES: [f32; 7] = [SMALLEST, 0.9, 1.0, 1.25, 1.5, 1.75, LARGEST];

/// Sets the style of the light and the dark theme once, at start. Which of them is shown, the system says, or the Window menu.
pub(crate) fn apply(ctx: &egui::Context) {
    ctx.all_styles_mut(|style| {
        style.spacing.item_spacing = egui::vec2(8.0, 5.0);
        style.spacing.slider_width = 120.0;
        // The default greys are hard to read on a long day.
        let is_dark = style.visuals.dark_mode;
        style.visuals.widgets.noninteractive.fg_stroke.color =
            Color32::from_gray(if is_dark { 205 } else { 40 });
        style.visuals.weak_text_alpha = 0.75;
        if !is_dark {
            // Empty check boxes and white colours are hard to see on white.
            style.visuals.widgets.inactive.bg_fill = Color32::from_gray(190);
        }
        // Tooltips explain settings: they may be read in peace.
        style.interaction.tooltip_delay = 0.4;
    });
    // The toolkit's own keys would take Ctrl+0, which stores a view, and know no limits.
    ctx.options_mut(|options| options.zoom_with_keyboard = false);
}

/// Size of texts and widgets, as a factor of the usual.
pub(crate) fn text_scale(ctx: &Context) -> f32 {
    ctx.zoom_factor().clamp(SMALLEST, LARGEST)
}

/// Makes texts and widgets this large from the next pass on.
pub(crate) fn set_text_scale(ctx: &Context, scale: f32) {
    ctx.set_zoom_factor(scale.clamp(SMALLEST, LARGEST));
}

/// The next larger step, or the largest.
pub(crate) fn larger(scale: f32) -> f32 {
    let mut steps = TEXT_SCALES.into_iter();
    steps.find(|&step| step > scale).unwrap_or(LARGEST)
}

/// The next smaller step, or the smallest.
pub(crate) fn smaller(scale: f32) -> f32 {
    let mut steps = TEXT_SCALES.into_iter().rev();
    steps.find(|&step| step < scale).unwrap_or(SMALLEST)
}

/// Draws a frame around what has the keyboard, the same for every kind of widget: the toolkit's own sign of it is a thin line
/// that some widgets lack. `picture` has one of its own.
pub(crate) fn focus_frame_ui(ctx: &Context, picture: Option<egui::Id>) {
    let focused = ctx.memory(egui::Memory::focused);
    let Some(response) = focused
        .filter(|&id| Some(id) != picture)
        .and_then(|id| ctx.read_response(id))
    else {
        return;
    };
    let is_dark = ctx.global_style().visuals.dark_mode;
    let color = if is_dark {
        Color32::from_rgb(90, 170, 255)
    } else {
        Color32::from_rgb(0, 90, 180)
    };
    let painter = ctx.layer_painter(response.layer_id);
    painter
        .with_clip_rect(response.interact_rect.expand(4.0))
        .rect_stroke(
            response.rect.expand(2.0),
            CornerRadius::same(4),
            Stroke::new(2.0, color),
            StrokeKind::Middle,
        );
}

/// A severity as a word in its colour. Orange and blue stay apart for colour-blind eyes; the word says it too.
pub(crate) fn severity_label(ui: &mut Ui, severity: Severity) {
    let color = severity_color(ui, severity);
    ui.label(
        RichText::new(super::log::word(severity))
            .color(color)
            .strong(),
    );
}

/// The colour of a severity on the current theme.
pub(crate) fn severity_color(ui: &Ui, severity: Severity) -> Color32 {
    let is_dark = ui.visuals().dark_mode;
    match (severity, is_dark) {
        (Severity::Error, true) => Color32::from_rgb(255, 120, 90),
        (Severity::Error, false) => Color32::from_rgb(176, 32, 0),
        (Severity::Warning, true) => Color32::from_rgb(240, 190, 60),
        (Severity::Warning, false) => Color32::from_rgb(130, 86, 0),
        (Severity::Info, true) => Color32::from_rgb(120, 180, 255),
        (Severity::Info, false) => Color32::from_rgb(0, 84, 166),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_lead_from_end_to_end_and_stop_there() {
        let mut scale = SMALLEST;
        for _ in 0..20 {
            scale = larger(scale);
        }
        assert_eq!(scale, LARGEST);
        for _ in 0..20 {
            scale = smaller(scale);
        }
        assert_eq!(scale, SMALLEST);
        assert_eq!((larger(1.1), smaller(1.1)), (1.25, 1.0));
    }
}
