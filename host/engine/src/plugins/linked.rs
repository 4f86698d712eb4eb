//! Loaders that are linked into this program: what a plugin's library would give, without a library.
//!
//! A fuzzer needs them, since it sees only the code that it was built with; so does a host that may not load code at run
//! time. Everything else of the border stays as it is: the records, the guards, and the checks of what is handed over.

use std::sync::{Arc, OnceLock};

use pointstage_plugin_api::ErrorCode;
use pointstage_plugin_api::abi::FactoryBox;
use pointstage_plugin_api::manifest::{Manifest, ManifestError};
use pointstage_scene::Loader;

use super::loader::PluginLoader;
use super::registry::{PluginInfo, Registry};

/// A linked loader that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum LinkedLoaderError {
    /// Its manifest cannot be read.
    #[error("the manifest of a linked plugin cannot be read: {0}")]
    Manifest(#[from] ManifestError),
    /// Its manifest knows no such loader.
    #[error("the manifest of a linked plugin has no loader '{0}'; name one by its alias")]
    Unknown(String),
    /// It could not be made.
    #[error("the linked loader '{alias}' could not be made ({code:?}): {message}")]
    Made {
        /// The alias.
        alias: String,
        /// What kind of failure.
        code: ErrorCode,
        /// The plugin's words.
        message: String,
    },
}

/// The loader that `manifest` (a `plugin.json`) calls `alias`, made by `factory` of its id.
///
/// # Errors
/// See [`LinkedLoaderError`].
pub fn linked_loader(
    manifest: &[u8],
    alias: &str,
    factory: impl FnOnce(&str) -> FactoryBox,
) -> Result<Arc<dyn Loader>, LinkedLoaderError> {
    let manifest = Manifest::parse(manifest)?;
    let entry = manifest
        .plugins
        .into_iter()
        .find(|entry| entry.kind == "loader" && entry.alias == alias)
        .ok_or_else(|| LinkedLoaderError::Unknown(alias.to_owned()))?;
    let made = factory(&entry.id).loader().into_result();
    let object = made.map_err(|record| LinkedLoaderError::Made {
        alias: alias.to_owned(),
        code: record.code,
        message: record.message.into(),
    })?;
    let info = Arc::new(PluginInfo {
        id: entry.id.clone(),
        entry,
        path: std::path::PathBuf::new(),
        hash: String::new(),
    });
    let registry = Arc::new(Registry::discover(&super::DiscoverOptions::default()));
    Ok(Arc::new(PluginLoader::new(
        info,
        registry,
        OnceLock::from(Ok(object)),
    )))
}
