//! What the command line of `render` names: looked up and checked.

use std::sync::Arc;

use pointstage_engine::plugins::{PluginInfo, suitability};
use pointstage_engine::stage::{FALLBACK_ID, FrameRequest, Show, Stage};
use pointstage_plugin_api::nearest::{did_you_mean, nearest_names};
use pointstage_plugin_api::settings_schema::{SettingSchema, SettingValues, ValueError};
use pointstage_scene::{Scene, ViewRecord};

use super::RenderArguments;
use crate::cli::values::AovFormat;
use crate::cli::{Failure, Outcome};

/// What the command line names, looked up and checked before a file is read.
pub(super) struct Choice {
    renderer: Option<Arc<PluginInfo>>,
    is_fallback: bool,
    structure: Option<Arc<PluginInfo>>,
    settings: SettingValues,
    structure_settings: SettingValues,
    show: Show,
}

impl Choice {
    /// Looks up what `arguments` name.
    pub(super) fn new(stage: &Stage, arguments: &RenderArguments) -> Outcome<Self> {
        let registry = stage.registry();
        let is_fallback = arguments
            .renderer
            .as_deref()
            .is_some_and(|key| key == FALLBACK_ID || key == "fallback");
        let renderer = match &arguments.renderer {
            Some(key) if !is_fallback => {
                Some(registry.find_renderer(key).map_err(Failure::usage_from)?)
            }
            _ => None,
        };
        let structure = match &arguments.structure {
            Some(key) => Some(registry.find_structure(key).map_err(Failure::usage_from)?),
            None => None,
        };
        if renderer.is_none() && !is_fallback && !arguments.settings.is_empty() {
            return Err(Failure::usage(
                "--set needs --renderer: settings belong to a renderer",
            ));
        }
        if let Some(info) = &renderer {
            check_targets(info, arguments)?;
        }
        Ok(Self {
            settings: values_of(renderer.as_deref(), &arguments.settings)?,
            structure_settings: values_of(structure.as_deref(), &arguments.structure_settings)?,
            renderer,
            is_fallback,
            structure,
            show: show_of(arguments),
        })
    }

    /// The id to ask for: the one named, else the first that can draw the scene, else the built-in one.
    pub(super) fn renderer_for(&self, stage: &Stage, scene: &Scene) -> String {
        if let Some(info) = &self.renderer {
            return info.id.clone();
        }
        let device = stage.device().map(|device| &**device);
        let suitable = |info: &Arc<PluginInfo>| {
            suitability(&info.entry.needs, scene, device)
                .reason()
                .is_none()
        };
        let found = stage.registry().renderers().into_iter().find(suitable);
        match found {
            Some(info) if !self.is_fallback => info.id.clone(),
            _ => FALLBACK_ID.to_owned(),
        }
    }

    /// The request for one view.
    pub(super) fn request(
        &self,
        scene: &Arc<Scene>,
        view: &ViewRecord,
        renderer: String,
        arguments: &RenderArguments,
    ) -> FrameRequest {
        let values = arguments
            .aovs
            .iter()
            .filter(|aov| aov.format == AovFormat::Exr);
        FrameRequest {
            structure: self.structure.as_ref().map(|info| info.id.clone()),
            settings: self.settings.clone(),
            structure_settings: self.structure_settings.clone(),
            read_back: values.map(|aov| aov.key.clone()).collect(),
            show: self.show.clone(),
            background: arguments.background,
            exposure: arguments.exposure,
            radius_scale: arguments.radius_scale,
            ..FrameRequest::still(
                scene.clone(),
                view.camera(),
                [view.width, view.height],
                renderer,
            )
        }
    }
}

/// The values that `--set` gives, checked against the schema.
fn values_of(info: Option<&PluginInfo>, given: &[(String, String)]) -> Outcome<SettingValues> {
    let schema: &[SettingSchema] = info.map_or(&[], |info| &info.entry.settings);
    let mut values = SettingValues::new();
    for (id, text) in given {
        let setting = schema
            .iter()
            .find(|setting| setting.id == *id)
            .ok_or_else(|| Failure::usage_from(ValueError::unknown(id, schema)))?;
        let value = setting.parse_text(text).map_err(Failure::usage_from)?;
        values.insert(id.clone(), value);
    }
    Ok(values)
}

/// What the picture shows.
fn show_of(arguments: &RenderArguments) -> Show {
    match arguments.show.as_str() {
        "colours" | "colors" => Show::Colours,
        key => Show::Target(key.to_owned()),
    }
}

/// Refuses targets that the renderer does not write.
pub(super) fn check_targets(info: &PluginInfo, arguments: &RenderArguments) -> Outcome {
    let given: Vec<&str> = info
        .entry
        .gives
        .targets
        .iter()
        .map(|target| target.key.as_str())
        .collect();
    let show = show_of(arguments);
    let shown = match &show {
        Show::Target(key) => Some(key),
        Show::Colours => None,
    };
    let aovs = arguments.aovs.iter().map(|aov| &aov.key);
    for key in shown.into_iter().chain(aovs) {
        if !given.contains(&key.as_str()) {
            return Err(no_target(&info.entry.alias, key, &given));
        }
    }
    Ok(())
}

/// The renderer writes no such target.
pub(super) fn no_target(renderer: &str, key: &str, given: &[&str]) -> Failure {
    let near = did_you_mean(&nearest_names(key, given));
    Failure::usage(format!(
        "renderer '{renderer}' writes no target '{key}'{near} (it writes {})",
        given.join(", ")
    ))
}
