//! Who was measured, as it stands in reports.

use pointstage_engine::stage::SettingValues;
use serde::Serialize;

use super::entries::Entry;
use crate::cli::Outcome;

/// A renderer with settings, as reports name it.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Who {
    pub(crate) label: String,
    pub(crate) id: String,
    pub(crate) version: String,
    /// Content hash of the library; none for the built-in renderer.
    pub(crate) hash: Option<String>,
    /// The values that were given.
    pub(crate) settings: SettingValues,
    /// The values of all settings.
    pub(crate) all_settings: SettingValues,
}

impl Who {
    /// Of an entry.
    pub(crate) fn of(entry: &Entry) -> Outcome<Self> {
        Ok(Self {
            label: entry.label.clone(),
            id: entry.id.clone(),
            version: entry.version.clone(),
            hash: entry.hash.clone(),
            settings: entry.settings.clone(),
            all_settings: entry.all_settings()?,
        })
    }
}
