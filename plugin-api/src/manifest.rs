//! The manifest: one JSON file in a plugin's crate that says what its library holds.
//!
//! `export!` embeds it verbatim in a link section, from which the host reads it without running the plugin. Unknown
//! fields, unknown kinds of plugins and settings of unknown kinds are ignored, so that a newer manifest still loads.
//!
//! ```
//! use pointstage_plugin_api::manifest::Manifest;
//! let manifest = Manifest::parse(br#"{
//!     "format": 1, "vendor": "Example", "licence": "MIT", "api": "1.0",
//!     "plugins": [{
//!         "kind": "renderer", "id": "org.example.dots", "alias": "dots", "title": "Dots", "version": "1.0.0",
//!         "needs": { "normals": true }, "gives": { "targets": ["colour", "depth"] },
//!         "settings": [{ "id": "size", "kind": "float", "default": 2, "min": 0.5, "max": 64, "unit": "px" }]
//!     }]
//! }"#)?;
//! assert_eq!(manifest.plugins[0].alias, "dots");
//! # Ok::<(), pointstage_plugin_api::manifest::ManifestError>(())
//! ```

use crate::settings_schema::{SchemaError, SettingSchema, SettingValue, SettingValues};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The format number that this version reads.
pub const FORMAT: u32 = 1;

/// What one plugin library says of itself.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Manifest {
    /// Number of the manifest's format.
    pub format: u32,
    /// Who made it.
    pub vendor: String,
    /// SPDX expression, where it has one.
    pub licence: String,
    /// The paper that it implements; may be empty.
    pub citation: String,
    /// The border version that it was written for.
    pub api: ApiRange,
    /// What the library holds, in the file's order.
    pub plugins: Vec<PluginEntry>,
}

/// Border versions that a plugin fits: this one, and every later one of the same major.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ApiRange {
    /// Equal to the host's, or it cannot load.
    pub major: u32,
    /// The least minor that it was tested with; an older host takes defaults for what it lacks.
    pub minor: u32,
}

/// One plugin of a library.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PluginEntry {
    /// `renderer`, `structure`, `loader`, or one that this version does not know.
    pub kind: String,
    /// Reverse-domain name: `org.example.dots`.
    pub id: String,
    /// Short name for menus' command lines; the last part of the id if the manifest has none.
    pub alias: String,
    /// Name in menus; the alias if the manifest has none.
    pub title: String,
    /// Of this plugin, not of the border.
    pub version: String,
    /// One to three sentences.
    pub description: String,
    /// Extensions of a loader's files, lower case, without the dot.
    pub extensions: Vec<String>,
    /// What it cannot do without.
    pub needs: Needs,
    /// What it offers.
    pub gives: Gives,
    /// Its settings, in the panel's order.
    pub settings: Vec<SettingSchema>,
}

/// What a plugin cannot do without.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Needs {
    /// Surfels have normals.
    pub normals: bool,
    /// Surfels have radii.
    pub radii: bool,
    /// Surfels have tangent axes.
    pub axes: bool,
    /// Surfels have colours.
    pub colours: bool,
    /// Objects have triangles.
    pub mesh: bool,
    /// Named columns that must be there.
    pub columns: Vec<String>,
    /// Device features that must be there, by wgpu's names in kebab case (`shader-int64`).
    pub features: Vec<String>,
    /// Device features that it uses where they are there.
    pub optional_features: Vec<String>,
    /// Least values of device limits, by wgpu's names (`max_storage_buffer_binding_size`).
    pub limits: BTreeMap<String, u64>,
    /// What draws.
    pub device: DeviceKind,
}

/// What a renderer draws with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DeviceKind {
    /// The host's GPU service; a software adapter will do.
    #[default]
    Gpu,
    /// Planes in memory; works in a session without a device.
    Cpu,
}

/// What a plugin offers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Gives {
    /// What it writes.
    pub targets: Vec<TargetEntry>,
    /// A still picture refines from frame to frame.
    pub progressive: bool,
    /// Colours may have coverage below 1 inside the object.
    pub transparency: bool,
    /// It has a hierarchy of its own and draws no selection of a structure.
    pub own_level_of_detail: bool,
    /// What the host offers and its pictures do not depend on, so that a fair comparison can tell.
    pub ignores: Vec<Ignored>,
}

