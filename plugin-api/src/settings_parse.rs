//! Reads the `settings` list of a manifest: each entry by itself, so that an error can name it.

use crate::nearest::{did_you_mean, nearest_names};
use crate::setting_value::SettingValue;
use crate::settings_schema::{
    ChoiceOption, NumberRange, Scale, SchemaError, SettingCost, SettingKind, SettingSchema,
    ValueShortcut, VisibleIf,
};
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeSet;

/// A setting as written: any field of any kind.
#[derive(Deserialize)]
struct RawSetting {
    #[serde(default)]
    id: String,
    kind: String,
    #[serde(default)]
    default: Value,
    #[serde(default)]
    min: Value,
    #[serde(default)]
    max: Value,
    #[serde(default)]
    soft_min: Value,
    #[serde(default)]
    soft_max: Value,
    #[serde(default)]
    step: Value,
    #[serde(default)]
    unit: String,
    #[serde(default)]
    scale: Scale,
    #[serde(default)]
    options: Vec<ChoiceOption>,
    #[serde(default)]
    label: String,
    #[serde(default)]
    help: String,
    #[serde(default)]
    group: String,
    #[serde(default)]
    visible_if: Option<RawCondition>,
    #[serde(default)]
    cost: SettingCost,
    #[serde(default)]
    shortcut: Option<String>,
    #[serde(default)]
    value_shortcuts: Vec<RawShortcut>,
}

#[derive(Deserialize)]
struct RawShortcut {
    key: String,
    value: Value,
}

#[derive(Deserialize)]
struct RawCondition {
    id: String,
    equals: Value,
}

/// The schemas of `entries`, without those of unknown kinds; or the faulty setting's name and what is wrong with it.
pub(crate) fn parse_settings(
    entries: &[Value],
) -> Result<Vec<SettingSchema>, (String, SchemaError)> {
    let mut settings: Vec<SettingSchema> = Vec::new();
    let mut conditions: Vec<(usize, RawCondition)> = Vec::new();
    let mut unknown_kinds: BTreeSet<String> = BTreeSet::new();
    for (index, entry) in entries.iter().enumerate() {
        let name = match entry.get("id").and_then(Value::as_str) {
            Some(id) if !id.is_empty() => id.to_owned(),
            _ => format!("#{}", index + 1),
        };
        let fail = |error| (name.clone(), error);
        let mut raw = RawSetting::deserialize(entry)
            .map_err(|error| fail(SchemaError::Form(error.to_string())))?;
        let good = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
        if raw.id.is_empty() || !raw.id.chars().all(good) {
            return Err(fail(SchemaError::Id));
        }
        if settings.iter().any(|other| other.id == raw.id) || unknown_kinds.contains(&raw.id) {
            return Err(fail(SchemaError::Duplicate));
        }
        let Some(kind) = parse_kind(&mut raw).map_err(fail)? else {
            unknown_kinds.insert(raw.id);
            continue;
        };
        if let Some(condition) = raw.visible_if {
            conditions.push((settings.len(), condition));
        }
        let label = if raw.label.is_empty() {
            raw.id.clone()
        } else {
            raw.label
        };
        let mut setting = SettingSchema {
            id: raw.id,
            kind,
            label,
            help: raw.help,
            group: raw.group,
            visible_if: None,
            cost: raw.cost,
            shortcut: raw.shortcut,
            value_shortcuts: Vec::new(),
        };
        setting.value_shortcuts = resolve_shortcuts(raw.value_shortcuts, &setting).map_err(fail)?;
        if let Some(default) = setting.default_value() {
            setting
                .check(&default)
                .map_err(|error| fail(SchemaError::Default(Box::new(error))))?;
        }
        settings.push(setting);
    }
    for (index, condition) in conditions {
        // A setting of an unknown kind has no value to compare with: what hangs on it is always shown.
        if unknown_kinds.contains(&condition.id) {
            continue;
        }
        let resolved = resolve_condition(condition, &settings)
            .map_err(|error| (settings[index].id.clone(), error))?;
        settings[index].visible_if = Some(resolved);
    }
    Ok(settings)
}

fn resolve_shortcuts(
    given: Vec<RawShortcut>,
    setting: &SettingSchema,
) -> Result<Vec<ValueShortcut>, SchemaError> {
    let resolve = |RawShortcut { key, value }: RawShortcut| {
        let given = SettingValue::deserialize(&value).map_err(|_| SchemaError::Type {
            field: "value_shortcuts.value",
            expected: "a value",
            found: value.to_string(),
        })?;
        match setting.check(&given) {
            Ok(value) => Ok(ValueShortcut { key, value }),
            Err(source) => Err(SchemaError::Shortcut {
                key,
                source: Box::new(source),
            }),
        }
    };
    given.into_iter().map(resolve).collect()
}

fn resolve_condition(
    condition: RawCondition,
    settings: &[SettingSchema],
) -> Result<VisibleIf, SchemaError> {
    let Some(other) = settings.iter().find(|other| other.id == condition.id) else {
        let ids = settings.iter().map(|setting| &setting.id);
        let hint = did_you_mean(&nearest_names(&condition.id, ids));
        return Err(SchemaError::UnknownCondition {
            id: condition.id,
            hint,
        });
    };
    let given = SettingValue::deserialize(&condition.equals).map_err(|_| SchemaError::Type {
        field: "visible_if.equals",
        expected: "a value",
        found: condition.equals.to_string(),
    })?;
    let equals = other
        .check(&given)
        .map_err(|error| SchemaError::Condition(Box::new(error)))?;
    Ok(VisibleIf {
        id: condition.id,
        equals,
    })
}

