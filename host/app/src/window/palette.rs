//! The command palette: a search over all actions and all settings of the chosen renderer.

/// What the palette holds while it is open.
#[derive(Debug, Default)]
pub(crate) struct Palette {
    is_open: bool,
}

impl Palette {
    /// Opens it, or closes it.
    pub(crate) fn toggle(&mut self) {
        self.is_open = !self.is_open;
    }
}
