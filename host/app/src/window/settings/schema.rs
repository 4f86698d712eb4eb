//! Widgets made from a settings schema: every kind, its ranges and unit, groups, help, conditions, reset.

use egui::{Button, ComboBox, DragValue, RichText, Slider, SliderClamping, TextEdit, Ui};
use pointstage_plugin_api::settings_schema::{
    ChoiceOption, NumberRange, Scale, SettingCost, SettingKind, SettingSchema, SettingValue,
    SettingValues,
};

use crate::window::intent::{Intents, RendererIntent};

/// All settings of a schema under their groups' headings; those whose condition does not hold are absent.
///
/// `values` holds what differs from the defaults. Edits come out as [`RendererIntent::Set`], [`RendererIntent::Reset`], [`RendererIntent::Press`].
pub(crate) fn schema_ui(
    ui: &mut Ui,
    schema: &[SettingSchema],
    values: &SettingValues,
    out: &mut Intents,
) {
    if schema.is_empty() {
        ui.weak("It has no settings.");
        return;
    }
    for group in groups(schema) {
        let of_group: Vec<&SettingSchema> = schema
            .iter()
            .filter(|setting| setting.group == group && is_visible(setting, schema, values))
            .collect();
        if of_group.is_empty() {
            continue;
        }
        if !group.is_empty() {
            ui.add_space(4.0);
            ui.label(RichText::new(group).strong());
        }
        for setting in of_group {
            ui.push_id(&setting.id, |ui| setting_ui(ui, setting, values, out));
        }
    }
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

/// Whether the setting's condition holds. A condition on a setting that is itself hidden counts by its value.
fn is_visible(setting: &SettingSchema, schema: &[SettingSchema], values: &SettingValues) -> bool {
    setting.visible_if.as_ref().is_none_or(|condition| {
        let other = schema.iter().find(|other| other.id == condition.id);
        other.and_then(|other| value_of(other, values)) == Some(condition.equals.clone())
    })
}

/// The value that a setting has now; `None` for an action.
fn value_of(setting: &SettingSchema, values: &SettingValues) -> Option<SettingValue> {
    values.get(&setting.id).cloned().or(match &setting.kind {
        SettingKind::Bool { default } => Some(SettingValue::Bool(*default)),
        SettingKind::Int { default, .. } => Some(SettingValue::Int(*default)),
        SettingKind::Float { default, .. } => Some(SettingValue::Float(*default)),
        SettingKind::Choice { default, .. } => Some(SettingValue::Choice(default.clone())),
        SettingKind::Colour { default } => Some(SettingValue::Colour(*default)),
        SettingKind::Text { default } => Some(SettingValue::Text(default.clone())),
        SettingKind::Action => None,
    })
}

fn setting_ui(ui: &mut Ui, setting: &SettingSchema, values: &SettingValues, out: &mut Intents) {
    let help = help_text(setting);
    let Some(value) = value_of(setting, values) else {
        let button = ui.button(&setting.label).on_hover_text(help);
        if button.clicked() {
            out.push(RendererIntent::Press(setting.id.clone()));
        }
        return;
    };
    super::row(ui, &setting.label, &help, |ui| {
        if let Some(edited) = value_ui(ui, setting, &value) {
            out.push(RendererIntent::Set(setting.id.clone(), edited));
        }
        let differs = values.contains_key(&setting.id);
        if differs {
            let name = format!("Reset {}", setting.label);
            let reset = ui.add(Button::new("reset").small()).on_hover_text(&name);
            let reset = reset.accessible_name(name);
            if reset.clicked() {
                out.push(RendererIntent::Reset(setting.id.clone()));
            }
        }
    });
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

/// The widget of a value; the new value if it was edited.
fn value_ui(ui: &mut Ui, setting: &SettingSchema, value: &SettingValue) -> Option<SettingValue> {
    match (&setting.kind, value) {
        (SettingKind::Bool { .. }, SettingValue::Bool(value)) => {
            let mut edited = *value;
            // The row's label names it.
            ui.checkbox(&mut edited, "")
                .changed()
                .then_some(SettingValue::Bool(edited))
        }
        (SettingKind::Int { range, .. }, SettingValue::Int(value)) => {
            int_ui(ui, range, *value).map(SettingValue::Int)
        }
        (SettingKind::Float { range, .. }, SettingValue::Float(value)) => {
            float_ui(ui, range, *value).map(SettingValue::Float)
        }
        (SettingKind::Choice { options, .. }, SettingValue::Choice(chosen)) => {
            choice_ui(ui, options, chosen).map(SettingValue::Choice)
        }
        (SettingKind::Colour { .. }, SettingValue::Colour(value)) => {
            colour_ui(ui, *value).map(SettingValue::Colour)
        }
        (SettingKind::Text { .. }, SettingValue::Text(value)) => {
            text_ui(ui, value).map(SettingValue::Text)
        }
        // The session holds checked values alone, so kinds agree; a stranger is shown, not edited.
        (_, other) => {
            ui.monospace(other.to_string());
            None
        }
    }
}

/// A slider over the soft range; typing reaches the hard range. Without any range, a number to drag or type.
fn float_ui(ui: &mut Ui, range: &NumberRange<f64>, value: f64) -> Option<f64> {
    let mut edited = value;
    let response = if let Some((low, high)) =
        slider_ends(range.soft_min, range.min, range.soft_max, range.max)
    {
        let mut slider = Slider::new(&mut edited, low..=high)
            .clamping(SliderClamping::Never)
            .logarithmic(range.scale == Scale::Logarithmic)
            .suffix(suffix(&range.unit))
            .max_decimals(6);
        if range.scale == Scale::Logarithmic && low > 0.0 {
            slider = slider.smallest_positive(low);
        }
        if let Some(step) = range.step {
            slider = slider.step_by(step);
        }
        ui.add(slider)
    } else {
        let speed = range.step.unwrap_or_else(|| (value.abs() * 0.01).max(1e-3));
        ui.add(
            DragValue::new(&mut edited)
                .speed(speed)
                .suffix(suffix(&range.unit))
                .max_decimals(6),
        )
    };
    let least = range.min.unwrap_or(f64::NEG_INFINITY);
    let greatest = range.max.unwrap_or(f64::INFINITY);
    let edited = edited.max(least).min(greatest);
    (response.changed() && edited.is_finite() && edited != value).then_some(edited)
}

fn int_ui(ui: &mut Ui, range: &NumberRange<i64>, value: i64) -> Option<i64> {
    let mut edited = value;
    let response = if let Some((low, high)) =
        slider_ends(range.soft_min, range.min, range.soft_max, range.max)
    {
        let mut slider = Slider::new(&mut edited, low..=high)
            .clamping(SliderClamping::Never)
            .logarithmic(range.scale == Scale::Logarithmic)
            .suffix(suffix(&range.unit));
        if let Some(step) = range.step {
            slider = slider.step_by(step as f64);
        }
        ui.add(slider)
    } else {
        ui.add(DragValue::new(&mut edited).suffix(suffix(&range.unit)))
    };
    let least = range.min.unwrap_or(i64::MIN);
    let greatest = range.max.unwrap_or(i64::MAX);
    let edited = edited.max(least).min(greatest);
    (response.changed() && edited != value).then_some(edited)
}

/// Ends of the slider: the soft range, where it is absent the hard one; `None` if a side is open.
fn slider_ends<T>(
    soft_min: Option<T>,
    min: Option<T>,
    soft_max: Option<T>,
    max: Option<T>,
) -> Option<(T, T)> {
    soft_min.or(min).zip(soft_max.or(max))
}

fn suffix(unit: &str) -> String {
    if unit.is_empty() {
        String::new()
    } else {
        format!(" {unit}")
    }
}

fn choice_ui(ui: &mut Ui, options: &[ChoiceOption], chosen: &str) -> Option<String> {
    let label_of = |id: &str| {
        let option = options.iter().find(|option| option.id == id);
        option.map_or(id.to_owned(), |option| option.label.clone())
    };
    let mut edited = chosen.to_owned();
    ComboBox::from_id_salt("choice")
        .selected_text(label_of(chosen))
        .show_ui(ui, |ui| {
            for option in options {
                ui.selectable_value(&mut edited, option.id.clone(), &option.label);
            }
        });
    (edited != chosen).then_some(edited)
}

/// Linear values; the picker shows and edits them as people see them.
fn colour_ui(ui: &mut Ui, value: [f64; 4]) -> Option<[f64; 4]> {
    let mut edited = value.map(|channel| channel as f32);
    let response = ui.color_edit_button_rgba_unmultiplied(&mut edited);
    response.changed().then(|| edited.map(f64::from))
}

/// A text is taken when the field is left or Enter is pressed, not at every letter.
fn text_ui(ui: &mut Ui, value: &str) -> Option<String> {
    let draft_id = ui.scope_id().with("draft");
    let mut draft = ui
        .data(|data| data.get_temp::<String>(draft_id))
        .unwrap_or_else(|| value.to_owned());
    let response = ui.add(TextEdit::singleline(&mut draft));
    if response.has_focus() {
        ui.data_mut(|data| data.insert_temp(draft_id, draft));
        return None;
    }
    ui.data_mut(|data| data.remove::<String>(draft_id));
    (response.lost_focus() && draft != value).then_some(draft)
}
