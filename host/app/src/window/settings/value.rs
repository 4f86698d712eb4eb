//! The widget of one setting's value: every kind, its range and unit.

use egui::emath::Numeric;
use egui::{ComboBox, DragValue, Response, Slider, SliderClamping, TextEdit, Ui};
use pointstage_plugin_api::settings_schema::{
    ChoiceOption, NumberRange, Scale, SettingKind, SettingSchema, SettingValue, ValueError,
};

/// What came of showing a value.
#[derive(Default)]
pub(super) struct Edited {
    /// The new value, if it was edited: within the hard range.
    pub(super) value: Option<SettingValue>,
    /// Why what was typed is not what was taken, one sentence.
    pub(super) refused: Option<String>,
    /// The widget that takes the keyboard.
    pub(super) widget: Option<Response>,
}

impl Edited {
    fn new(widget: Response, value: Option<SettingValue>) -> Self {
        Self {
            value,
            refused: None,
            widget: Some(widget),
        }
    }
}

/// The widget of a value.
pub(super) fn value_ui(ui: &mut Ui, setting: &SettingSchema, value: &SettingValue) -> Edited {
    match (&setting.kind, value) {
        (SettingKind::Bool { .. }, SettingValue::Bool(value)) => {
            let mut edited = *value;
            // The row's label names it.
            let response = ui.checkbox(&mut edited, "");
            let changed = response.changed();
            Edited::new(response, changed.then_some(SettingValue::Bool(edited)))
        }
        (SettingKind::Int { range, .. }, SettingValue::Int(number)) => {
            let (response, typed) = number_ui(ui, &setting.label, range, *number);
            let typed = typed.map(SettingValue::Int);
            checked(setting, response, typed, value)
        }
        (SettingKind::Float { range, .. }, SettingValue::Float(number)) => {
            let (response, typed) = number_ui(ui, &setting.label, range, *number);
            let typed = typed.map(SettingValue::Float);
            checked(setting, response, typed, value)
        }
        (SettingKind::Choice { options, .. }, SettingValue::Choice(chosen)) => {
            let (response, edited) = choice_ui(ui, options, chosen);
            Edited::new(response, edited.map(SettingValue::Choice))
        }
        (SettingKind::Colour { .. }, SettingValue::Colour(value)) => {
            let (response, edited) = colour_ui(ui, *value);
            Edited::new(response, edited.map(SettingValue::Colour))
        }
        (SettingKind::Text { .. }, SettingValue::Text(value)) => {
            let (response, edited) = text_ui(ui, value);
            Edited::new(response, edited.map(SettingValue::Text))
        }
        // The session holds checked values alone, so kinds agree; a stranger is shown, not edited.
        (_, other) => {
            let response = ui.monospace(other.to_string());
            Edited::new(response, None)
        }
    }
}

/// Brings a typed number into the hard range, and says so.
fn checked(
    setting: &SettingSchema,
    widget: Response,
    typed: Option<SettingValue>,
    before: &SettingValue,
) -> Edited {
    let Some(typed) = typed else {
        return Edited::new(widget, None);
    };
    let (value, refused) = match setting.check(&typed) {
        Ok(value) => (Some(value), None),
        Err(ValueError::Range {
            found,
            range,
            nearest,
            ..
        }) => {
            let text = format!("{found} is outside {range}; {nearest} was taken.");
            // A drag that meets the end needs no words.
            let refused = (!widget.dragged()).then_some(text);
            (nearest_of(setting, &typed), refused)
        }
        Err(error) => (None, Some(error.to_string())),
    };
    Edited {
        value: value.filter(|value| value != before),
        refused,
        widget: Some(widget),
    }
}

/// The end of the hard range that is nearest to `typed`.
fn nearest_of(setting: &SettingSchema, typed: &SettingValue) -> Option<SettingValue> {
    match (&setting.kind, typed) {
        (SettingKind::Int { range, .. }, SettingValue::Int(number)) => {
            let least = range.min.unwrap_or(i64::MIN);
            let greatest = range.max.unwrap_or(i64::MAX);
            Some(SettingValue::Int((*number).max(least).min(greatest)))
        }
        (SettingKind::Float { range, .. }, SettingValue::Float(number)) => {
            let least = range.min.unwrap_or(f64::NEG_INFINITY);
            let greatest = range.max.unwrap_or(f64::INFINITY);
            Some(SettingValue::Float(number.max(least).min(greatest)))
        }
        _ => None,
    }
}

