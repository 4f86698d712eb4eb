//! The *Renderer* tab: which renderer draws, and its settings.

use egui::{RichText, ScrollArea, Ui};
use pointstage_engine::plugins::Remedy;
use pointstage_plugin_api::settings_schema::SettingValues;

use super::schema::schema_ui;
use crate::window::intent::{Intents, RendererIntent, SceneIntent};
use crate::window::rows::RendererRow;
use crate::window::theme;

/// What the tab shows.
pub(crate) struct RendererTab<'a> {
    /// Every renderer found, in order.
    pub(crate) renderers: &'a [RendererRow],
    /// Every structure found, in order.
    pub(crate) structures: &'a [RendererRow],
    /// The chosen renderer's id.
    pub(crate) chosen: &'a str,
    /// The chosen structure's id.
    pub(crate) chosen_structure: Option<&'a str>,
    /// The renderer that drew the last picture.
    pub(crate) drawn_by: Option<&'a str>,
    /// The chosen renderer's values where they differ from the defaults.
    pub(crate) values: &'a SettingValues,
}

/// The tab.
pub(crate) fn renderer_ui(ui: &mut Ui, tab: &RendererTab<'_>, out: &mut Intents) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        list_ui(ui, tab, out);
        structures_ui(ui, tab, out);
        ui.separator();
        let Some(chosen) = tab.renderers.iter().find(|row| row.id == tab.chosen) else {
            ui.weak("The chosen renderer is not there any more. Choose another one above.");
            return;
        };
        ui.horizontal(|ui| {
            ui.heading(&chosen.title);
            if !tab.values.is_empty() {
                let reset = ui.small_button("Reset all");
                if reset
                    .on_hover_text("Give every setting its default")
                    .clicked()
                {
                    out.push(RendererIntent::ResetAll);
                }
            }
        });
        ui.push_id(&chosen.id, |ui| {
            schema_ui(ui, &chosen.settings, tab.values, out);
        });
    });
}

fn list_ui(ui: &mut Ui, tab: &RendererTab<'_>, out: &mut Intents) {
    if tab.renderers.is_empty() {
        ui.label("No renderer plugin was found, so the built-in fallback draws. Build the plugins beside the program, or name one with --plugin FILE.");
    }
    for row in tab.renderers {
        let is_chosen = row.id == tab.chosen;
        ui.push_id(&row.id, |ui| {
            // A chosen renderer that has become unsuitable stays readable: the scene may change again.
            let is_enabled = row.obstacle.is_none() || is_chosen;
            let radio = ui
                .add_enabled(is_enabled, egui::RadioButton::new(is_chosen, &row.title))
                .on_hover_text(&row.about);
            let radio = match &row.obstacle {
                Some(obstacle) => radio.on_disabled_hover_text(&obstacle.reason),
                None => radio,
            };
            if radio.clicked() && !is_chosen {
                out.push(RendererIntent::Choose(row.id.clone()));
            }
            if let Some(obstacle) = &row.obstacle {
                ui.indent("obstacle", |ui| {
                    ui.label(RichText::new(&obstacle.reason).weak());
                    if let Some(remedy) = obstacle.remedy
                        && ui.button(remedy_text(remedy)).clicked()
                    {
                        out.push(SceneIntent::Estimate);
                    }
                });
            } else if is_chosen {
                drawn_by_ui(ui, tab);
            }
        });
    }
}

fn remedy_text(remedy: Remedy) -> &'static str {
    match remedy {
        Remedy::EstimateNormals => "Estimate normals",
        Remedy::EstimateRadii => "Estimate radii",
        Remedy::EstimateNormalsAndRadii => "Estimate normals and radii",
    }
}

/// Says so when another renderer than the chosen one drew the picture.
fn drawn_by_ui(ui: &mut Ui, tab: &RendererTab<'_>) {
    let Some(drawn_by) = tab.drawn_by.filter(|&id| id != tab.chosen) else {
        return;
    };
    let title = tab
        .renderers
        .iter()
        .find(|row| row.id == drawn_by)
        .map_or(drawn_by, |row| &row.title);
    ui.indent("drawn_by", |ui| {
        let color = theme::severity_color(ui, pointstage_engine::stage::Severity::Warning);
        ui.colored_label(color, format!("The picture is by {title} meanwhile."));
    });
}

fn structures_ui(ui: &mut Ui, tab: &RendererTab<'_>, out: &mut Intents) {
    if tab.structures.is_empty() {
        return;
    }
    super::row(
        ui,
        "Level of detail",
        "Which structure selects the surfels to draw",
        |ui| {
            let chosen = tab.chosen_structure;
            let row_of = |id| tab.structures.iter().find(|row| row.id == id);
            let title = chosen.map_or("none: every surfel", |id| {
                row_of(id).map_or(id, |row| row.title.as_str())
            });
            egui::ComboBox::from_id_salt("structure")
                .selected_text(title)
                .show_ui(ui, |ui| {
                    if ui
                        .selectable_label(chosen.is_none(), "none: every surfel")
                        .clicked()
                    {
                        out.push(RendererIntent::ChooseStructure(None));
                    }
                    for row in tab.structures {
                        let is_chosen = chosen == Some(row.id.as_str());
                        let label = ui.selectable_label(is_chosen, &row.title);
                        if label.on_hover_text(&row.about).clicked() {
                            out.push(RendererIntent::ChooseStructure(Some(row.id.clone())));
                        }
                    }
                });
        },
    );
}
