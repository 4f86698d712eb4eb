//! What the window remembers from one session to the next, in `settings.toml` of the state folder.
//!
//! [`Preferences`] is the content: plain data, every field with a default, so that files of older programs are read and
//! unknown fields are ignored. [`mod@file`] reads it at start and sets a damaged file aside; [`keeper`] writes it after changes,
//! whole and off the window's thread. Of two windows that are open at once, the last change counts.

mod file;
mod keeper;
mod recent;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::path::PathBuf;

use pointstage_engine::stage::SettingValues;
use pointstage_scene::{Lights, Material};
use serde::{Deserialize, Deserializer, Serialize};

pub(crate) use file::{Opened, open, plugin_folders};
pub(crate) use keeper::Keeper;
pub(crate) use recent::Recent;

use crate::session_file::Renderers;
use crate::toml_form::{self, Look, StoredView};
use crate::window::{FLY_SPEEDS, NavigationOptions};

/// The format that this program writes and reads.
const FORMAT: u32 = 1;

/// Smallest and largest size of texts and widgets, as a factor of the usual.
pub(crate) const TEXT_SCALE_RANGE: [f32; 2] = [0.75, 2.0];

/// What is remembered.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Preferences {
    /// Always [`FORMAT`].
    pub(crate) format: u32,
    /// Light or dark.
    pub(crate) theme: Theme,
    /// Size of texts and widgets, as a factor; within [`TEXT_SCALE_RANGE`].
    #[serde(deserialize_with = "text_scale")]
    pub(crate) text_scale: f32,
    /// Files that were opened, newest first.
    pub(crate) recent: Recent,
    /// Folders that are searched for plugins beside the usual ones.
    pub(crate) plugin_folders: Vec<PathBuf>,
    /// Which parts of the window are open.
    pub(crate) window: Layout,
    /// Who draws.
    pub(crate) renderers: Renderers,
    /// How a picture is shown.
    pub(crate) look: Look,
    /// The lights.
    #[serde(deserialize_with = "toml_form::lights")]
    pub(crate) lights: Lights,
    /// How new objects take light.
    #[serde(deserialize_with = "toml_form::material")]
    pub(crate) material: Material,
    /// Values that differ from the default, by the id of the renderer or structure.
    pub(crate) settings: BTreeMap<String, SettingValues>,
    /// Named presets, by renderer id.
    pub(crate) presets: BTreeMap<String, BTreeMap<String, SettingValues>>,
    /// The preset that a renderer's values come from, by renderer id.
    pub(crate) active_presets: BTreeMap<String, String>,
    /// How the camera answers to pointer and keys.
    #[serde(deserialize_with = "navigation")]
    pub(crate) navigation: NavigationOptions,
    /// How often pictures are drawn, and how long moving ones may take.
    pub(crate) pacing: Pacing,
    /// Views to go back to.
    pub(crate) views: Vec<StoredView>,
}

/// How often pictures are drawn, and how long moving ones may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Pacing {
    /// Most pictures a second; absent for no limit.
    #[serde(
        skip_serializing_if = "Option::is_none",
        deserialize_with = "rate_limit"
    )]
    pub(crate) rate_limit: Option<u32>,
    /// Pictures a second that a moving view should reach; absent for all pixels always.
    #[serde(
        skip_serializing_if = "Option::is_none",
        deserialize_with = "target_rate"
    )]
    pub(crate) target_rate: Option<u32>,
    /// Whether pictures fade into one another when renderers change places.
    pub(crate) cross_fade: bool,
}

impl Default for Pacing {
    fn default() -> Self {
        Self {
            rate_limit: None,
            target_rate: None,
            cross_fade: true,
        }
    }
}

/// Light or dark.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Theme {
    /// As the system says.
    #[default]
    System,
    /// Dark on light.
    Light,
    /// Light on dark.
    Dark,
}

/// Which parts of the window are open. How wide they are, the toolkit remembers in `window.ron`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Layout {
    /// The settings panel.
    pub(crate) settings: bool,
    /// The log.
    pub(crate) log: bool,
    /// The tab of the settings panel, by its title in small letters.
    pub(crate) tab: String,
    /// The inspector.
    pub(crate) inspector: bool,
}

impl Default for Layout {
    fn default() -> Self {
        Self {
            settings: true,
            log: false,
            tab: "renderer".to_owned(),
            inspector: false,
        }
    }
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            format: FORMAT,
            theme: Theme::default(),
            text_scale: 1.0,
            recent: Recent::default(),
            plugin_folders: Vec::new(),
            window: Layout::default(),
            renderers: Renderers::default(),
            look: Look::default(),
            lights: Lights::default(),
            material: Material::default(),
            navigation: NavigationOptions::default(),
            active_presets: BTreeMap::new(),
            pacing: Pacing::default(),
            settings: BTreeMap::new(),
            presets: BTreeMap::new(),
            views: Vec::new(),
        }
    }
}

/// The fastest rate that a limit or a target may name, pictures a second.
const FASTEST_RATE: u32 = 60;

fn navigation<'de, D: Deserializer<'de>>(deserializer: D) -> Result<NavigationOptions, D::Error> {
    let options = NavigationOptions::deserialize(deserializer)?;
    if FLY_SPEEDS.contains(&options.fly_speed) {
        Ok(options)
    } else {
        let (least, most, found) = (FLY_SPEEDS.start(), FLY_SPEEDS.end(), options.fly_speed);
        Err(serde::de::Error::custom(format!(
            "fly_speed: expected a factor from {least} to {most}, found {found}"
        )))
    }
}

fn rate_limit<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<u32>, D::Error> {
    rate_from(0, deserializer)
}

fn target_rate<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<u32>, D::Error> {
    rate_from(1, deserializer)
}

fn rate_from<'de, D: Deserializer<'de>>(
    least: u32,
    deserializer: D,
) -> Result<Option<u32>, D::Error> {
    let rate = u32::deserialize(deserializer)?;
    if (least..=FASTEST_RATE).contains(&rate) {
        Ok(Some(rate))
    } else {
        Err(serde::de::Error::custom(format!(
            "expected pictures a second from {least} to {FASTEST_RATE}, found {rate}"
        )))
    }
}

fn text_scale<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f32, D::Error> {
    let scale = f32::deserialize(deserializer)?;
    let [least, most] = TEXT_SCALE_RANGE;
    if (least..=most).contains(&scale) {
        Ok(scale)
    } else {
        Err(serde::de::Error::custom(format!(
            "expected a factor from {least} to {most}, found {scale}"
        )))
    }
}
