//! Carries out intents about the history of changes.

use crate::window::app::App;
use crate::window::intent::EditIntent;

impl App {
    pub(super) fn apply_edit(&mut self, intent: EditIntent) {
        match intent {
            EditIntent::Undo | EditIntent::Redo => {}
        }
    }
}
