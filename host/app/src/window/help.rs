//! The dialogs of the Help menu.

use egui::{Align2, Context, Grid, ScrollArea, Window};

use super::actions::{self, Action, shortcut_text};
use super::intent::{Intents, Part, WindowIntent};

/// The list of keys and mouse actions.
pub(crate) fn keys_ui(ctx: &Context, all: &[Action], out: &mut Intents) {
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
                        for (keys, act) in actions::gestures() {
                            ui.strong(keys);
                            ui.label(act);
                            ui.end_row();
                        }
                        for action in all.iter().filter(|action| !action.keys.is_empty()) {
                            ui.strong(all_keys(ctx, action));
                            ui.label(in_full(action));
                            ui.end_row();
                        }
                    });
            });
        });
    if !is_open {
        out.push(WindowIntent::Toggle(Part::Keys));
    }
}

/// All keys of an action.
fn all_keys(ctx: &Context, action: &Action) -> String {
    let keys = action.keys.iter();
    let texts: Vec<String> = keys.map(|keys| shortcut_text(ctx, keys.shortcut)).collect();
    texts.join(", ")
}

/// An action's title, with its submenu's, which says what a short one is about.
pub(crate) fn in_full(action: &Action) -> String {
    let Action { title, place, .. } = action;
    if place.submenu.is_empty() {
        title.clone()
    } else {
        format!("{}: {title}", place.submenu)
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
                out.push(WindowIntent::Copy(lines.collect()));
            }
        });
    if !is_open {
        out.push(WindowIntent::Toggle(Part::About));
    }
}
