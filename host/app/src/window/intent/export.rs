//! Intents about pictures in files.

/// What to write.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ExportIntent {
    /// Show the dialog that saves the picture.
    ShowDialog,
}
