//! Intents about plugin files.

use std::path::PathBuf;

/// What to do with plugin files.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum PluginsIntent {
    /// Try a quarantined plugin again.
    Retry(PathBuf),
    /// Destroy the graphics device, to see what comes back.
    LoseDevice,
}
