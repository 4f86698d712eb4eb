//! Intents about files.

use std::path::PathBuf;

use pointstage_scene::ObjectId;

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
    /// Read every object's file again.
    Reload,
    /// Forget which files were opened.
    ClearRecent,
    /// Show the field for the path of the session's file.
    SaveSessionAs,
    /// Show the system's dialog for the session's file.
    ChooseSessionFile(PathBuf),
    /// Write the session to this file.
    SaveSession(PathBuf, Overwrite),
    /// Write the session to the file that it came from or went to last.
    SaveSessionAgain,
    /// Show the field for the path of the active object's file.
    SaveObjectAs,
    /// Show the system's dialog for an object's file.
    ChooseObjectFile(ObjectId, PathBuf),
    /// Write an object to this file.
    SaveObject(ObjectId, PathBuf, Overwrite),
    /// Put versions, plugins, session and messages on the clipboard.
    CopyBugReport,
    /// Stop a task.
    Cancel(TaskId),
}

/// Whether a file that is there may be replaced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Overwrite {
    /// The user said so.
    Agreed,
    /// Ask first.
    Ask,
}

/// What opening files does with the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OpenMode {
    /// The files take the scene's place once the first is loaded.
    Replace,
    /// The files join the scene.
    Add,
}
