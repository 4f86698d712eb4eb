//! A setting's value: its forms in JSON and on the command line, and the check against its schema.

use crate::nearest::{did_you_mean, nearest_names};
use crate::settings_schema::{SettingKind, SettingSchema};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A setting's value, as the host keeps it.
///
/// Its serde form is plain (`true`, `3`, `3.5`, `"auto"`, `[1, 0, 0, 1]`), so a file does not tell choices from texts or
/// whole floats from integers: [`SettingSchema::check`] puts that right.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum SettingValue {
    /// On or off.
    Bool(bool),
    /// A whole number.
    Int(i64),
    /// A number.
    Float(f64),
    /// The id of an option.
    Choice(String),
    /// Linear red, green, blue, alpha.
    Colour([f64; 4]),
    /// Any text.
    Text(String),
}

/// Values by setting id. What is absent takes the schema's default.
pub type SettingValues = BTreeMap<String, SettingValue>;

/// Why a value is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ValueError {
    /// The value is of another kind.
    #[error("setting '{id}': expected {expected}, found '{found}'")]
    Kind {
        /// The setting.
        id: String,
        /// What it takes, in words.
        expected: String,
        /// What was given.
        found: String,
    },
    /// The number is outside the hard range.
    #[error("setting '{id}': {found} is outside {range}; the nearest is {nearest}")]
    Range {
        /// The setting.
        id: String,
        /// What was given.
        found: String,
        /// The hard range with its unit.
        range: String,
        /// The end of the range that is nearest.
        nearest: String,
    },
    /// No option has this id.
    #[error("setting '{id}' has no option '{found}'{hint}; it takes {options}")]
    Option {
        /// The setting.
        id: String,
        /// What was given.
        found: String,
        /// The options, in the schema's order.
        options: String,
        /// The nearest options, if any is near.
        hint: String,
    },
    /// An action is pressed, not set.
    #[error("setting '{id}' is an action: it has no value, it is pressed")]
    Action {
        /// The setting.
        id: String,
    },
    /// No setting has this id.
    #[error("no setting '{id}'{hint}")]
    Unknown {
        /// The id that was given.
        id: String,
        /// The nearest ids, if any is near; else all of them.
        hint: String,
    },
}

impl ValueError {
    /// The error for an id that is in none of `settings`.
    pub fn unknown(id: &str, settings: &[SettingSchema]) -> Self {
        let ids = || settings.iter().map(|setting| setting.id.as_str());
        let near = nearest_names(id, ids());
        let hint = if !near.is_empty() {
            did_you_mean(&near)
        } else if settings.is_empty() {
            "; there are no settings".to_owned()
        } else {
            format!("; there are {}", ids().collect::<Vec<_>>().join(", "))
        };
        Self::Unknown {
            id: id.to_owned(),
            hint,
        }
    }
}

impl std::fmt::Display for SettingValue {
    /// The text that [`SettingSchema::parse_text`] reads back.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Bool(value) => write!(f, "{value}"),
            Self::Int(value) => write!(f, "{value}"),
            Self::Float(value) => write!(f, "{value}"),
            Self::Choice(text) | Self::Text(text) => f.write_str(text),
            Self::Colour([r, g, b, a]) => write!(f, "{r},{g},{b},{a}"),
        }
    }
}

impl SettingSchema {
    /// The value that `text` means: the form of the command line's `--set id=value`.
    ///
    /// Booleans are true/false, on/off, yes/no or 1/0; colours are `#rrggbb` or `#rrggbbaa` (sRGB) or linear `r,g,b` or
    /// `r,g,b,a`.
    pub fn parse_text(&self, text: &str) -> Result<SettingValue, ValueError> {
        let trimmed = text.trim();
        let value = match &self.kind {
            SettingKind::Bool { .. } => match trimmed.to_ascii_lowercase().as_str() {
                "true" | "on" | "yes" | "1" => Some(SettingValue::Bool(true)),
                "false" | "off" | "no" | "0" => Some(SettingValue::Bool(false)),
                _ => None,
            },
            SettingKind::Int { .. } => trimmed.parse().ok().map(SettingValue::Int),
            SettingKind::Float { .. } => trimmed.parse().ok().map(SettingValue::Float),
            SettingKind::Choice { .. } => Some(SettingValue::Choice(trimmed.to_owned())),
            SettingKind::Colour { .. } => parse_colour(trimmed).map(SettingValue::Colour),
            SettingKind::Text { .. } => Some(SettingValue::Text(text.to_owned())),
            SettingKind::Action => {
                return Err(ValueError::Action {
                    id: self.id.clone(),
                });
            }
        };
        self.check(&value.ok_or_else(|| self.wrong_kind(&text))?)
    }

