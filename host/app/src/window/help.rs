//! The dialogs of the Help menu.

use egui::{Align2, Context, Grid, ScrollArea, Window};

use super::intent::{Intent, Intents, Part};
use super::shortcuts;

/// The list of keys and mouse actions.
pub(crate) fn keys_ui(ctx: &Context, out: &mut Intents) {
    let mut is_open = true;
    Window::new("Keys and mouse")
        .open(&mut is_open)
        .anchor(Align2::CENTER_CENTER, egui::Vec2::ZERO)
        .auto_sized()
        .collapsible(false)
        .show(ctx, |ui| {
            // All of them, unless the window is lower than the list.
            let height = ctx.content_rect().height() - 80.0;
            ScrollArea::vertical().max_height(height).show(ui, |ui| {
                Grid::new("keys")
                    .striped(true)
                    .num_columns(2)
                    .show(ui, |ui| {
                        for (keys, action) in shortcuts::LIST {
                            ui.strong(keys);
                            ui.label(action);
                            ui.end_row();
                        }
                    });
            });
        });
    if !is_open {
        out.push(Intent::Toggle(Part::Keys));
    }
}

/// Versions and adapter, to copy into a report.
pub(crate) fn about_ui(ctx: &Context, facts: &[(String, String)], out: &mut Intents) {
    let mut is_open = true;
    Window::new("About Pointstage")
        .open(&mut is_open)
        .anchor(Align2::CENTER_CENTER, egui::Vec2::ZERO)
        .resizable(false)
        .collapsible(false)
        .show(ctx, |ui| {
            ui.label("A stage on which point-based renderers perform.");
            Grid::new("about").num_columns(2).show(ui, |ui| {
                for (name, value) in facts {
                    ui.label(name);
                    ui.monospace(value);
                    ui.end_row();
                }
            });
            if ui.button("Copy").clicked() {
                let lines = facts
                    .iter()
                    .map(|(name, value)| format!("{name}: {value}\n"));
                out.push(Intent::Copy(lines.collect()));
            }
        });
    if !is_open {
        out.push(Intent::Toggle(Part::About));
    }
}
