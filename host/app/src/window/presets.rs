//! Values of a renderer's settings under a name. Plain data.

use std::collections::BTreeMap;

use pointstage_engine::stage::SettingValues;

/// Presets by renderer id, then by name.
pub(crate) type Presets = BTreeMap<String, BTreeMap<String, SettingValues>>;
