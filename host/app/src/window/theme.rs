//! Colours and spacing of the window, and the few widgets that carry them.

use egui::{Color32, RichText, Ui};
use pointstage_engine::stage::Severity;

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
