//! How a picture is shown, as files hold it.

use pointstage_engine::stage::{Background, Show};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::positive;

/// Dark above, darker below: both light and dark scans stand out. sRGB.
pub(crate) const DEFAULT_BACKGROUND: Background =
    Background::Gradient([0.30, 0.33, 0.37], [0.09, 0.10, 0.12]);

/// How a picture is shown, whatever the renderer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Look {
    /// `colours`, or the key of a target.
    #[serde(serialize_with = "write_show", deserialize_with = "read_show")]
    pub(crate) show: Show,
    /// What lies behind; sRGB, 0..1.
    #[serde(deserialize_with = "read_background")]
    pub(crate) background: Background,
    /// Factor on linear colours.
    #[serde(deserialize_with = "positive")]
    pub(crate) exposure: f32,
    /// Factor on every radius.
    #[serde(deserialize_with = "positive")]
    pub(crate) radius_scale: f32,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            show: Show::Colours,
            background: DEFAULT_BACKGROUND,
            exposure: 1.0,
            radius_scale: 1.0,
        }
    }
}

/// The word for what a picture shows: on the command line and in files.
pub(crate) fn show_key(show: &Show) -> &str {
    match show {
        Show::Colours => "colours",
        Show::Target(key) => key,
    }
}

/// What a picture shows, from its word.
pub(crate) fn show_from_key(key: &str) -> Show {
    match key {
        "colours" | "colors" => Show::Colours,
        key => Show::Target(key.to_owned()),
    }
}

fn write_show<S: Serializer>(show: &Show, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(show_key(show))
}

fn read_show<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Show, D::Error> {
    let key = String::deserialize(deserializer)?;
    Ok(show_from_key(&key))
}

fn read_background<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Background, D::Error> {
    let background = Background::deserialize(deserializer)?;
    let colours = match background {
        Background::Transparent => Vec::new(),
        Background::Solid(colour) => vec![colour],
        Background::Gradient(top, bottom) => vec![top, bottom],
    };
    let is_colour = |channel: &f32| (0.0..=1.0).contains(channel);
    if colours.iter().flatten().all(is_colour) {
        Ok(background)
    } else {
        Err(serde::de::Error::custom(
            "background: expected red, green and blue from 0 to 1, found one outside",
        ))
    }
}
