//! A view that is kept, as files hold it.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use pointstage_scene::ViewRecord;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::view;

/// What the number of a stored view in an older file counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NumberOrigin {
    /// The key itself, as the user guide said.
    Key,
    /// Places from 0, the first of which is that of the key 1: what the window wrote.
    Place,
}

/// A view under a key, a name, or both.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct StoredView {
    /// The key that recalls it, 0 to 9.
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "read_key"
    )]
    pub(crate) key: Option<u8>,
    /// What older files have in place of the key: see [`take_number`](Self::take_number). Never written.
    #[serde(default, skip_serializing)]
    pub(crate) number: Option<u8>,
    /// Its name in the list; empty for one that has only a number.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub(crate) name: String,
    /// The camera and the picture's size.
    #[serde(deserialize_with = "view")]
    pub(crate) view: ViewRecord,
    /// A small picture of it, encoded as PNG; empty if there is none. Base64 in the file.
    #[serde(
        default,
        skip_serializing_if = "Vec::is_empty",
        serialize_with = "write_bytes",
        deserialize_with = "read_bytes"
    )]
    pub(crate) thumbnail: Vec<u8>,
}

impl StoredView {
    /// Turns the number of an older file into a key.
    pub(crate) fn take_number(&mut self, origin: NumberOrigin) {
        let number = self.number.take();
        if self.key.is_none() {
            self.key = number.and_then(|number| match (origin, number) {
                (NumberOrigin::Key, 0..=9) => Some(number),
                (NumberOrigin::Place, 0..=9) => Some((number + 1) % 10),
                _ => None,
            });
        }
    }

    /// What a command calls it: its key, its name.
    pub(crate) fn command_names(&self) -> impl Iterator<Item = String> {
        let name = (!self.name.is_empty()).then(|| self.name.clone());
        let key = self.key.map(|key| key.to_string());
        key.into_iter().chain(name)
    }
}

fn read_key<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<u8>, D::Error> {
    match u8::deserialize(deserializer)? {
        key @ 0..=9 => Ok(Some(key)),
        other => Err(serde::de::Error::custom(format!(
            "expected a key from 0 to 9, found {other}"
        ))),
    }
}

fn write_bytes<S: Serializer>(bytes: &[u8], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&BASE64_STANDARD.encode(bytes))
}

fn read_bytes<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<u8>, D::Error> {
    let text = String::deserialize(deserializer)?;
    BASE64_STANDARD.decode(text).map_err(|error| {
        serde::de::Error::custom(format!("expected a picture in base64, found {error}"))
    })
}
