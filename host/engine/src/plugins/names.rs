//! Finds a plugin by what the user calls it.

use super::examine::PluginFile;
use super::registry::PluginInfo;
use pointstage_plugin_api::nearest::{did_you_mean, nearest_names};
use std::sync::Arc;

/// No plugin of this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no {kind} '{key}'{hint}")]
pub struct UnknownPlugin {
    /// `renderer` or `structure`.
    pub kind: &'static str,
    /// What was asked for.
    pub key: String,
    /// The nearest names, or why the one meant cannot be used.
    pub hint: String,
}

/// The plugin among `infos` whose id, alias, `id@version` or `id#hash` is `key`; the first if several fit.
///
/// A hash may be shortened to its first letters, four at least.
pub(super) fn find(
    kind: &'static str,
    key: &str,
    infos: &[Arc<PluginInfo>],
    files: &[PluginFile],
) -> Result<Arc<PluginInfo>, UnknownPlugin> {
    let fits = |info: &&Arc<PluginInfo>| {
        let named = |name: &str| info.id == name || info.entry.alias == name;
        if let Some((name, version)) = key.split_once('@') {
            return named(name) && info.entry.version == version;
        }
        if let Some((name, hash)) = key.split_once('#') {
            return named(name) && hash.len() >= 4 && info.hash.starts_with(hash);
        }
        named(key)
    };
    // An id is more precise than an alias: somebody else's plugin may have that alias.
    let by_id = infos.iter().find(|info| info.id == key);
    match by_id.or_else(|| infos.iter().find(fits)) {
        Some(info) => Ok(Arc::clone(info)),
        None => Err(UnknownPlugin {
            kind,
            key: key.to_owned(),
            hint: hint(kind, key, infos, files),
        }),
    }
}

fn hint(kind: &str, key: &str, infos: &[Arc<PluginInfo>], files: &[PluginFile]) -> String {
    let name = key.split(['@', '#']).next().unwrap_or(key);
    let refused = files
        .iter()
        .filter(|file| !file.verdict.is_usable())
        .find(|file| {
            let mut entries = file.manifest.iter().flat_map(|manifest| &manifest.plugins);
            entries.any(|entry| entry.kind == kind && (entry.id == name || entry.alias == name))
        });
    if let Some(file) = refused {
        return format!(": {}", file.verdict.message);
    }
    let builds: Vec<String> = infos
        .iter()
        .filter(|info| info.id == name || info.entry.alias == name)
        .map(|info| format!("{}@{}", info.id, info.entry.version))
        .collect();
    if !builds.is_empty() {
        return format!("; there is {}", builds.join(" and "));
    }
    let names = infos
        .iter()
        .flat_map(|info| [info.entry.alias.as_str(), info.id.as_str()]);
    let near = nearest_names(name, names);
    if !near.is_empty() {
        return did_you_mean(&near);
    }
    if infos.is_empty() {
        return format!("; no {kind} was found (`pointstage plugins list` tells where it looked)");
    }
    let all: Vec<&str> = infos.iter().map(|info| info.entry.alias.as_str()).collect();
    format!("; there are {}", all.join(", "))
}
