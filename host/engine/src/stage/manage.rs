//! Managing plugins while the session runs: looking again, folders, setting aside, trying again.
//!
//! What is in use and unchanged goes on; scene, requests and settings are not the plugins' and stay in any case.

use super::session::{Instance, Stage};
use crate::plugins::{PluginFolderError, Registry};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

impl Stage {
    /// Looks for plugins again. New and changed files are examined; what is in use under a changed or vanished file, or has
    /// failed, is dropped, and loaded anew when it is asked for.
    pub fn rescan(&mut self) {
        self.registry = Arc::new(self.registry.discover_again(&self.options.plugins));
        let registry = Arc::clone(&self.registry);
        let hash_of_renderer = |id: &str| Some(registry.find_renderer(id).ok()?.hash.clone());
        let hash_of_structure = |id: &str| Some(registry.find_structure(id).ok()?.hash.clone());
        let renderers = stale(&self.renderers, hash_of_renderer);
        let structures = stale(&self.structures, hash_of_structure);
        for viewport in self.viewports.values_mut() {
            viewport.views.retain(|id, _| !renderers.contains(id));
            viewport.selectors.retain(|id, _| !structures.contains(id));
            viewport.last_good.take_if(|good| renderers.contains(good));
        }
        self.renderers.retain(|id, _| !renderers.contains(id));
        self.structures.retain(|id, _| !structures.contains(id));
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

/// Ids of those in use that failed, or whose content is not what the registry finds now.
fn stale<P>(
    instances: &HashMap<String, Instance<P>>,
    hash_of: impl Fn(&str) -> Option<String>,
) -> Vec<String> {
    let is_stale = |(id, instance): &(&String, &Instance<P>)| {
        instance.told.is_some() || hash_of(id).as_ref() != Some(&instance.hash)
    };
    let ids = instances.iter().filter(is_stale);
    ids.map(|(id, _)| id.clone()).collect()
}
