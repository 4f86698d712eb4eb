//! Presets of the chosen renderer's settings, and values taken over from another renderer.

use egui::{ComboBox, RichText, TextEdit, Ui};
use pointstage_engine::stage::Severity;

use crate::window::intent::{Intents, RendererIntent};
use crate::window::presets::{DEFAULTS, PresetList, checked_name};
use crate::window::theme;

/// What a name is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Naming {
    SaveAs,
    Rename,
}

/// The name that is being typed.
#[derive(Clone, Debug)]
struct Draft {
    naming: Naming,
    text: String,
    is_new: bool,
}

/// The row of presets: choose one, keep the present values, rename, delete.
pub(super) fn presets_ui(ui: &mut Ui, list: &PresetList, out: &mut Intents) {
    let PresetList {
        names,
        active,
        differs,
    } = list;
    super::row(
        ui,
        "Preset",
        "Values of all settings under a name. Choosing one again takes back what was changed since.",
        |ui| {
            let shown = if *differs {
                format!("{active} (changed)")
            } else {
                active.clone()
            };
            ComboBox::from_id_salt("preset")
                .selected_text(shown)
                .show_ui(ui, |ui| {
                    for name in std::iter::once(DEFAULTS).chain(names.iter().map(String::as_str)) {
                        if ui.selectable_label(name == active, name).clicked() {
                            out.push(RendererIntent::ChoosePreset(name.to_owned()));
                        }
                    }
                });
        },
    );
    let is_own = active != DEFAULTS;
    let draft_id = ui.scope_id().with("preset name");
    let mut draft = ui.data(|data| data.get_temp::<Draft>(draft_id));
    let begin = |naming, text: &str| {
        Some(Draft {
            naming,
            text: text.to_owned(),
            is_new: true,
        })
    };
    ui.horizontal_wrapped(|ui| {
        let save = ui
            .add_enabled(is_own && *differs, egui::Button::new("Save").small())
            .on_hover_text(format!("Keep the present values as '{active}'"))
            .on_disabled_hover_text(if is_own {
                "Nothing differs from the preset."
            } else {
                "The defaults are built in; save the values under a name of their own."
            });
        if save.accessible_name("Save preset").clicked() {
            out.push(RendererIntent::SavePreset(active.clone()));
        }
        let save_as = ui.small_button("Save as…");
        let save_as = save_as.on_hover_text("Keep the present values under a name");
        if save_as.clicked() {
            draft = begin(Naming::SaveAs, "");
        }
        if is_own {
            if ui.small_button("Rename…").clicked() {
                draft = begin(Naming::Rename, active);
            }
            let delete = ui.small_button("Delete");
            let delete = delete.on_hover_text("Forget the preset; the values stay as they are");
            if delete.accessible_name("Delete preset").clicked() {
                out.push(RendererIntent::DeletePreset(active.clone()));
            }
        }
    });
    let draft = draft.and_then(|draft| name_ui(ui, draft, list, out));
    ui.data_mut(|data| match draft {
        Some(draft) => {
            data.insert_temp(draft_id, draft);
        }
        None => {
            data.remove::<Draft>(draft_id);
        }
    });
}

/// The field for a name; `None` when it is done with.
fn name_ui(ui: &mut Ui, mut draft: Draft, list: &PresetList, out: &mut Intents) -> Option<Draft> {
    let mut is_done = false;
    let mut is_entered = false;
    ui.horizontal(|ui| {
        let field = TextEdit::singleline(&mut draft.text)
            .hint_text("Name of the preset")
            .desired_width((ui.available_width() - 120.0).max(80.0));
        let field = ui.add(field);
        if std::mem::take(&mut draft.is_new) {
            field.request_focus();
        }
        is_entered = field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        is_done = field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Escape));
        field.accessible_name("Name of the preset");
        is_entered |= ui.small_button("OK").clicked();
        is_done |= ui.small_button("Cancel").clicked();
    });
    let is_taken = |name: &str| list.names.iter().any(|other| other == name);
    match checked_name(&draft.text) {
        Err(error) => {
            if !draft.text.trim().is_empty() {
                warning_ui(ui, &error.to_string());
            }
        }
        Ok(name) => {
            let is_other = name != list.active || draft.naming == Naming::SaveAs;
            let is_refused = draft.naming == Naming::Rename && is_taken(&name) && is_other;
            if is_refused {
                warning_ui(ui, &format!("There is a preset '{name}' already."));
            } else if is_taken(&name) && draft.naming == Naming::SaveAs {
                warning_ui(ui, &format!("This overwrites the preset '{name}'."));
            }
            if is_entered && !is_refused {
                is_done = true;
                out.push(match draft.naming {
                    Naming::SaveAs => RendererIntent::SavePreset(name),
                    Naming::Rename => RendererIntent::RenamePreset {
                        from: list.active.clone(),
                        to: name,
                    },
                });
            }
        }
    }
    (!is_done).then_some(draft)
}

fn warning_ui(ui: &mut Ui, text: &str) {
    let color = theme::severity_color(ui, Severity::Warning);
    ui.label(RichText::new(text).small().color(color));
}

/// A menu of other renderers that have settings of the same id; a click takes their values over.
pub(super) fn copy_ui(ui: &mut Ui, sources: &[(String, String)], out: &mut Intents) {
    if sources.is_empty() {
        return;
    }
    ui.menu_button("Copy from…", |ui| {
        for (id, title) in sources {
            if ui.button(title).clicked() {
                out.push(RendererIntent::CopyFrom(id.clone()));
                ui.close();
            }
        }
    })
    .response
    .on_hover_text("Takes over the values of settings that another renderer has too");
}
