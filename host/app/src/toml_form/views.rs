//! A view that is kept, as files hold it.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use pointstage_scene::ViewRecord;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::view;

/// A view under a number, a name, or both.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct StoredView {
    /// The key that recalls it, 0 to 9.
    #[serde(default, skip_serializing_if = "Option::is_none")]
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
    /// What a command calls it: its name, else its number.
    pub(crate) fn command_names(&self) -> impl Iterator<Item = String> {
        let name = (!self.name.is_empty()).then(|| self.name.clone());
        let number = self.number.map(|number| number.to_string());
        number.into_iter().chain(name)
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
