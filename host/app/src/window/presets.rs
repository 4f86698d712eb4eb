//! Named presets: sets of a renderer's values under names that the user gives. Plain data with the rules for it.

use std::collections::BTreeMap;

use pointstage_engine::stage::{SettingValue, SettingValues};
use pointstage_plugin_api::settings_schema::SettingSchema;

use super::session::Session;

/// Presets by renderer id, then by name: values that differ from the defaults.
pub(crate) type Presets = BTreeMap<String, BTreeMap<String, SettingValues>>;

/// The preset that was chosen or saved last, by renderer id; none is the built-in one.
pub(crate) type ActivePresets = BTreeMap<String, String>;

/// The preset that every renderer has: no value differs from its default.
pub(crate) const DEFAULTS: &str = "Defaults";

/// The longest name, letters: it must fit a list.
const LONGEST_NAME: usize = 60;

/// Why a name cannot be given to a preset.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum PresetNameError {
    /// Nothing but spaces.
    #[error("a preset needs a name")]
    Empty,
    /// Longer than [`LONGEST_NAME`].
    #[error("the name has {0} letters, it may have {LONGEST_NAME}")]
    Long(usize),
    /// The name of the built-in preset.
    #[error("'{DEFAULTS}' is built in; choose another name")]
    BuiltIn,
    /// Renaming must not take another preset away.
    #[error("there is a preset '{0}' already; delete it first, or choose another name")]
    Taken(String),
}

/// The name as it is kept: without spaces around it.
pub(crate) fn checked_name(name: &str) -> Result<String, PresetNameError> {
    let name = name.trim();
    let length = name.chars().count();
    if name.is_empty() {
        return Err(PresetNameError::Empty);
    }
    if length > LONGEST_NAME {
        return Err(PresetNameError::Long(length));
    }
    if name.eq_ignore_ascii_case(DEFAULTS) {
        return Err(PresetNameError::BuiltIn);
    }
    Ok(name.to_owned())
}

/// What the panel shows of a renderer's presets.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct PresetList {
    /// Names in order, without the built-in one.
    pub(crate) names: Vec<String>,
    /// The preset that the values come from.
    pub(crate) active: String,
    /// Whether the values are no longer those of the active one.
    pub(crate) differs: bool,
}

/// The presets of a renderer, and what its present values have to do with them.
pub(crate) fn list(session: &Session, owner: &str) -> PresetList {
    let none = BTreeMap::new();
    let named = session.presets.get(owner).unwrap_or(&none);
    let values = session.settings_of(owner);
    let chosen = session.panes.active.active_presets.get(owner);
    let chosen = chosen.filter(|name| named.contains_key(*name));
    // After a start nobody has chosen one yet; the values may still be those of one.
    let same = || named.iter().find(|(_, preset)| **preset == values);
    let active = match chosen {
        Some(name) => name.clone(),
        None if values.is_empty() => DEFAULTS.to_owned(),
        None => same().map_or(DEFAULTS.to_owned(), |(name, _)| name.clone()),
    };
    let differs = named
        .get(&active)
        .map_or(!values.is_empty(), |preset| *preset != values);
    PresetList {
        names: named.keys().cloned().collect(),
        active,
        differs,
    }
}

/// Keeps the renderer's present values under `name`, over what stood there, and makes that the active preset.
///
/// # Errors
/// When the name is not one.
pub(crate) fn save(session: &mut Session, owner: &str, name: &str) -> Result<(), PresetNameError> {
    let name = checked_name(name)?;
    let values = session.settings_of(owner);
    let named = session.presets.entry(owner.to_owned()).or_default();
    named.insert(name.clone(), values);
    session
        .panes
        .active
        .active_presets
        .insert(owner.to_owned(), name);
    Ok(())
}

/// Gives the renderer the values of a preset, as far as its `schema` takes them; says what it does not take.
///
/// A name that is not there is the built-in one.
pub(crate) fn choose(
    session: &mut Session,
    owner: &str,
    name: &str,
    schema: &[SettingSchema],
) -> Vec<String> {
    let named = session.presets.get(owner);
    let Some(preset) = named.and_then(|named| named.get(name)) else {
        session.panes.active.settings.remove(owner);
        session.panes.active.active_presets.remove(owner);
        return Vec::new();
    };
    let fitted = fit(preset, schema);
    session
        .panes
        .active
        .settings
        .insert(owner.to_owned(), fitted.values);
    let active = session
        .panes
        .active
        .active_presets
        .entry(owner.to_owned())
        .or_default();
    name.clone_into(active);
    fitted.refused
}

/// Gives the preset `name` the name `to`.
///
/// # Errors
/// When `to` is not a name, or another preset's.
pub(crate) fn rename(
    session: &mut Session,
    owner: &str,
    name: &str,
    to: &str,
) -> Result<(), PresetNameError> {
    let to = checked_name(to)?;
    let Some(named) = session.presets.get_mut(owner) else {
        return Ok(());
    };
    if to == name {
        return Ok(());
    }
    if named.contains_key(&to) {
        return Err(PresetNameError::Taken(to));
    }
    let Some(values) = named.remove(name) else {
        return Ok(());
    };
    named.insert(to.clone(), values);
    let active = session.panes.active.active_presets.get_mut(owner);
    if let Some(active) = active.filter(|active| **active == *name) {
        *active = to;
    }
    Ok(())
}

/// Forgets a preset. The renderer's values stay as they are.
pub(crate) fn delete(session: &mut Session, owner: &str, name: &str) {
    if let Some(named) = session.presets.get_mut(owner) {
        named.remove(name);
        if named.is_empty() {
            session.presets.remove(owner);
        }
    }
    let active = session.panes.active.active_presets.get(owner);
    if active.is_some_and(|active| active == name) {
        session.panes.active.active_presets.remove(owner);
    }
}

/// What came of giving a renderer values that were made for another one, or for an older version of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Fitted {
    /// Values that fit, as the target's own kinds. Those that are its defaults are left out.
    pub(crate) values: SettingValues,
    /// Ids of the settings whose values fit, in the schema's order.
    pub(crate) taken: Vec<String>,
    /// Why others were not, one sentence each.
    pub(crate) refused: Vec<String>,
}

/// The part of `values` that `schema` takes. Settings that it does not have are passed over in silence.
pub(crate) fn fit(values: &SettingValues, schema: &[SettingSchema]) -> Fitted {
    let mut fitted = Fitted::default();
    for setting in schema {
        let Some(value) = values.get(&setting.id) else {
            continue;
        };
        match setting.check(value) {
            Ok(value) => {
                fitted.taken.push(setting.id.clone());
                if setting.default_value().as_ref() != Some(&value) {
                    fitted.values.insert(setting.id.clone(), value);
                }
            }
            Err(error) => fitted.refused.push(error.to_string()),
        }
    }
    fitted
}

/// Every setting of `from` that `to` has by the same id, with its present value: what copying would offer.
pub(crate) fn shared_values(
    from: &[SettingSchema],
    values: &SettingValues,
    to: &[SettingSchema],
) -> SettingValues {
    let shared = from
        .iter()
        .filter(|setting| to.iter().any(|other| other.id == setting.id));
    let value_of = |setting: &SettingSchema| -> Option<SettingValue> {
        values
            .get(&setting.id)
            .cloned()
            .or_else(|| setting.default_value())
    };
    shared
        .filter_map(|setting| Some((setting.id.clone(), value_of(setting)?)))
        .collect()
}

#[cfg(test)]
#[path = "presets_tests.rs"]
mod tests;
