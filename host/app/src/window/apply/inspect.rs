//! Carries out intents about what is under the pointer.

use crate::window::app::App;
use crate::window::intent::InspectIntent;

impl App {
    pub(super) fn apply_inspect(&mut self, intent: InspectIntent) {
        match intent {
            InspectIntent::Pin(_) | InspectIntent::Unpin | InspectIntent::PivotOn(_) => {}
        }
    }
}
