//! Intents about pictures in files.

use std::path::PathBuf;

/// What to write.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ExportIntent {
    /// Show the dialog that saves the picture.
    ShowDialog,
    /// Ask the system's dialog where the picture goes, starting with this place.
    ChoosePath(PathBuf),
    /// The picture goes here: fill it into the dialog that saves.
    SetPath(PathBuf),
    /// Save the picture.
    Save(ImageFile),
}

/// A picture to save, as the dialog describes it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ImageFile {
    /// Where it goes; the extension tells the form.
    pub(crate) path: PathBuf,
    /// px.
    pub(crate) size_px: [u32; 2],
    /// What lies behind the scene.
    pub(crate) backdrop: Backdrop,
    /// Whether a file that is there may go.
    pub(crate) replace: Replace,
}

/// What lies behind the scene in a saved picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Backdrop {
    /// What the view shows.
    AsShown,
    /// Nothing.
    Transparent,
}

/// What to do with a file that is there already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Replace {
    /// Ask.
    Ask,
    /// The user said that it may go.
    Yes,
}
