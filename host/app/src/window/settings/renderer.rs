//! The *Renderer* tab: which renderers draw, and their settings.

use egui::{Button, ComboBox, RichText, Ui};
use pointstage_engine::plugins::Remedy;
use pointstage_engine::stage::Severity;
use pointstage_plugin_api::settings_schema::SettingValues;

use super::presets::{copy_ui, presets_ui};
use super::schema::{Owner, SchemaPanel, schema_ui};
use crate::window::intent::{Intents, RendererIntent, SceneIntent};
use crate::window::presets::PresetList;
use crate::window::recommend::Recommendation;
use crate::window::rows::{Obstacle, RendererRow, Rows};
use crate::window::theme;

/// What the list of preview renderers offers first.
const NO_PREVIEW: &str = "None: the main renderer draws moving pictures too";

/// What the tab shows.
pub(crate) struct RendererTab<'a> {
    /// Every renderer and structure found, and which are recommended.
    pub(crate) rows: &'a Rows,
    /// The main renderer's id.
    pub(crate) chosen: &'a str,
    /// The preview renderer's id.
    pub(crate) preview: Option<&'a str>,
    /// The chosen structure's id.
    pub(crate) chosen_structure: Option<&'a str>,
    /// The renderer that drew the last picture.
    pub(crate) drawn_by: Option<&'a str>,
    /// The main renderer's values where they differ from the defaults.
    pub(crate) values: &'a SettingValues,
    /// The structure's values where they differ from the defaults.
    pub(crate) structure_values: &'a SettingValues,
    /// The main renderer's presets.
    pub(crate) presets: &'a PresetList,
    /// The setting that shall have the keyboard now.
    pub(crate) focus: Option<&'a str>,
}

/// The tab.
pub(crate) fn renderer_ui(ui: &mut Ui, tab: &RendererTab<'_>, out: &mut Intents) {
    super::tab_ui(ui, |ui| {
        list_ui(ui, tab, out);
        preview_ui(ui, tab, out);
        structures_ui(ui, tab, out);
        ui.separator();
        let Some(chosen) = tab.rows.renderer(tab.chosen) else {
            ui.weak("The chosen renderer is not there any more. Choose another one above.");
            return;
        };
        settings_ui(ui, tab, chosen, out);
    });
}

fn list_ui(ui: &mut Ui, tab: &RendererTab<'_>, out: &mut Intents) {
    let renderers = &tab.rows.renderers;
    if renderers.is_empty() {
        ui.label("No renderer plugin was found, so the built-in fallback draws. Build the plugins beside the program, or name one with --plugin FILE.");
    }
    for row in renderers {
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
            if let Some(why) = reason_for(tab.rows.recommended.as_ref(), row) {
                ui.indent("recommended", |ui| recommended_ui(ui, why));
            }
            if let Some(obstacle) = &row.obstacle {
                ui.indent("obstacle", |ui| obstacle_ui(ui, obstacle, out));
            } else if is_chosen {
                drawn_by_ui(ui, tab);
            }
        });
    }
}

/// Why this renderer is the recommended one, if it is.
fn reason_for<'a>(found: Option<&'a Recommendation>, row: &RendererRow) -> Option<&'a str> {
    let found = found.filter(|found| found.id == row.id)?;
    Some(&found.why)
}

fn recommended_ui(ui: &mut Ui, why: &str) {
    ui.label(RichText::new(format!("Recommended: {why}.")).weak());
}

/// Why it cannot draw, with a button where the program can help.
fn obstacle_ui(ui: &mut Ui, obstacle: &Obstacle, out: &mut Intents) {
    ui.label(RichText::new(&obstacle.reason).weak());
    if let Some(remedy) = obstacle.remedy
        && ui.button(remedy_text(remedy)).clicked()
    {
        out.push(SceneIntent::Estimate);
    }
}

fn remedy_text(remedy: Remedy) -> &'static str {
    match remedy {
        Remedy::EstimateNormals => "Estimate normals",
        Remedy::EstimateRadii => "Estimate radii",
        Remedy::EstimateNormalsAndRadii => "Estimate normals and radii",
    }
}

/// Says so when another renderer than the chosen ones drew the picture.
fn drawn_by_ui(ui: &mut Ui, tab: &RendererTab<'_>) {
    let stranger = |id: &&str| *id != tab.chosen && Some(*id) != tab.preview;
    let Some(drawn_by) = tab.drawn_by.filter(stranger) else {
        return;
    };
    let title = tab
        .rows
        .renderer(drawn_by)
        .map_or(drawn_by, |row| &row.title);
    ui.indent("drawn_by", |ui| {
        let color = theme::severity_color(ui, Severity::Warning);
        ui.colored_label(color, format!("The picture is by {title} meanwhile."));
    });
}

