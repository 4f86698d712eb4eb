//! The values of a setting.

use std::str::FromStr;

use pointstage_plugin_api::settings_schema::{Scale, SettingKind, SettingSchema};

/// `ID=FROM:TO:COUNT` or `ID=A,B,…`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SetRange {
    /// The setting.
    pub(super) id: String,
    values: Values,
}

#[derive(Clone, Debug, PartialEq)]
enum Values {
    Steps { from: f64, to: f64, count: usize },
    List(Vec<String>),
}

/// Most values: each is a renderer with its pictures.
const MOST: usize = 200;

impl FromStr for SetRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || {
            format!(
                "expected ID=FROM:TO:COUNT with a COUNT from 2 to {MOST}, such as splat_scale=0.5:2:9, or ID=A,B,… with values \
                 of the setting"
            )
        };
        let (id, values) = text.split_once('=').ok_or_else(expected)?;
        let parts: Vec<&str> = values.split(':').map(str::trim).collect();
        let values = match *parts.as_slice() {
            [from, to, count] => {
                let number =
                    |text: &str| text.parse::<f64>().ok().filter(|number| number.is_finite());
                let steps = Values::Steps {
                    from: number(from).ok_or_else(expected)?,
                    to: number(to).ok_or_else(expected)?,
                    count: count.parse().map_err(|_| expected())?,
                };
                match steps {
                    Values::Steps {
                        count: 2..=MOST, ..
                    } => steps,
                    _ => return Err(expected()),
                }
            }
            [list] => {
                let list: Vec<String> = list
                    .split(',')
                    .map(|value| value.trim().to_owned())
                    .collect();
                if list.len() > MOST || list.iter().any(String::is_empty) {
                    return Err(expected());
                }
                Values::List(list)
            }
            _ => return Err(expected()),
        };
        let id = id.trim().to_owned();
        if id.is_empty() {
            return Err(expected());
        }
        Ok(Self { id, values })
    }
}

impl SetRange {
    /// The values as the command line would write them, each once.
    ///
    /// # Errors
    /// When steps are asked for of a setting that is no number, or that cannot be taken in factors.
    pub(super) fn texts(&self, setting: &SettingSchema) -> Result<Vec<String>, String> {
        let (from, to, count) = match &self.values {
            Values::List(list) => {
                return Ok(each_once(list.iter().cloned()));
            }
            Values::Steps { from, to, count } => (*from, *to, *count),
        };
        let (is_whole, scale) = match &setting.kind {
            SettingKind::Int { range, .. } => (true, range.scale),
            SettingKind::Float { range, .. } => (false, range.scale),
            _ => {
                return Err(format!(
                    "setting '{}' is no number and has no steps; name its values: {}=A,B,…",
                    self.id, self.id
                ));
            }
        };
        if scale == Scale::Logarithmic && !(from > 0.0 && to > 0.0) {
            return Err(format!(
                "setting '{}' goes in factors, so its values must be above 0",
                self.id
            ));
        }
        let at = |index: usize| {
            let part = index as f64 / (count - 1) as f64;
            match scale {
                Scale::Linear => from + (to - from) * part,
                Scale::Logarithmic => from * (to / from).powf(part),
            }
        };
        let text = |value: f64| {
            if is_whole {
                return format!("{value:.0}");
            }
            // Without the noise of the last bits.
            let digits = 5 - value.abs().max(1e-12).log10().floor() as i32;
            let factor = 10_f64.powi(digits);
            format!("{}", (value * factor).round() / factor)
        };
        Ok(each_once((0..count).map(|index| text(at(index)))))
    }
}

/// What is there several times stays where it is first.
fn each_once(texts: impl Iterator<Item = String>) -> Vec<String> {
    let mut kept: Vec<String> = Vec::new();
    for text in texts {
        if !kept.contains(&text) {
            kept.push(text);
        }
    }
    kept
}

/// The setting's unit; empty for none.
pub(super) fn unit(setting: &SettingSchema) -> &str {
    match &setting.kind {
        SettingKind::Int { range, .. } => &range.unit,
        SettingKind::Float { range, .. } => &range.unit,
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pointstage_plugin_api::settings_schema::NumberRange;

    fn setting(kind: SettingKind) -> SettingSchema {
        SettingSchema {
            id: "a".to_owned(),
            kind,
            label: String::new(),
            help: String::new(),
            group: String::new(),
            visible_if: None,
            cost: pointstage_plugin_api::settings_schema::SettingCost::Redraw,
            shortcut: None,
            value_shortcuts: Vec::new(),
        }
    }

    fn range<T>(scale: Scale) -> NumberRange<T> {
        NumberRange {
            min: None,
            max: None,
            soft_min: None,
            soft_max: None,
            step: None,
            unit: "px".to_owned(),
            scale,
        }
    }

    fn float(scale: Scale) -> SettingSchema {
        setting(SettingKind::Float {
            default: 1.0,
            range: range(scale),
        })
    }

    fn texts(text: &str, setting: &SettingSchema) -> Result<Vec<String>, String> {
        SetRange::from_str(text)
            .expect("well formed")
            .texts(setting)
    }

    #[test]
    fn steps_are_equal_or_equal_factors_as_the_setting_has_it() {
        let linear = texts("a=0:1:5", &float(Scale::Linear)).expect("numbers");
        assert_eq!(linear, ["0", "0.25", "0.5", "0.75", "1"]);
        let factors = texts("a=0.5:2:3", &float(Scale::Logarithmic)).expect("numbers");
        assert_eq!(factors, ["0.5", "1", "2"]);
        let error = texts("a=0:2:3", &float(Scale::Logarithmic)).expect_err("no factor leads to 0");
        assert!(error.contains("above 0"), "{error}");
    }

    #[test]
    fn whole_numbers_stand_once_and_other_kinds_are_named() {
        let whole = setting(SettingKind::Int {
            default: 1,
            range: range(Scale::Linear),
        });
        assert_eq!(texts("a=1:2:5", &whole).expect("numbers"), ["1", "2"]);
        let switch = setting(SettingKind::Bool { default: true });
        assert_eq!(
            texts("a=true,false,true", &switch).expect("named"),
            ["true", "false"]
        );
        let error = texts("a=0:1:2", &switch).expect_err("no number");
        assert!(error.contains("name its values"), "{error}");
    }

    #[test]
    fn what_is_no_range_says_what_is_one() {
        for bad in [
            "a",
            "=1,2",
            "a=1:2",
            "a=1:2:1",
            "a=1:x:3",
            "a=1,,2",
            "a=NaN:1:3",
            "a=1:2:999",
        ] {
            let error = SetRange::from_str(bad).expect_err(bad);
            assert!(error.contains("splat_scale=0.5:2:9"), "{bad}: {error}");
        }
    }
}