/// The kind, or none if this version does not know it.
fn parse_kind(raw: &mut RawSetting) -> Result<Option<SettingKind>, SchemaError> {
    let kind = match raw.kind.as_str() {
        "bool" => SettingKind::Bool {
            default: needed("bool", &raw.default, "true or false", Value::as_bool)?,
        },
        "int" => SettingKind::Int {
            default: needed("int", &raw.default, "a whole number", whole)?,
            range: parse_range(raw, "a whole number", whole)?,
        },
        "float" => SettingKind::Float {
            default: needed("float", &raw.default, "a number", Value::as_f64)?,
            range: parse_range(raw, "a number", Value::as_f64)?,
        },
        "choice" => {
            let mut options = std::mem::take(&mut raw.options);
            check_options(&mut options)?;
            let default = needed("choice", &raw.default, "an option's id", text)?;
            SettingKind::Choice { default, options }
        }
        "colour" => SettingKind::Colour {
            default: needed(
                "colour",
                &raw.default,
                "a list of 3 or 4 numbers (linear)",
                colour,
            )?,
        },
        "text" => SettingKind::Text {
            default: match &raw.default {
                Value::Null => String::new(),
                given => needed("text", given, "a text", text)?,
            },
        },
        "action" => SettingKind::Action,
        _ => return Ok(None),
    };
    Ok(Some(kind))
}

fn needed<T>(
    kind: &'static str,
    default: &Value,
    expected: &'static str,
    read: impl Fn(&Value) -> Option<T>,
) -> Result<T, SchemaError> {
    if default.is_null() {
        return Err(SchemaError::Missing {
            kind,
            field: "default",
        });
    }
    read(default).ok_or_else(|| SchemaError::Type {
        field: "default",
        expected,
        found: default.to_string(),
    })
}

fn parse_range<T: PartialOrd + Copy + Default + std::fmt::Display>(
    raw: &mut RawSetting,
    expected: &'static str,
    read: impl Fn(&Value) -> Option<T>,
) -> Result<NumberRange<T>, SchemaError> {
    let number = |field: &'static str, value: &Value| match value {
        Value::Null => Ok(None),
        given => read(given).map(Some).ok_or_else(|| SchemaError::Type {
            field,
            expected,
            found: given.to_string(),
        }),
    };
    let range = NumberRange {
        min: number("min", &raw.min)?,
        max: number("max", &raw.max)?,
        soft_min: number("soft_min", &raw.soft_min)?,
        soft_max: number("soft_max", &raw.soft_max)?,
        step: number("step", &raw.step)?,
        unit: std::mem::take(&mut raw.unit),
        scale: raw.scale,
    };
    let ordered = [
        ("min", range.min, "max", range.max),
        ("min", range.min, "soft_min", range.soft_min),
        ("soft_min", range.soft_min, "soft_max", range.soft_max),
        ("soft_max", range.soft_max, "max", range.max),
    ];
    for (low_name, low, high_name, high) in ordered {
        if let (Some(low), Some(high)) = (low, high)
            && low > high
        {
            return Err(SchemaError::Range(format!(
                "'{low_name}' {low} is above '{high_name}' {high}"
            )));
        }
    }
    if range.step.is_some_and(|step| step <= T::default()) {
        return Err(SchemaError::Range("'step' must be above 0".to_owned()));
    }
    let least = range.soft_min.or(range.min);
    if range.scale == Scale::Logarithmic && !least.is_some_and(|least| least > T::default()) {
        return Err(SchemaError::Range(
            "a logarithmic scale needs 'min' or 'soft_min' above 0".to_owned(),
        ));
    }
    Ok(range)
}

fn check_options(options: &mut [ChoiceOption]) -> Result<(), SchemaError> {
    if options.is_empty() {
        return Err(SchemaError::Missing {
            kind: "choice",
            field: "options",
        });
    }
    let mut ids = BTreeSet::new();
    for option in options {
        if option.id.is_empty() {
            return Err(SchemaError::Options("an option has an empty id".to_owned()));
        }
        if !ids.insert(option.id.clone()) {
            return Err(SchemaError::Options(format!(
                "option '{}' appears twice",
                option.id
            )));
        }
        if option.label.is_empty() {
            option.label.clone_from(&option.id);
        }
    }
    Ok(())
}

fn whole(value: &Value) -> Option<i64> {
    // 3.0 is a whole number too; beyond 2^53 a float no longer names one.
    let from_float =
        |number: f64| (number.fract() == 0.0 && number.abs() < 9.007e15).then_some(number as i64);
    value
        .as_i64()
        .or_else(|| value.as_f64().and_then(from_float))
}

fn text(value: &Value) -> Option<String> {
    value.as_str().map(str::to_owned)
}

fn colour(value: &Value) -> Option<[f64; 4]> {
    let channels: Vec<f64> = value
        .as_array()?
        .iter()
        .map(Value::as_f64)
        .collect::<Option<_>>()?;
    match channels[..] {
        [r, g, b] => Some([r, g, b, 1.0]),
        [r, g, b, a] => Some([r, g, b, a]),
        _ => None,
    }
}
