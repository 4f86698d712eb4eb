//! A panel made from a settings schema: groups, search, conditions, help, reset of one, of a group, of all.

use egui::collapsing_header::{CollapsingState, paint_default_icon};
use egui::{Button, Id, RichText, Sense, TextEdit, Ui, Vec2};
use pointstage_plugin_api::settings_schema::{
    SettingCost, SettingKind, SettingSchema, SettingValue, SettingValues,
};

use super::value::{Edited, value_ui};
use crate::window::intent::{Intents, RendererIntent};
use crate::window::theme;

/// A schema with more settings than this can be searched.
const SEARCH_FROM: usize = 9;

/// Whose settings the panel shows, and so what its edits ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Owner {
    /// The chosen renderer's.
    Renderer,
    /// The chosen structure's.
    Structure,
}

impl Owner {
    fn set(self, id: &str, value: SettingValue) -> RendererIntent {
        match self {
            Self::Renderer => RendererIntent::Set(id.to_owned(), value),
            Self::Structure => RendererIntent::SetOfStructure(id.to_owned(), value),
        }
    }

    fn reset(self, ids: Vec<String>) -> RendererIntent {
        match self {
            Self::Renderer => RendererIntent::ResetSome(ids),
            Self::Structure => RendererIntent::ResetOfStructure(ids),
        }
    }
}

/// What the panel shows.
#[derive(Clone, Copy)]
pub(crate) struct SchemaPanel<'a> {
    /// Whose settings.
    pub(crate) owner: Owner,
    /// The settings, in order.
    pub(crate) schema: &'a [SettingSchema],
    /// Values that differ from the defaults.
    pub(crate) values: &'a SettingValues,
    /// The setting that shall have the keyboard now.
    pub(crate) focus: Option<&'a str>,
}

/// All settings under their groups' headings, which fold; those whose condition does not hold are absent.
pub(crate) fn schema_ui(ui: &mut Ui, panel: &SchemaPanel<'_>, out: &mut Intents) {
    let SchemaPanel { schema, values, .. } = *panel;
    if schema.is_empty() {
        ui.weak("It has no settings.");
        return;
    }
    let sought = if schema.len() >= SEARCH_FROM {
        search_ui(ui)
    } else {
        String::new()
    };
    let mut is_any_shown = false;
    for group in groups(schema) {
        let of_group: Vec<&SettingSchema> = schema
            .iter()
            .filter(|setting| setting.group == group && setting.is_visible(schema, values))
            .filter(|setting| is_meant(setting, &sought) || panel.focus == Some(&setting.id))
            .collect();
        if of_group.is_empty() {
            continue;
        }
        is_any_shown = true;
        if group.is_empty() {
            settings_ui(ui, panel, &of_group, out);
        } else {
            group_ui(ui, panel, group, &of_group, !sought.is_empty(), out);
        }
    }
    if !is_any_shown {
        ui.weak(format!("No setting has '{sought}' in its name or help."));
    }
}

/// The field to search in; returns what is sought.
fn search_ui(ui: &mut Ui) -> String {
    let id = ui.scope_id().with("search");
    let mut sought = ui.data(|data| data.get_temp::<String>(id).unwrap_or_default());
    ui.horizontal(|ui| {
        let field = TextEdit::singleline(&mut sought)
            .hint_text("Search the settings")
            .desired_width(ui.available_width() - super::RESET_WIDTH - 8.0);
        let response = ui.add(field);
        response.accessible_name("Search the settings");
        if !sought.is_empty() && ui.small_button("clear").clicked() {
            sought.clear();
        }
    });
    ui.data_mut(|data| data.insert_temp(id, sought.clone()));
    sought.trim().to_lowercase()
}

/// Whether a setting's name, help, group or id contains what is sought.
fn is_meant(setting: &SettingSchema, sought: &str) -> bool {
    let texts = [&setting.label, &setting.help, &setting.group, &setting.id];
    texts
        .iter()
        .any(|text| text.to_lowercase().contains(sought))
}

/// Names of the groups, in the order in which the schema first uses them.
fn groups(schema: &[SettingSchema]) -> Vec<&str> {
    let mut groups: Vec<&str> = Vec::new();
    for setting in schema {
        if !groups.contains(&setting.group.as_str()) {
            groups.push(&setting.group);
        }
    }
    groups
}

