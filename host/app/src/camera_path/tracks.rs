//! Tracks: settings that change over time.
//!
//! Numbers go from one value to the next at an even pace, by equal factors where the schema's scale is logarithmic; whole
//! numbers are rounded. Colours go evenly in linear light. What has no values between (on and off, choices, texts) changes
//! at the key. Before the first key and after the last one the value stays.

use pointstage_engine::stage::{SettingValue, SettingValues};
use pointstage_plugin_api::settings_schema::{Scale, SettingKind, SettingSchema, ValueError};
use serde::{Deserialize, Deserializer, Serialize};

use super::check_times;

/// A setting over time, as a file holds it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SettingTrack {
    /// Id or alias of the renderer or structure; empty for the renderer that draws.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub(crate) owner: String,
    /// The setting's id.
    pub(crate) setting: String,
    /// Its values, in order.
    #[serde(deserialize_with = "keys")]
    pub(crate) keys: Vec<TrackKey>,
}

/// A value at its time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct TrackKey {
    /// Seconds.
    pub(crate) time: f64,
    /// The value, as `--set` and sessions take it.
    pub(crate) value: SettingValue,
}

/// A renderer or a structure that draws, whose settings tracks change.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drawer<'a> {
    /// Its id.
    pub(crate) id: &'a str,
    /// Its short name.
    pub(crate) alias: &'a str,
    /// Its settings.
    pub(crate) schema: &'a [SettingSchema],
    /// Whether it is the structure.
    pub(crate) is_structure: bool,
}

/// A track whose values are known to fit.
#[derive(Clone, Debug)]
pub(crate) struct Track {
    setting: SettingSchema,
    is_of_structure: bool,
    keys: Vec<TrackKey>,
}

/// A track with something that does not fit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("track {} ('{setting}'){}: {source}", track + 1, key_text(*key))]
pub(crate) struct TrackError {
    /// Which one, from 0.
    pub(crate) track: usize,
    /// Its setting.
    pub(crate) setting: String,
    /// Which of its keys, from 0; none if it is the track as a whole.
    pub(crate) key: Option<usize>,
    /// What is wrong.
    #[source]
    pub(crate) source: ValueError,
}

fn key_text(key: Option<usize>) -> String {
    key.map_or_else(String::new, |key| format!(", value {}", key + 1))
}

/// Values that differ from those that stay: of the renderer and of the structure.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ValuesAt {
    /// The renderer's.
    pub(crate) renderer: SettingValues,
    /// The structure's.
    pub(crate) structure: SettingValues,
}

/// The tracks of those that draw, checked against their settings, and the owners of the other tracks.
///
/// # Errors
/// A setting that its owner does not have; a value that it does not take.
pub(crate) fn resolve(
    tracks: &[SettingTrack],
    drawers: &[Drawer<'_>],
) -> Result<(Vec<Track>, Vec<String>), TrackError> {
    let (mut resolved, mut strangers) = (Vec::new(), Vec::new());
    for (index, track) in tracks.iter().enumerate() {
        let owner = track.owner.as_str();
        let is_owner = |drawer: &&Drawer<'_>| {
            (owner.is_empty() && !drawer.is_structure)
                || owner == drawer.id
                || owner == drawer.alias
        };
        let Some(drawer) = drawers.iter().find(is_owner) else {
            if !strangers.contains(&track.owner) {
                strangers.push(track.owner.clone());
            }
            continue;
        };
        let refused = |key, source| TrackError {
            track: index,
            setting: track.setting.clone(),
            key,
            source,
        };
        let setting = drawer
            .schema
            .iter()
            .find(|setting| setting.id == track.setting)
            .ok_or_else(|| refused(None, ValueError::unknown(&track.setting, drawer.schema)))?;
        let keys = track.keys.iter().enumerate().map(|(number, key)| {
            let value = setting
                .check(&key.value)
                .map_err(|error| refused(Some(number), error))?;
            Ok(TrackKey {
                time: key.time,
                value,
            })
        });
        resolved.push(Track {
            setting: setting.clone(),
            is_of_structure: drawer.is_structure,
            keys: keys.collect::<Result<Vec<_>, TrackError>>()?,
        });
    }
    Ok((resolved, strangers))
}

/// What the tracks say at a time, seconds.
pub(crate) fn values_at(tracks: &[Track], time: f64) -> ValuesAt {
    let mut all = ValuesAt::default();
    for track in tracks {
        let values = if track.is_of_structure {
            &mut all.structure
        } else {
            &mut all.renderer
        };
        if let Some(value) = track.at(time) {
            values.insert(track.setting.id.clone(), value);
        }
    }
    all
}

impl Track {
    /// The value at a time, seconds; none of a track without keys.
    fn at(&self, time: f64) -> Option<SettingValue> {
        let next = self.keys.partition_point(|key| key.time <= time);
        let after = self.keys.get(next);
        let Some(before) = next.checked_sub(1).and_then(|before| self.keys.get(before)) else {
            return after.map(|key| key.value.clone());
        };
        let Some(after) = after else {
            return Some(before.value.clone());
        };
        let part = (time - before.time) / (after.time - before.time);
        Some(between(
            &self.setting.kind,
            &before.value,
            &after.value,
            part,
        ))
    }
}

/// The value at the part `part` of the way.
fn between(kind: &SettingKind, from: &SettingValue, to: &SettingValue, part: f64) -> SettingValue {
    match (kind, from, to) {
        (SettingKind::Float { range, .. }, SettingValue::Float(from), SettingValue::Float(to)) => {
            SettingValue::Float(number(range.scale, *from, *to, part))
        }
        (SettingKind::Int { range, .. }, SettingValue::Int(from), SettingValue::Int(to)) => {
            let number = number(range.scale, *from as f64, *to as f64, part);
            // Between two whole numbers, so within the range that both are in.
            SettingValue::Int((number.round() as i64).clamp(*from.min(to), *from.max(to)))
        }
        (_, SettingValue::Colour(from), SettingValue::Colour(to)) => {
            SettingValue::Colour(std::array::from_fn(|channel| {
                number(Scale::Linear, from[channel], to[channel], part)
            }))
        }
        _ => from.clone(),
    }
}

/// Between two numbers: by equal differences, or by equal factors.
fn number(scale: Scale, from: f64, to: f64, part: f64) -> f64 {
    let between = if scale == Scale::Logarithmic && from > 0.0 && to > 0.0 {
        from * (to / from).powf(part)
    } else {
        from + (to - from) * part
    };
    between.clamp(from.min(to), from.max(to))
}

fn keys<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<TrackKey>, D::Error> {
    let keys = Vec::<TrackKey>::deserialize(deserializer)?;
    if keys.is_empty() {
        return Err(serde::de::Error::custom(
            "expected at least one value with its time, found none",
        ));
    }
    check_times(keys.iter().map(|key| key.time), "value")?;
    Ok(keys)
}

#[cfg(test)]
#[path = "tracks_tests.rs"]
mod tests;