/// Which renderer stands in while things move.
fn preview_ui(ui: &mut Ui, tab: &RendererTab<'_>, out: &mut Intents) {
    ui.add_space(4.0);
    let chosen = tab.preview.and_then(|id| tab.rows.renderer(id));
    super::row(
        ui,
        "Preview",
        "Stands in while the camera or a slider moves; Space calls it by hand",
        |ui| {
            let shown = match (tab.preview, chosen) {
                (None, _) => NO_PREVIEW,
                (Some(_), Some(row)) => &row.title,
                (Some(id), None) => id,
            };
            ComboBox::from_id_salt("preview")
                .truncate()
                .selected_text(shown)
                .show_ui(ui, |ui| preview_choices_ui(ui, tab, out));
        },
    );
    if let Some(row) = chosen {
        ui.indent("preview", |ui| {
            if let Some(obstacle) = &row.obstacle {
                obstacle_ui(ui, obstacle, out);
            }
            if let Some(why) = reason_for(tab.rows.recommended_preview.as_ref(), row) {
                recommended_ui(ui, why);
            }
        });
    }
}

fn preview_choices_ui(ui: &mut Ui, tab: &RendererTab<'_>, out: &mut Intents) {
    let is_none = tab.preview.is_none();
    if ui.selectable_label(is_none, NO_PREVIEW).clicked() && !is_none {
        out.push(RendererIntent::ChoosePreview(None));
    }
    for row in &tab.rows.renderers {
        if row.id == tab.chosen {
            continue; // It is the main renderer: that is what 'None' means.
        }
        let is_chosen = tab.preview == Some(row.id.as_str());
        let button = ui
            .add_enabled(
                row.obstacle.is_none(),
                Button::selectable(is_chosen, &row.title),
            )
            .on_hover_text(&row.about);
        if button.clicked() && !is_chosen {
            out.push(RendererIntent::ChoosePreview(Some(row.id.clone())));
        }
        if let Some(obstacle) = &row.obstacle {
            ui.label(RichText::new(&obstacle.reason).weak().small());
        } else if let Some(why) = reason_for(tab.rows.recommended_preview.as_ref(), row) {
            ui.label(RichText::new(format!("Recommended: {why}.")).weak().small());
        }
    }
}

fn structures_ui(ui: &mut Ui, tab: &RendererTab<'_>, out: &mut Intents) {
    const NO_STRUCTURE: &str = "none: every surfel";
    let structures = &tab.rows.structures;
    if structures.is_empty() {
        return;
    }
    let chosen = tab.chosen_structure;
    let row = chosen.and_then(|id| tab.rows.structure(id));
    super::row(
        ui,
        "Level of detail",
        "Which structure selects the surfels to draw",
        |ui| {
            let shown = match (chosen, row) {
                (None, _) => NO_STRUCTURE,
                (Some(_), Some(row)) => &row.title,
                (Some(id), None) => id,
            };
            ComboBox::from_id_salt("structure")
                .truncate()
                .selected_text(shown)
                .show_ui(ui, |ui| {
                    if ui
                        .selectable_label(chosen.is_none(), NO_STRUCTURE)
                        .clicked()
                    {
                        out.push(RendererIntent::ChooseStructure(None));
                    }
                    for row in structures {
                        let is_chosen = chosen == Some(row.id.as_str());
                        let label = ui
                            .add_enabled(
                                row.obstacle.is_none() || is_chosen,
                                Button::selectable(is_chosen, &row.title),
                            )
                            .on_hover_text(&row.about);
                        if label.clicked() {
                            out.push(RendererIntent::ChooseStructure(Some(row.id.clone())));
                        }
                        if let Some(obstacle) = &row.obstacle {
                            ui.label(RichText::new(&obstacle.reason).weak().small());
                        }
                    }
                });
        },
    );
}

/// The main renderer's settings with their presets, then the structure's.
fn settings_ui(ui: &mut Ui, tab: &RendererTab<'_>, chosen: &RendererRow, out: &mut Intents) {
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
        copy_ui(ui, &sources(tab.rows, chosen), out);
    });
    ui.push_id(&chosen.id, |ui| {
        if !chosen.settings.is_empty() {
            presets_ui(ui, tab.presets, out);
        }
        let panel = SchemaPanel {
            owner: Owner::Renderer,
            schema: &chosen.settings,
            values: tab.values,
            focus: tab.focus,
        };
        schema_ui(ui, &panel, out);
    });
    let structure = tab.chosen_structure.and_then(|id| tab.rows.structure(id));
    if let Some(structure) = structure.filter(|row| !row.settings.is_empty()) {
        ui.separator();
        ui.heading(&structure.title);
        ui.push_id(&structure.id, |ui| {
            let panel = SchemaPanel {
                owner: Owner::Structure,
                schema: &structure.settings,
                values: tab.structure_values,
                focus: None,
            };
            schema_ui(ui, &panel, out);
        });
    }
}

/// Renderers that have a setting of an id that `chosen` has too: id and title.
fn sources(rows: &Rows, chosen: &RendererRow) -> Vec<(String, String)> {
    let shares = |row: &&RendererRow| {
        let mut settings = row.settings.iter();
        row.id != chosen.id
            && settings.any(|setting| {
                let mut own = chosen.settings.iter();
                setting.default_value().is_some() && own.any(|other| other.id == setting.id)
            })
    };
    let sources = rows.renderers.iter().filter(shares);
    sources
        .map(|row| (row.id.clone(), row.title.clone()))
        .collect()
}
