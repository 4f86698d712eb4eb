//! Carries out intents about renderers and their settings.

use std::time::Instant;

use pointstage_engine::stage::SettingValue;

use crate::window::app::App;
use crate::window::intent::RendererIntent;

impl App {
    pub(super) fn apply_renderer(&mut self, intent: RendererIntent) {
        match intent {
            RendererIntent::Choose(id) => {
                tracing::info!("renderer chosen: {id}");
                self.session.renderer = id;
            }
            RendererIntent::ChoosePreview(id) => self.session.preview = id,
            RendererIntent::TogglePreview => self.roles.toggle_by_hand(),
            RendererIntent::ChooseStructure(id) => self.session.structure = id,
            RendererIntent::Set(id, value) => self.set(id, &value),
            RendererIntent::Reset(id) => {
                if let Some(values) = self.session.settings.get_mut(&self.session.renderer) {
                    values.remove(&id);
                }
            }
            RendererIntent::ResetAll => {
                self.session.settings.remove(&self.session.renderer);
            }
            RendererIntent::Press(id) => self.asking.press(id),
        }
    }

    /// Keeps values that differ from the default, checked.
    fn set(&mut self, id: String, value: &SettingValue) {
        let row = self.rows.renderer(&self.session.renderer);
        let schema = row.and_then(|row| row.settings.iter().find(|setting| setting.id == id));
        match schema.map(|setting| setting.check(value)) {
            Some(Ok(value)) => {
                tracing::info!("setting {id} = {value}");
                let renderer = self.session.renderer.clone();
                self.session
                    .settings
                    .entry(renderer)
                    .or_default()
                    .insert(id, value);
            }
            Some(Err(error)) => self.log.error(error.to_string(), Instant::now()),
            // The renderer went away between showing the widget and applying its edit.
            None => {}
        }
    }
}
