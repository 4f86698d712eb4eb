//! The newest messages, over the picture.

use std::time::Instant;

use egui::{Align2, Area, Frame, Id, Order, vec2};

use super::intent::{Intents, Part, WindowIntent};
use super::log::Log;
use super::theme;

/// Toasts shown at once; the rest waits in the log.
const MOST: usize = 3;

/// Width of a toast, points.
const WIDTH: f32 = 380.0;

/// Shows the newest messages in the corner of `over`, above one another.
pub(crate) fn toasts_ui(ctx: &egui::Context, over: egui::Rect, log: &Log, out: &mut Intents) {
    let now = Instant::now();
    let mut toasts: Vec<_> = log.toasts(now).collect();
    let hidden = toasts.len().saturating_sub(MOST);
    toasts.truncate(MOST);
    if toasts.is_empty() {
        return;
    }
    let corner = over.right_bottom() - vec2(12.0, 12.0);
    Area::new(Id::unique("toasts"))
        .order(Order::Foreground)
        .pivot(Align2::RIGHT_BOTTOM)
        .fixed_pos(corner)
        .show(ctx, |ui| {
            ui.set_width(WIDTH.min(over.width() - 24.0));
            for entry in toasts.into_iter().rev() {
                let notice = &entry.notice;
                Frame::popup(ui.style()).show(ui, |ui| {
                    ui.set_width(ui.available_width());
                    ui.horizontal(|ui| {
                        theme::severity_label(ui, notice.severity);
                        if !notice.plugin.is_empty() {
                            ui.strong(&notice.plugin);
                        }
                        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                            let close = ui.small_button("×").on_hover_text("Dismiss");
                            let close = close.accessible_name("Dismiss");
                            if close.clicked() {
                                out.push(WindowIntent::Dismiss(entry.id));
                            }
                            if ui.small_button("Copy").clicked() {
                                out.push(WindowIntent::Copy(entry.as_text()));
                            }
                            if !notice.detail.is_empty() && ui.small_button("Details").clicked() {
                                out.push(WindowIntent::Dismiss(entry.id));
                                out.push(WindowIntent::Toggle(Part::Log));
                            }
                        });
                    });
                    ui.label(&notice.text);
                    if let Some(offer) = &entry.offer
                        && ui.button(offer.label).clicked()
                    {
                        out.push(offer.intent.clone());
                        out.push(WindowIntent::Dismiss(entry.id));
                    }
                });
            }
            if hidden > 0
                && ui
                    .small_button(format!("{hidden} more in the log"))
                    .clicked()
            {
                out.push(WindowIntent::Toggle(Part::Log));
            }
        });
}