/// Something of the host's that a renderer leaves out of account.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "WrittenIgnored")]
pub struct Ignored {
    /// `lights`: it shades without them; `radius_scale`: its splats keep their size. Others are kept and mean nothing yet.
    pub what: String,
    /// Only while this setting has this value; always if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub when: Option<Condition>,
}

/// A value of one of the plugin's own settings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Condition {
    /// The setting.
    pub id: String,
    /// Its value, as the manifest writes defaults.
    pub equals: SettingValue,
}

impl Gives {
    /// Whether a picture with these values, complete with defaults, leaves `what` out of account.
    pub fn ignores(&self, what: &str, values: &SettingValues) -> bool {
        let holds = |condition: &Condition| values.get(&condition.id) == Some(&condition.equals);
        let all = self.ignores.iter().filter(|ignored| ignored.what == what);
        all.into_iter()
            .any(|ignored| ignored.when.as_ref().is_none_or(holds))
    }
}

#[derive(Deserialize)]
#[serde(untagged)]
enum WrittenIgnored {
    What(String),
    Full {
        what: String,
        #[serde(default)]
        when: Option<Condition>,
    },
}

impl From<WrittenIgnored> for Ignored {
    fn from(written: WrittenIgnored) -> Self {
        match written {
            WrittenIgnored::What(what) => Self { what, when: None },
            WrittenIgnored::Full { what, when } => Self { what, when },
        }
    }
}

/// One target that a renderer writes: a key of the host's, or one of its own with format and meaning.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "WrittenTarget")]
pub struct TargetEntry {
    /// `colour`, `depth`, …, or the plugin's own.
    pub key: String,
    /// wgpu's name (`r16float`); none for the host's targets.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub format: Option<String>,
    /// Clear value, channel by channel; zeros if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clear: Option<[f64; 4]>,
    /// One sentence for the legend.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub meaning: String,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum WrittenTarget {
    Key(String),
    Full {
        key: String,
        #[serde(default)]
        format: Option<String>,
        #[serde(default)]
        clear: Option<[f64; 4]>,
        #[serde(default)]
        meaning: String,
    },
}

impl From<WrittenTarget> for TargetEntry {
    fn from(written: WrittenTarget) -> Self {
        match written {
            WrittenTarget::Key(key) => Self {
                key,
                format: None,
                clear: None,
                meaning: String::new(),
            },
            WrittenTarget::Full {
                key,
                format,
                clear,
                meaning,
            } => Self {
                key,
                format,
                clear,
                meaning,
            },
        }
    }
}

/// Why a manifest is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ManifestError {
    /// Not JSON, or not of the manifest's form.
    #[error("the manifest is not readable: {0}")]
    Json(String),
    /// A format of the future.
    #[error(
        "the manifest has format {found}, this program reads format {FORMAT}: update the program"
    )]
    Format {
        /// The number found.
        found: u32,
    },
    /// `api` is no version.
    #[error("the manifest's 'api' should be a version like \"1.0\", found \"{found}\"")]
    Api {
        /// The text found.
        found: String,
    },
    /// It lists no plugin.
    #[error("the manifest lists no plugins")]
    Empty,
    /// One entry is wrong.
    #[error("manifest, plugin '{plugin}': {problem}")]
    Plugin {
        /// Id, or number from 1 with a `#`.
        plugin: String,
        /// What is wrong, and what would be right.
        problem: String,
    },
    /// One setting is wrong.
    #[error("manifest, plugin '{plugin}', setting '{setting}': {problem}")]
    Setting {
        /// The plugin's id.
        plugin: String,
        /// The setting's id, or number from 1 with a `#`.
        setting: String,
        /// What is wrong.
        #[source]
        problem: SchemaError,
    },
}

impl std::fmt::Display for ApiRange {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}.{}", self.major, self.minor)
    }
}

impl Serialize for ApiRange {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl PluginEntry {
    /// The setting of this id.
    pub fn setting(&self, id: &str) -> Option<&SettingSchema> {
        self.settings.iter().find(|setting| setting.id == id)
    }
}

#[cfg(test)]
#[path = "manifest_tests.rs"]
mod tests;
