//! The settings panel: one file a tab.
//!
//! Each tab reads what it shows and pushes intents. [`schema`] makes widgets from a renderer's schema; the other tabs are
//! written by hand.

pub(super) mod camera;
pub(super) mod compare;
mod estimate;
pub(super) mod lighting;
mod material;
mod objects;
pub(super) mod pacing;
pub(super) mod plugins;
mod presets;
pub(super) mod renderer;
pub(super) mod scene;
pub(super) mod schema;
mod value;
pub(super) mod view;
pub(super) mod view_list;

#[cfg(test)]
mod tests;

use super::intent::{Intents, Tab, WindowIntent};

/// The tabs with their names, in order.
const TABS: [(Tab, &str); 6] = [
    (Tab::Renderer, "Renderer"),
    (Tab::Lighting, "Lighting"),
    (Tab::View, "View"),
    (Tab::Compare, "Compare"),
    (Tab::Scene, "Scene"),
    (Tab::Plugins, "Plugins"),
];

/// Width of a row's label, points.
const LABEL_WIDTH: f32 = 96.0;

/// Width kept free at a row's end for 'reset', points: what is edited must not change the panel's width.
const RESET_WIDTH: f32 = 46.0;

/// Width of the number beside a slider, points: `16.00 px`.
const NUMBER_WIDTH: f32 = 66.0;

/// The least width of a slider, points.
const LEAST_SLIDER_WIDTH: f32 = 40.0;

/// The row of tabs.
pub(super) fn tabs_ui(ui: &mut egui::Ui, chosen: Tab, out: &mut Intents) {
    ui.add_space(4.0);
    ui.horizontal_wrapped(|ui| {
        // All of them in one row of a panel of the usual width.
        ui.spacing_mut().item_spacing.x = 1.0;
        ui.spacing_mut().button_padding.x = 5.0;
        for (tab, name) in TABS {
            let label = ui.selectable_label(tab == chosen, name);
            ui.ctx()
                .accesskit_node_builder(label.id, |node| node.set_role(egui::Role::Tab));
            if label.clicked() {
                out.push(WindowIntent::ChooseTab(tab));
            }
        }
    });
    ui.separator();
}

/// What a tab holds. It scrolls both ways, so that its width never is more than the panel's: a panel grows with what does
/// not fit, its rows grow with the panel, and so on until no room is left for the picture.
fn tab_ui(ui: &mut egui::Ui, add: impl FnOnce(&mut egui::Ui)) {
    egui::ScrollArea::both().auto_shrink(false).show(ui, add);
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
        let gap = ui.spacing().item_spacing.x;
        let widget_width = ui.available_width() - RESET_WIDTH - gap;
        ui.spacing_mut().combo_width = widget_width;
        ui.spacing_mut().text_edit_width = widget_width;
        set_slider_width(ui, widget_width - NUMBER_WIDTH - gap);
        ui.label_inputs_by(named.id, add);
    });
}

/// Lets sliders in `ui` be so wide, within reason.
fn set_slider_width(ui: &mut egui::Ui, width: f32) {
    ui.spacing_mut().slider_width = width.max(LEAST_SLIDER_WIDTH);
}
