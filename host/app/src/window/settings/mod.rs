//! The settings panel: one file a tab.
//!
//! Each tab reads what it shows and pushes intents. [`schema`] makes widgets from a renderer's schema; the other tabs are
//! written by hand.

pub(super) mod lighting;
pub(super) mod plugins;
pub(super) mod renderer;
pub(super) mod scene;
pub(super) mod schema;
pub(super) mod view;

#[cfg(test)]
mod tests;

use super::intent::{Intent, Intents, Tab};

/// The tabs with their names, in order.
const TABS: [(Tab, &str); 5] = [
    (Tab::Renderer, "Renderer"),
    (Tab::Lighting, "Lighting"),
    (Tab::View, "View"),
    (Tab::Scene, "Scene"),
    (Tab::Plugins, "Plugins"),
];

/// Width of a row's label, points.
const LABEL_WIDTH: f32 = 108.0;

/// The row of tabs.
pub(super) fn tabs_ui(ui: &mut egui::Ui, chosen: Tab, out: &mut Intents) {
    ui.horizontal_wrapped(|ui| {
        for (tab, name) in TABS {
            if ui.selectable_label(tab == chosen, name).clicked() {
                out.push(Intent::ChooseTab(tab));
            }
        }
    });
    ui.separator();
}

/// A row of a form: a label that names the widget for keyboard and screen reader, then the widget.
fn row(ui: &mut egui::Ui, label: &str, help: &str, add: impl FnOnce(&mut egui::Ui)) {
    ui.horizontal(|ui| {
        let width = LABEL_WIDTH;
        let response = ui
            .allocate_ui_with_layout(
                egui::vec2(width, ui.spacing().interact_size.y),
                egui::Layout::left_to_right(egui::Align::Center).with_main_wrap(true),
                |ui| {
                    ui.set_width(width);
                    ui.label(label)
                },
            )
            .inner;
        let named = if help.is_empty() {
            response
        } else {
            response.on_hover_text(help)
        };
        ui.label_inputs_by(named.id, add);
    });
}
