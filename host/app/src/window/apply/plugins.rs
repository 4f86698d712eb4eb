//! Carries out intents about plugin files.

use crate::window::app::App;
use crate::window::intent::PluginsIntent;

impl App {
    pub(super) fn apply_plugins(&mut self, intent: PluginsIntent) {
        match intent {
            PluginsIntent::Retry(path) => {
                self.stage.retry_plugin(path, self.session.scene.clone());
            }
            PluginsIntent::LoseDevice => {
                self.stage.lose_device();
                self.asking.invalidate();
            }
        }
    }
}