    /// `value` in the setting's own kind and inside its hard range.
    ///
    /// A whole float stands for an integer and the reverse, a text for a choice and the reverse.
    pub fn check(&self, value: &SettingValue) -> Result<SettingValue, ValueError> {
        let checked = match (&self.kind, value) {
            (SettingKind::Action, _) => {
                return Err(ValueError::Action {
                    id: self.id.clone(),
                });
            }
            (SettingKind::Bool { .. }, SettingValue::Bool(on)) => SettingValue::Bool(*on),
            (SettingKind::Int { range, .. }, _) => {
                let number = as_int(value).ok_or_else(|| self.wrong_kind(value))?;
                if let Some(nearest) = outside(number, range.min, range.max) {
                    return Err(self.out_of_range(&number, &range.in_words(), &nearest));
                }
                SettingValue::Int(number)
            }
            (SettingKind::Float { range, .. }, _) => {
                let number = as_float(value).ok_or_else(|| self.wrong_kind(value))?;
                if let Some(nearest) = outside(number, range.min, range.max) {
                    return Err(self.out_of_range(&number, &range.in_words(), &nearest));
                }
                SettingValue::Float(number)
            }
            (
                SettingKind::Choice { options, .. },
                SettingValue::Choice(text) | SettingValue::Text(text),
            ) => {
                let ids = || options.iter().map(|option| option.id.as_str());
                if !ids().any(|id| id == text) {
                    return Err(ValueError::Option {
                        id: self.id.clone(),
                        found: text.clone(),
                        options: ids().collect::<Vec<_>>().join(", "),
                        hint: did_you_mean(&nearest_names(text, ids())),
                    });
                }
                SettingValue::Choice(text.clone())
            }
            (SettingKind::Colour { .. }, SettingValue::Colour(rgba))
                if rgba.iter().all(|channel| channel.is_finite()) =>
            {
                SettingValue::Colour(*rgba)
            }
            (SettingKind::Text { .. }, SettingValue::Text(text) | SettingValue::Choice(text)) => {
                SettingValue::Text(text.clone())
            }
            _ => return Err(self.wrong_kind(value)),
        };
        Ok(checked)
    }

    /// The default; none for an action.
    pub fn default_value(&self) -> Option<SettingValue> {
        Some(match &self.kind {
            SettingKind::Bool { default } => SettingValue::Bool(*default),
            SettingKind::Int { default, .. } => SettingValue::Int(*default),
            SettingKind::Float { default, .. } => SettingValue::Float(*default),
            SettingKind::Choice { default, .. } => SettingValue::Choice(default.clone()),
            SettingKind::Colour { default } => SettingValue::Colour(*default),
            SettingKind::Text { default } => SettingValue::Text(default.clone()),
            SettingKind::Action => return None,
        })
    }

    /// Whether the panel shows this setting while the others have `values`.
    pub fn is_visible(&self, settings: &[SettingSchema], values: &SettingValues) -> bool {
        let Some(condition) = &self.visible_if else {
            return true;
        };
        let value = values.get(&condition.id).cloned().or_else(|| {
            let other = settings.iter().find(|other| other.id == condition.id)?;
            other.default_value()
        });
        value.as_ref() == Some(&condition.equals)
    }

    fn wrong_kind(&self, found: &dyn ToString) -> ValueError {
        ValueError::Kind {
            id: self.id.clone(),
            expected: self.kind.in_words(),
            found: found.to_string(),
        }
    }

    fn out_of_range(
        &self,
        found: &dyn ToString,
        range: &str,
        nearest: &dyn ToString,
    ) -> ValueError {
        ValueError::Range {
            id: self.id.clone(),
            found: found.to_string(),
            range: range.to_owned(),
            nearest: nearest.to_string(),
        }
    }
}

/// A full snapshot of `settings`: the checked `values`, and defaults for what is absent. Actions are left out.
pub fn snapshot(
    settings: &[SettingSchema],
    values: &SettingValues,
) -> Result<SettingValues, ValueError> {
    if let Some(id) = values
        .keys()
        .find(|id| settings.iter().all(|known| known.id != **id))
    {
        return Err(ValueError::unknown(id, settings));
    }
    let mut all = SettingValues::new();
    for setting in settings {
        let value = match values.get(&setting.id) {
            Some(value) => Some(setting.check(value)?),
            None => setting.default_value(),
        };
        if let Some(value) = value {
            all.insert(setting.id.clone(), value);
        }
    }
    Ok(all)
}

/// The nearest end of `min..=max`, if `number` is outside.
fn outside<T: PartialOrd + Copy>(number: T, min: Option<T>, max: Option<T>) -> Option<T> {
    let below = min.filter(|min| number < *min);
    below.or_else(|| max.filter(|max| number > *max))
}

fn as_int(value: &SettingValue) -> Option<i64> {
    match value {
        SettingValue::Int(number) => Some(*number),
        // 2^53: from there on a float no longer names one integer.
        SettingValue::Float(number) if number.fract() == 0.0 && number.abs() < 9.007e15 => {
            Some(*number as i64)
        }
        _ => None,
    }
}

fn as_float(value: &SettingValue) -> Option<f64> {
    match value {
        SettingValue::Float(number) if number.is_finite() => Some(*number),
        SettingValue::Int(number) => Some(*number as f64),
        _ => None,
    }
}

/// Linear RGBA from `#rrggbb`, `#rrggbbaa` (sRGB) or `r,g,b`, `r,g,b,a` (linear).
fn parse_colour(text: &str) -> Option<[f64; 4]> {
    if let Some(hex) = text.strip_prefix('#') {
        if !matches!(hex.len(), 6 | 8) || !hex.bytes().all(|byte| byte.is_ascii_hexdigit()) {
            return None;
        }
        let byte = |at: usize| u8::from_str_radix(hex.get(at..at + 2)?, 16).ok();
        let alpha = if hex.len() == 8 { byte(6)? } else { 255 };
        let linear = |byte: u8| linear_from_srgb(f64::from(byte) / 255.0);
        return Some([
            linear(byte(0)?),
            linear(byte(2)?),
            linear(byte(4)?),
            f64::from(alpha) / 255.0,
        ]);
    }
    let parts: Vec<f64> = text
        .split(',')
        .map(|part| part.trim().parse().ok())
        .collect::<Option<_>>()?;
    match parts[..] {
        [r, g, b] => Some([r, g, b, 1.0]),
        [r, g, b, a] => Some([r, g, b, a]),
        _ => None,
    }
}

/// IEC 61966-2-1, both in 0..1.
fn linear_from_srgb(encoded: f64) -> f64 {
    if encoded <= 0.04045 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

#[cfg(test)]
#[path = "setting_value_tests.rs"]
mod tests;
