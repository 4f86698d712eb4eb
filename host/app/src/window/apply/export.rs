//! Carries out intents about pictures in files.

use crate::window::app::App;
use crate::window::intent::ExportIntent;

impl App {
    pub(super) fn apply_export(&mut self, intent: ExportIntent) {
        match intent {
            ExportIntent::ShowDialog => {}
        }
    }
}
