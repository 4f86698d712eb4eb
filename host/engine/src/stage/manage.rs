//! Managing plugins while the session runs: looking again, folders, setting aside, trying again.
//!
//! What is in use and unchanged goes on; scene, requests and settings are not the plugins' and stay in any case.

use super::instances::Instances;
use super::prepare::Product;
use super::session::Stage;
use crate::plugins::{PluginFolderError, PluginInfo, Registry};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

impl Stage {
    /// Looks for plugins again. New and changed files are examined; what is in use under a changed or vanished file, or has
    /// failed, is dropped, and loaded anew when it is asked for.
    pub fn rescan(&mut self) {
        self.registry = Arc::new(self.registry.discover_again(&self.options.plugins));
        let registry = Arc::clone(&self.registry);
        let renderers = stale(&mut self.renderers, &registry.renderers());
        let structures = stale(&mut self.structures, &registry.structures());
        let is_among = |gone: &BTreeSet<(String, String)>, id: &str| {
            gone.iter().any(|(gone_id, _)| gone_id == id)
        };
        // A view of another build of the same plugin is made anew from what that build prepared.
        for viewport in self.viewports.values_mut() {
            viewport.views.retain(|id, _| !is_among(&renderers, id));
            viewport
                .selectors
                .retain(|id, _| !is_among(&structures, id));
            viewport
                .last_good
                .take_if(|good| renderers.contains(&(good.id.clone(), good.hash.clone())));
        }
    }

    /// The folders that plugins are looked for in, in their order of precedence.
    pub fn plugin_folders(&self) -> &[PathBuf] {
        &self.options.plugins.folders
    }

    /// Looks for plugins in one more folder, from now on. One that is searched already is only searched again.
    ///
    /// # Errors
    /// The folder does not exist or cannot be read; nothing has changed then.
    pub fn add_plugin_folder(&mut self, folder: &Path) -> Result<(), PluginFolderError> {
        let at = |source| PluginFolderError {
            path: folder.to_owned(),
            source,
        };
        std::fs::read_dir(folder).map_err(at)?;
        let folder = std::fs::canonicalize(folder).map_err(at)?;
        let folders = &mut self.options.plugins.folders;
        let is_known = folders
            .iter()
            .any(|known| std::fs::canonicalize(known).is_ok_and(|known| known == folder));
        if !is_known {
            folders.push(folder);
        }
        self.rescan();
        Ok(())
    }

    /// Looks in a folder no longer; whether it was looked in. Its plugins are dropped, unless another folder has them too.
    pub fn remove_plugin_folder(&mut self, folder: &Path) -> bool {
        let real = std::fs::canonicalize(folder).ok();
        let folders = &mut self.options.plugins.folders;
        let count = folders.len();
        folders.retain(|known| {
            let is_real = real.is_some() && std::fs::canonicalize(known).ok() == real;
            known != folder && !is_real
        });
        let was_known = folders.len() < count;
        if was_known {
            self.rescan();
        }
        was_known
    }

    /// Sets a plugin's file aside by the user's wish, in this session and later ones, until [`Stage::retry_plugin`]; whether
    /// there is such a file.
    pub fn set_plugin_aside(&mut self, file: &Path) -> bool {
        let is_known = self.registry.set_aside(file);
        if is_known {
            self.rescan();
        }
        is_known
    }

    /// Examines a file again, whatever came of it before, and lets its plugins try again.
    pub fn retry_plugin(&mut self, file: &Path) {
        self.registry.retry(file);
        for id in ids_in(&self.registry, file) {
            self.retry(&id);
        }
        self.rescan();
    }
}

/// Ids of the plugins of a file.
fn ids_in(registry: &Registry, file: &Path) -> Vec<String> {
    let files = registry.files().iter().filter(|known| known.path == file);
    let manifests = files.filter_map(|file| file.manifest.as_ref());
    manifests
        .flat_map(|manifest| manifest.plugins.iter().map(|plugin| plugin.id.clone()))
        .collect()
}

/// Takes out those in use that failed, or that are not among what the registry finds now; which, by id and hash.
fn stale<P: Product>(
    instances: &mut Instances<P>,
    found: &[Arc<PluginInfo>],
) -> BTreeSet<(String, String)> {
    instances.take_out(|id, instance| {
        let is_found = |info: &Arc<PluginInfo>| info.id == id && info.hash == instance.hash;
        instance.told.is_some() || !found.iter().any(is_found)
    })
}
