//! The schema of a renderer's settings, as the manifest declares it.
//!
//! One schema serves the panel, the command line (`--set id=value`), presets, sessions and sweeps. The host alone holds
//! the values, checks them ([`SettingSchema::check`]) and hands a snapshot with each call.

pub use crate::nearest::nearest_names;
pub use crate::setting_value::{SettingValue, SettingValues, ValueError, snapshot};

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// One setting.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(into = "WrittenSetting")]
pub struct SettingSchema {
    /// Stable: sessions, presets and command lines name it.
    pub id: String,
    /// Kind, default, and what limits the value.
    pub kind: SettingKind,
    /// Short name in the panel; the id if the manifest has none.
    pub label: String,
    /// One or two sentences for the tooltip.
    pub help: String,
    /// Heading under which the panel shows it; empty for none.
    pub group: String,
    /// Shown only while another setting has a value.
    pub visible_if: Option<VisibleIf>,
    /// What a change costs.
    pub cost: SettingCost,
    /// Key that changes it with Alt held while this renderer is chosen: a bool is switched, a choice takes its next option, an
    /// action is pressed, any other setting gets the keyboard.
    pub shortcut: Option<String>,
    /// Keys that give it a value each, with Alt held while this renderer is chosen.
    pub value_shortcuts: Vec<ValueShortcut>,
}

/// A key that gives a setting a value.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ValueShortcut {
    /// The key's name: a letter, a digit, `F5`, …
    pub key: String,
    /// The value.
    pub value: SettingValue,
}

/// Kind of a setting, with its default and limits.
#[derive(Clone, Debug, PartialEq)]
pub enum SettingKind {
    /// On or off.
    Bool {
        /// Value at first.
        default: bool,
    },
    /// A whole number.
    Int {
        /// Value at first.
        default: i64,
        /// Limits, step, unit and scale.
        range: NumberRange<i64>,
    },
    /// A number.
    Float {
        /// Value at first.
        default: f64,
        /// Limits, step, unit and scale.
        range: NumberRange<f64>,
    },
    /// One of several options.
    Choice {
        /// Id of the option at first.
        default: String,
        /// At least one; ids are unique.
        options: Vec<ChoiceOption>,
    },
    /// A colour.
    Colour {
        /// Linear red, green, blue, alpha.
        default: [f64; 4],
    },
    /// Any text.
    Text {
        /// Value at first.
        default: String,
    },
    /// A button: it has no value; pressing it is told to the next frame.
    Action,
}

/// Limits of a number.
#[derive(Clone, Debug, PartialEq)]
pub struct NumberRange<T> {
    /// Least allowed value.
    pub min: Option<T>,
    /// Greatest allowed value.
    pub max: Option<T>,
    /// Left end of the slider; the user may type less, down to `min`.
    pub soft_min: Option<T>,
    /// Right end of the slider; the user may type more, up to `max`.
    pub soft_max: Option<T>,
    /// Step of the slider; a value between steps is allowed.
    pub step: Option<T>,
    /// `px`, `°`, …; empty for none.
    pub unit: String,
    /// How the slider maps.
    pub scale: Scale,
}

/// How a slider maps to values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Scale {
    /// Equal lengths are equal differences.
    #[default]
    Linear,
    /// Equal lengths are equal factors; the least value is above 0.
    Logarithmic,
}

/// What a change of a setting costs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SettingCost {
    /// The next frame shows it.
    #[default]
    Redraw,
    /// The renderer is prepared anew.
    Prepare,
}

/// One option of a choice.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ChoiceOption {
    /// Stable.
    pub id: String,
    /// As shown; the id if the manifest has none.
    #[serde(default)]
    pub label: String,
}

/// A condition on another setting.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VisibleIf {
    /// The other setting of the same plugin.
    pub id: String,
    /// The value that it must have.
    pub equals: SettingValue,
}

/// What is wrong with one setting of a manifest.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SchemaError {
    /// The JSON does not have the form of a setting.
    #[error("{0}")]
    Form(String),
    /// The id is empty or has letters that a command line cannot carry.
    #[error("the id may have only letters, digits, '-', '_' and '.', and at least one of them")]
    Id,
    /// Another setting of the plugin has the same id.
    #[error("the id is used twice")]
    Duplicate,
    /// A field that this kind needs is absent.
    #[error("kind '{kind}' needs '{field}'")]
    Missing {
        /// The setting's kind.
        kind: &'static str,
        /// The absent field.
        field: &'static str,
    },
    /// The default or another number has the wrong type.
    #[error("'{field}' should be {expected}, found {found}")]
    Type {
        /// The field.
        field: &'static str,
        /// What it should be, in words.
        expected: &'static str,
        /// What it is, as JSON.
        found: String,
    },
    /// The default is refused by the setting's own limits.
    #[error("the default is not allowed: {0}")]
    Default(Box<ValueError>),
    /// Limits contradict each other.
    #[error("{0}")]
    Range(String),
    /// A choice has no options, or two of one id.
    #[error("{0}")]
    Options(String),
    /// `visible_if` names a setting that the plugin does not have.
    #[error("'visible_if' names the unknown setting '{id}'{hint}")]
    UnknownCondition {
        /// The name.
        id: String,
        /// The nearest ids.
        hint: String,
    },
    /// `visible_if` asks for a value that the other setting cannot have.
    #[error("'visible_if' can never hold: {0}")]
    Condition(Box<ValueError>),
    /// A shortcut gives a value that the setting cannot have.
    #[error("'value_shortcuts' gives with '{key}' what is not allowed: {source}")]
    Shortcut {
        /// The key.
        key: String,
        /// What is wrong with its value.
        source: Box<ValueError>,
    },
}

