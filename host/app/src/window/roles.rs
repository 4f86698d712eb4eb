//! Which of the two chosen renderers draws: the preview while things move, the main one when they are still.

/// What decides between the main and the preview renderer.
#[derive(Debug, Default)]
pub(crate) struct Roles {
    /// The preview was called by hand, and stays until it is sent away.
    is_held: bool,
}

impl Roles {
    /// Calls the preview by hand, or sends it away.
    pub(crate) fn toggle_by_hand(&mut self) {
        self.is_held = !self.is_held;
    }
}
