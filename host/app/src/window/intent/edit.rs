//! Intents about the history of changes.

/// A step in the history of changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum EditIntent {
    /// Take the last change back.
    Undo,
    /// Make the change that was taken back last again.
    Redo,
}
