//! Intents about plugin files.

use std::path::PathBuf;

/// What to do with plugin files.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum PluginsIntent {
    /// Try a quarantined plugin again.
    Retry(PathBuf),
    /// Do without a plugin file until it is tried again.
    SetAside(PathBuf),
    /// Look at all plugin files again, and load what has changed.
    Reload,
    /// Show the system's dialog for a folder.
    ChooseFolder,
    /// Look for plugins in this folder too.
    AddFolder(PathBuf),
    /// Look in this folder no longer.
    RemoveFolder(PathBuf),
    /// Destroy the graphics device, to see what comes back.
    LoseDevice,
}
