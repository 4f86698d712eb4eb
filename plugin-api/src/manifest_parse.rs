//! Reads a manifest: format first, then entry by entry, so that an error can name the plugin and the setting.

use crate::manifest::{ApiRange, FORMAT, Gives, Manifest, ManifestError, Needs, PluginEntry};
use crate::settings_parse::parse_settings;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeSet;

#[derive(Deserialize)]
struct RawManifest {
    #[serde(default)]
    vendor: String,
    #[serde(default)]
    licence: String,
    #[serde(default)]
    citation: String,
    #[serde(default)]
    api: String,
    #[serde(default)]
    plugins: Vec<Value>,
}

#[derive(Deserialize)]
struct RawPlugin {
    kind: String,
    id: String,
    #[serde(default)]
    alias: String,
    #[serde(default)]
    title: String,
    #[serde(default)]
    version: String,
    #[serde(default)]
    description: String,
    #[serde(default)]
    extensions: Vec<String>,
    #[serde(default)]
    needs: Needs,
    #[serde(default)]
    gives: Gives,
    #[serde(default)]
    settings: Vec<Value>,
}

impl Manifest {
    /// Reads a manifest. Zero bytes at the end, as a link section may have, are ignored.
    ///
    /// # Errors
    /// The first fault, with the plugin and the setting that it is in.
    pub fn parse(bytes: &[u8]) -> Result<Self, ManifestError> {
        let end = bytes
            .iter()
            .rposition(|byte| *byte != 0)
            .map_or(0, |last| last + 1);
        let json = |error: serde_json::Error| ManifestError::Json(error.to_string());
        // The format first: a later one may have any other form.
        let value: Value = serde_json::from_slice(&bytes[..end]).map_err(json)?;
        let format = value.get("format").and_then(Value::as_u64).ok_or_else(|| {
            ManifestError::Json("the number 'format' is missing; write \"format\": 1".to_owned())
        })?;
        let format = u32::try_from(format).unwrap_or(u32::MAX);
        if format != FORMAT {
            return Err(ManifestError::Format { found: format });
        }
        let raw = RawManifest::deserialize(value).map_err(json)?;
        let api = ApiRange::parse(&raw.api).ok_or(ManifestError::Api { found: raw.api })?;
        if raw.plugins.is_empty() {
            return Err(ManifestError::Empty);
        }
        let mut plugins: Vec<PluginEntry> = Vec::new();
        for (index, entry) in raw.plugins.iter().enumerate() {
            let plugin = parse_plugin(index, entry)?;
            check_unique(&plugin, &plugins)?;
            plugins.push(plugin);
        }
        Ok(Self {
            format,
            vendor: raw.vendor,
            licence: raw.licence,
            citation: raw.citation,
            api,
            plugins,
        })
    }
}

impl ApiRange {
    fn parse(text: &str) -> Option<Self> {
        let (major, minor) = text.split_once('.')?;
        Some(Self {
            major: major.parse().ok()?,
            minor: minor.parse().ok()?,
        })
    }
}

fn parse_plugin(index: usize, entry: &Value) -> Result<PluginEntry, ManifestError> {
    let name = match entry.get("id").and_then(Value::as_str) {
        Some(id) if !id.is_empty() => id.to_owned(),
        _ => format!("#{}", index + 1),
    };
    let fail = |problem: String| ManifestError::Plugin {
        plugin: name.clone(),
        problem,
    };
    let raw = RawPlugin::deserialize(entry).map_err(|error| fail(error.to_string()))?;
    let part = |text: &str| {
        !text.is_empty()
            && text
                .chars()
                .all(|c| c.is_ascii_alphanumeric() || "-_".contains(c))
    };
    if !raw.id.contains('.') || !raw.id.split('.').all(part) {
        return Err(fail(
            "the id should be a reverse-domain name like \"org.example.dots\"".to_owned(),
        ));
    }
    let last = raw.id.rsplit('.').next().unwrap_or_default();
    let or = |text: String, other: &str| {
        if text.is_empty() {
            other.to_owned()
        } else {
            text
        }
    };
    let alias = or(raw.alias, last);
    if !part(&alias) {
        return Err(fail(format!(
            "the alias \"{alias}\" may have only letters, digits, '-' and '_'"
        )));
    }
    if raw.version.is_empty()
        || raw.version.contains(['@', '#'])
        || raw.version.contains(char::is_whitespace)
    {
        return Err(fail("it needs a version like \"1.0.0\"".to_owned()));
    }
    let mut keys = BTreeSet::new();
    if let Some(twice) = raw
        .gives
        .targets
        .iter()
        .find(|target| !keys.insert(&target.key))
    {
        return Err(fail(format!("target '{}' is listed twice", twice.key)));
    }
    let extensions: Vec<String> = raw
        .extensions
        .iter()
        .map(|extension| extension.trim_start_matches('.').to_ascii_lowercase())
        .collect();
    if let Some(bad) = extensions.iter().find(|extension| !part(extension)) {
        return Err(fail(format!(
            "the extension \"{bad}\" should be like \"xyz\": letters and digits, without a path"
        )));
    }
    let settings =
        parse_settings(&raw.settings).map_err(|(setting, problem)| ManifestError::Setting {
            plugin: raw.id.clone(),
            setting,
            problem,
        })?;
    Ok(PluginEntry {
        title: or(raw.title, &alias),
        kind: raw.kind,
        id: raw.id,
        alias,
        version: raw.version,
        description: raw.description,
        extensions,
        needs: raw.needs,
        gives: raw.gives,
        settings,
    })
}

fn check_unique(plugin: &PluginEntry, others: &[PluginEntry]) -> Result<(), ManifestError> {
    let fail = |problem: String| {
        Err(ManifestError::Plugin {
            plugin: plugin.id.clone(),
            problem,
        })
    };
    if others.iter().any(|other| other.id == plugin.id) {
        return fail("the id is used twice".to_owned());
    }
    let same = |other: &&PluginEntry| other.kind == plugin.kind && other.alias == plugin.alias;
    match others.iter().find(same) {
        Some(other) => fail(format!(
            "the alias '{}' is also that of '{}'",
            plugin.alias, other.id
        )),
        None => Ok(()),
    }
}