/// A slider over the soft range; typing reaches the hard range. Without any range, a number to drag or type.
fn number_ui<N: Numeric>(
    ui: &mut Ui,
    name: &str,
    range: &NumberRange<N>,
    value: N,
) -> (Response, Option<N>) {
    let mut edited = value;
    let step = range.step.map(N::to_f64);
    let max_decimals = if N::INTEGRAL { 0 } else { 6 };
    let response = if let Some((low, high)) = slider_ends(range) {
        let mut slider = Slider::new(&mut edited, low..=high)
            .clamping(SliderClamping::Never)
            .logarithmic(range.scale == Scale::Logarithmic)
            .suffix(suffix(&range.unit))
            .max_decimals(max_decimals);
        if range.scale == Scale::Logarithmic && low.to_f64() > 0.0 {
            slider = slider.smallest_positive(low.to_f64());
        }
        if let Some(step) = step {
            slider = slider.step_by(step);
        }
        ui.add(slider)
    } else {
        let number = DragValue::new(&mut edited)
            .suffix(suffix(&range.unit))
            .max_decimals(max_decimals);
        // Whole numbers go at the toolkit's own speed.
        let number = if N::INTEGRAL {
            number
        } else {
            number.speed(step.unwrap_or_else(|| (value.to_f64().abs() * 0.01).max(1e-3)))
        };
        // The toolkit would call a number with a unit by its unit.
        ui.add(number).accessible_name(name)
    };
    let is_edited = response.changed() && edited.to_f64().is_finite() && edited != value;
    (response, is_edited.then_some(edited))
}

/// Ends of the slider: the soft range, where it is absent the hard one; `None` if a side is open.
fn slider_ends<N: Copy>(range: &NumberRange<N>) -> Option<(N, N)> {
    let low = range.soft_min.or(range.min);
    low.zip(range.soft_max.or(range.max))
}

fn suffix(unit: &str) -> String {
    if unit.is_empty() {
        String::new()
    } else {
        format!(" {unit}")
    }
}

fn choice_ui(ui: &mut Ui, options: &[ChoiceOption], chosen: &str) -> (Response, Option<String>) {
    let label_of = |id: &str| {
        let option = options.iter().find(|option| option.id == id);
        option.map_or(id.to_owned(), |option| option.label.clone())
    };
    let mut edited = chosen.to_owned();
    let shown = ComboBox::from_id_salt("choice")
        .selected_text(label_of(chosen))
        .show_ui(ui, |ui| {
            for option in options {
                ui.selectable_value(&mut edited, option.id.clone(), &option.label);
            }
        });
    let is_edited = edited != chosen;
    (shown.response, is_edited.then_some(edited))
}

/// Linear values; the picker shows and edits them as people see them.
fn colour_ui(ui: &mut Ui, value: [f64; 4]) -> (Response, Option<[f64; 4]>) {
    let mut edited = value.map(|channel| channel as f32);
    let response = ui.color_edit_button_rgba_unmultiplied(&mut edited);
    let is_edited = response.changed();
    (response, is_edited.then(|| edited.map(f64::from)))
}

/// A text is taken when the field is left or Enter is pressed, not at every letter.
fn text_ui(ui: &mut Ui, value: &str) -> (Response, Option<String>) {
    let draft_id = ui.scope_id().with("draft");
    let mut draft = ui
        .data(|data| data.get_temp::<String>(draft_id))
        .unwrap_or_else(|| value.to_owned());
    let response = ui.add(TextEdit::singleline(&mut draft));
    if response.has_focus() {
        ui.data_mut(|data| data.insert_temp(draft_id, draft));
        return (response, None);
    }
    ui.data_mut(|data| data.remove::<String>(draft_id));
    let is_edited = response.lost_focus() && draft != value;
    (response, is_edited.then_some(draft))
}
