//! Intents about files.

use std::path::PathBuf;

use crate::window::tasks::TaskId;

/// What to do with files.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum FileIntent {
    /// Show the system's file dialog.
    Choose(OpenMode),
    /// Show the field for a typed path.
    TypePath(OpenMode),
    /// Load files.
    Open(Vec<PathBuf>, OpenMode),
    /// Stop a task.
    Cancel(TaskId),
}

/// What opening files does with the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OpenMode {
    /// The files take the scene's place once the first is loaded.
    Replace,
    /// The files join the scene.
    Add,
}