/// A heading that folds its settings away, with a reset of all of them. A search and a sought setting unfold it.
fn group_ui(
    ui: &mut Ui,
    panel: &SchemaPanel<'_>,
    group: &str,
    settings: &[&SettingSchema],
    is_searched: bool,
    out: &mut Intents,
) {
    let id = ui.scope_id().with(("group", group));
    let mut state = CollapsingState::load_with_default_open(ui.ctx(), id, true);
    let is_focused = settings
        .iter()
        .any(|setting| panel.focus == Some(&setting.id));
    if is_focused {
        state.set_open(true);
    }
    let is_open = state.is_open() || is_searched;
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        // The toolkit's own sign; no font is sure to have one.
        let size = Vec2::splat(ui.spacing().icon_width);
        let (_, icon) = ui.allocate_exact_size(size, Sense::hover());
        paint_default_icon(ui, if is_open { 1.0 } else { 0.0 }, &icon);
        let heading = ui.add(Button::new(RichText::new(group).strong()).frame(false));
        ui.ctx().accesskit_node_builder(heading.id, |node| {
            node.set_expanded(is_open);
        });
        if heading.clicked() {
            state.toggle(ui);
        }
        reset_ui(ui, panel, group, settings, out);
    });
    state.store(ui.ctx());
    if is_open {
        settings_ui(ui, panel, settings, out);
    }
}

/// Gives all of `settings` their defaults, if one differs.
fn reset_ui(
    ui: &mut Ui,
    panel: &SchemaPanel<'_>,
    name: &str,
    settings: &[&SettingSchema],
    out: &mut Intents,
) {
    let differing: Vec<String> = settings
        .iter()
        .filter(|setting| panel.values.contains_key(&setting.id))
        .map(|setting| setting.id.clone())
        .collect();
    if differing.is_empty() {
        return;
    }
    let name = format!("Reset {name}");
    let reset = ui.add(Button::new("reset").small()).on_hover_text(&name);
    if reset.accessible_name(name).clicked() {
        out.push(panel.owner.reset(differing));
    }
}

fn settings_ui(
    ui: &mut Ui,
    panel: &SchemaPanel<'_>,
    settings: &[&SettingSchema],
    out: &mut Intents,
) {
    for setting in settings {
        ui.push_id(&setting.id, |ui| setting_ui(ui, panel, setting, out));
    }
}

fn setting_ui(ui: &mut Ui, panel: &SchemaPanel<'_>, setting: &SettingSchema, out: &mut Intents) {
    let help = help_text(setting);
    let takes_focus = panel.focus == Some(&setting.id);
    let value = panel.values.get(&setting.id).cloned();
    let Some(value) = value.or_else(|| setting.default_value()) else {
        if panel.owner == Owner::Structure {
            return; // A request carries the renderer's actions alone.
        }
        let button = ui.button(&setting.label).on_hover_text(help);
        if takes_focus {
            focus(&button);
        }
        if button.clicked() {
            out.push(RendererIntent::Press(setting.id.clone()));
        }
        return;
    };
    let mut edited = Edited::default();
    super::row(ui, &setting.label, &help, |ui| {
        edited = value_ui(ui, setting, &value);
        if takes_focus && let Some(widget) = &edited.widget {
            focus(widget);
        }
        reset_ui(ui, panel, &setting.label, &[setting], out);
    });
    note_ui(ui, &edited, &value);
    if let Some(value) = edited.value {
        out.push(panel.owner.set(&setting.id, value));
    }
}

/// Puts the keyboard on a widget and scrolls to it.
fn focus(widget: &egui::Response) {
    widget.request_focus();
    widget.scroll_to_me(Some(egui::Align::Center));
}

/// Says under the field why a typed value was not taken as it is, until the value is another one.
fn note_ui(ui: &mut Ui, edited: &Edited, value: &SettingValue) {
    type Note = (String, SettingValue);
    let id: Id = ui.scope_id().with("note");
    if let Some(refused) = &edited.refused {
        let now = edited.value.clone().unwrap_or_else(|| value.clone());
        ui.data_mut(|data| data.insert_temp::<Note>(id, (refused.clone(), now)));
    } else if edited.value.is_some() {
        ui.data_mut(|data| data.remove::<Note>(id));
    }
    let Some((text, taken)) = ui.data(|data| data.get_temp::<Note>(id)) else {
        return;
    };
    if edited.value.is_none() && taken != *value {
        ui.data_mut(|data| data.remove::<Note>(id));
        return;
    }
    let color = theme::severity_color(ui, pointstage_engine::stage::Severity::Warning);
    ui.label(RichText::new(text).small().color(color));
}

/// Help, range, default and cost, for the tooltip.
fn help_text(setting: &SettingSchema) -> String {
    let mut lines = Vec::new();
    if !setting.help.is_empty() {
        lines.push(setting.help.clone());
    }
    match &setting.kind {
        SettingKind::Int { range, default } => {
            lines.push(format!("Range {}, default {default}.", range.in_words()));
        }
        SettingKind::Float { range, default } => {
            lines.push(format!("Range {}, default {default}.", range.in_words()));
        }
        _ => {}
    }
    if setting.cost == SettingCost::Prepare {
        lines.push("A change prepares the renderer anew.".to_owned());
    }
    if let Some(shortcut) = &setting.shortcut {
        lines.push(format!("Alt+{shortcut}"));
    }
    lines.push(format!("--set {}=…", setting.id));
    lines.join("\n")
}