impl SettingKind {
    /// The kind's name in the manifest.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Bool { .. } => "bool",
            Self::Int { .. } => "int",
            Self::Float { .. } => "float",
            Self::Choice { .. } => "choice",
            Self::Colour { .. } => "colour",
            Self::Text { .. } => "text",
            Self::Action => "action",
        }
    }

    /// What a value is, for messages.
    pub(crate) fn in_words(&self) -> String {
        match self {
            Self::Bool { .. } => "true or false".to_owned(),
            Self::Int { range, .. } => format!("a whole number in {}", range.in_words()),
            Self::Float { range, .. } => format!("a number in {}", range.in_words()),
            Self::Choice { options, .. } => {
                let ids: Vec<&str> = options.iter().map(|option| option.id.as_str()).collect();
                format!("one of {}", ids.join(", "))
            }
            Self::Colour { .. } => {
                "a colour ('#rrggbb', or linear 'r,g,b' or 'r,g,b,a')".to_owned()
            }
            Self::Text { .. } => "a text".to_owned(),
            Self::Action => "nothing (it is a button)".to_owned(),
        }
    }
}

impl<T: std::fmt::Display> NumberRange<T> {
    /// `0.1 … 64 px`; an open end is `−∞` or `∞`.
    pub fn in_words(&self) -> String {
        let end = |end: &Option<T>, open: &str| end.as_ref().map_or(open.to_owned(), T::to_string);
        let text = format!("{} … {}", end(&self.min, "−∞"), end(&self.max, "∞"));
        if self.unit.is_empty() {
            text
        } else {
            format!("{text} {}", self.unit)
        }
    }
}

/// A setting in the manifest's own form: what `Serialize` writes.
#[derive(Serialize)]
struct WrittenSetting {
    id: String,
    kind: &'static str,
    #[serde(skip_serializing_if = "Value::is_null")]
    default: Value,
    #[serde(flatten)]
    range: Option<WrittenRange>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    options: Vec<ChoiceOption>,
    label: String,
    help: String,
    group: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    visible_if: Option<VisibleIf>,
    cost: SettingCost,
    #[serde(skip_serializing_if = "Option::is_none")]
    shortcut: Option<String>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    value_shortcuts: Vec<ValueShortcut>,
}

#[derive(Serialize)]
struct WrittenRange {
    min: Value,
    max: Value,
    soft_min: Value,
    soft_max: Value,
    step: Value,
    unit: String,
    scale: Scale,
}

impl<T: Into<Value>> From<NumberRange<T>> for WrittenRange {
    fn from(range: NumberRange<T>) -> Self {
        let value = |number: Option<T>| number.map_or(Value::Null, Into::into);
        Self {
            min: value(range.min),
            max: value(range.max),
            soft_min: value(range.soft_min),
            soft_max: value(range.soft_max),
            step: value(range.step),
            unit: range.unit,
            scale: range.scale,
        }
    }
}

impl From<SettingSchema> for WrittenSetting {
    fn from(setting: SettingSchema) -> Self {
        let kind = setting.kind.name();
        let (default, range, options) = match setting.kind {
            SettingKind::Bool { default } => (default.into(), None, Vec::new()),
            SettingKind::Int { default, range } => (default.into(), Some(range.into()), Vec::new()),
            SettingKind::Float { default, range } => {
                (default.into(), Some(range.into()), Vec::new())
            }
            SettingKind::Choice { default, options } => (default.into(), None, options),
            SettingKind::Colour { default } => (default.to_vec().into(), None, Vec::new()),
            SettingKind::Text { default } => (default.into(), None, Vec::new()),
            SettingKind::Action => (Value::Null, None, Vec::new()),
        };
        Self {
            id: setting.id,
            kind,
            default,
            range,
            options,
            label: setting.label,
            help: setting.help,
            group: setting.group,
            visible_if: setting.visible_if,
            cost: setting.cost,
            shortcut: setting.shortcut,
            value_shortcuts: setting.value_shortcuts,
        }
    }
}
