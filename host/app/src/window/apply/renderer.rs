//! Carries out intents about renderers and their settings.

use std::time::Instant;

use pointstage_engine::stage::{SettingValue, Severity};
use pointstage_plugin_api::settings_schema::SettingSchema;

use crate::window::app::App;
use crate::window::intent::RendererIntent;
use crate::window::log::Offer;
use crate::window::presets::{self, Fitted, PresetNameError};

impl App {
    /// Stops a preparation, and offers to begin it again.
    fn cancel_preparation(&mut self, id: String) {
        let title = self.rows.title(&id).to_owned();
        self.stage.cancel_preparation(id.clone());
        self.screens.active.asking.invalidate();
        let offer = Offer {
            label: "Prepare it again",
            intent: RendererIntent::PrepareAgain(id).into(),
        };
        let text = format!("The preparation of {title} was cancelled.");
        self.log.warn_with(text, offer, Instant::now());
    }

    pub(super) fn apply_renderer(&mut self, intent: RendererIntent) {
        let renderer = self.session.panes.active.renderer.clone();
        match intent {
            RendererIntent::Choose(id) => {
                tracing::info!("renderer chosen: {id}");
                self.session.panes.active.renderer = id;
            }
            RendererIntent::ChoosePreview(id) => self.session.panes.active.preview = id,
            RendererIntent::TogglePreview => self.screens.active.roles.toggle_by_hand(),
            RendererIntent::CancelPreparation(id) => self.cancel_preparation(id),
            RendererIntent::PrepareAgain(id) => {
                self.stage.prepare_again(id);
                self.screens.active.asking.invalidate();
            }
            RendererIntent::ChooseStructure(id) => self.session.panes.active.structure = id,
            RendererIntent::Set(id, value) => self.set(renderer, id, &value),
            RendererIntent::ResetSome(ids) => self.reset(&renderer, &ids),
            RendererIntent::ResetAll => {
                self.session.panes.active.settings.remove(&renderer);
            }
            RendererIntent::Press(id) => self.screens.active.asking.press(id),
            RendererIntent::SetOfStructure(id, value) => {
                if let Some(structure) = self.session.panes.active.structure.clone() {
                    self.set(structure, id, &value);
                }
            }
            RendererIntent::ResetOfStructure(ids) => {
                if let Some(structure) = self.session.panes.active.structure.clone() {
                    self.reset(&structure, &ids);
                }
            }
            RendererIntent::ChoosePreset(name) => self.choose_preset(&renderer, &name),
            RendererIntent::SavePreset(name) => {
                let saved = presets::save(&mut self.session, &renderer, &name);
                self.tell_of_name(saved);
            }
            RendererIntent::RenamePreset { from, to } => {
                let renamed = presets::rename(&mut self.session, &renderer, &from, &to);
                self.tell_of_name(renamed);
            }
            RendererIntent::DeletePreset(name) => {
                presets::delete(&mut self.session, &renderer, &name);
            }
            RendererIntent::CopyFrom(source) => self.copy_from(&source, renderer),
        }
    }

    /// The settings of a renderer or structure; none if it went away between showing a widget and applying its edit.
    fn schema_of(&self, owner: &str) -> Vec<SettingSchema> {
        let row = self.rows.renderer(owner);
        let row = row.or_else(|| self.rows.structure(owner));
        row.map(|row| row.settings.clone()).unwrap_or_default()
    }

    /// Keeps values that differ from the default, checked.
    fn set(&mut self, owner: String, id: String, value: &SettingValue) {
        let schema = self.schema_of(&owner);
        let Some(setting) = schema.iter().find(|setting| setting.id == id) else {
            return;
        };
        match setting.check(value) {
            Ok(value) => {
                tracing::info!("setting {id} = {value}");
                let is_default = setting.default_value().as_ref() == Some(&value);
                let values = self.session.panes.active.settings.entry(owner).or_default();
                if is_default {
                    values.remove(&id);
                } else {
                    values.insert(id, value);
                }
            }
            Err(error) => self.log.error(error.to_string(), Instant::now()),
        }
    }

    fn reset(&mut self, owner: &str, ids: &[String]) {
        if let Some(values) = self.session.panes.active.settings.get_mut(owner) {
            values.retain(|id, _| !ids.contains(id));
        }
    }

    fn choose_preset(&mut self, owner: &str, name: &str) {
        let schema = self.schema_of(owner);
        let refused = presets::choose(&mut self.session, owner, name, &schema);
        if !refused.is_empty() {
            let text = format!(
                "Preset '{name}': some values were kept for another version. {}",
                refused.join("; ")
            );
            self.log.say(Severity::Warning, text, Instant::now());
        }
    }

    fn tell_of_name(&mut self, named: Result<(), PresetNameError>) {
        if let Err(error) = named {
            let text = format!("The preset was not kept: {error}");
            self.log.say(Severity::Warning, text, Instant::now());
        }
    }

    /// Takes over what fits of another renderer's values, and says what did not.
    fn copy_from(&mut self, source: &str, renderer: String) {
        let (from, to) = (self.schema_of(source), self.schema_of(&renderer));
        let shared = presets::shared_values(&from, &self.session.settings_of(source), &to);
        let Fitted {
            values,
            taken,
            refused,
        } = presets::fit(&shared, &to);
        let own = self
            .session
            .panes
            .active
            .settings
            .entry(renderer)
            .or_default();
        own.retain(|id, _| !taken.contains(id));
        own.extend(values);
        let title = self.rows.renderer(source);
        let title = title.map_or(source, |row| &row.title);
        let severity = if refused.is_empty() {
            Severity::Info
        } else {
            Severity::Warning
        };
        let mut text = if taken.is_empty() {
            format!("Nothing of {title} fits.")
        } else {
            let labels: Vec<&str> = to
                .iter()
                .filter(|setting| taken.contains(&setting.id))
                .map(|setting| setting.label.as_str())
                .collect();
            format!("Copied from {title}: {}.", labels.join(", "))
        };
        if !refused.is_empty() {
            text = format!("{text} Not copied: {}.", refused.join("; "));
        }
        self.log.say(severity, text, Instant::now());
    }
}
