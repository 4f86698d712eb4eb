//! What the command line of `render` names: looked up and checked.

use std::sync::Arc;

use pointstage_engine::plugins::{PluginInfo, suitability};
use pointstage_engine::stage::{FALLBACK_ID, FrameRequest, Show, Stage};
use pointstage_plugin_api::settings_schema::SettingValues;
use pointstage_scene::{Scene, ViewRecord};

use super::RenderArguments;
use super::plan::Plan;
use crate::camera_path::Drawer;
use crate::cli::drawing::{self, find_setting, no_target};
use crate::cli::values::AovFormat;
use crate::cli::{Failure, Outcome};

/// What the command line names, looked up and checked before a file is read.
pub(super) struct Choice {
    renderer: Option<Arc<PluginInfo>>,
    is_fallback: bool,
    structure: Option<Arc<PluginInfo>>,
    settings: SettingValues,
    structure_settings: SettingValues,
}

impl Choice {
    /// Looks up what `arguments` and the session name. A plugin of the session that is not there is a warning: its picture
    /// can be had with another one.
    pub(super) fn new(stage: &Stage, arguments: &RenderArguments, plan: &Plan) -> Outcome<Self> {
        let registry = stage.registry();
        let key = arguments.renderer.as_ref().or(plan.renderers.main.as_ref());
        let is_fallback = key.is_some_and(|key| drawing::is_fallback(key));
        let renderer = match (&arguments.renderer, &plan.renderers.main) {
            _ if is_fallback => None,
            (Some(key), _) => drawing::find_renderer(&registry, key)?,
            (None, Some(key)) => registry
                .find_renderer(key)
                .map_err(|error| {
                    plan.warn(&format!(
                        "{error}; another renderer draws, --renderer chooses one"
                    ));
                })
                .ok(),
            (None, None) => None,
        };
        let structure = match (&arguments.structure, &plan.renderers.structure) {
            (Some(key), _) => Some(registry.find_structure(key).map_err(Failure::usage_from)?),
            (None, Some(key)) => registry
                .find_structure(key)
                .map_err(|error| plan.warn(&format!("{error}; all surfels are drawn")))
                .ok(),
            (None, None) => None,
        };
        if renderer.is_none() && !is_fallback && !arguments.settings.is_empty() {
            return Err(Failure::usage(
                "--set needs --renderer: settings belong to a renderer",
            ));
        }
        if structure.is_none() && !arguments.structure_settings.is_empty() {
            return Err(Failure::usage(
                "--set-structure needs --structure: settings belong to a structure",
            ));
        }
        if let Some(info) = &renderer {
            check_targets(info, arguments, &plan.look.show)?;
        }
        Ok(Self {
            settings: values_of(renderer.as_deref(), &arguments.settings, plan)?,
            structure_settings: values_of(
                structure.as_deref(),
                &arguments.structure_settings,
                plan,
            )?,
            renderer,
            is_fallback,
            structure,
        })
    }

    /// The id to ask for: the one named, else the first that can draw the scene, else the built-in one.
    pub(super) fn renderer_for(&self, stage: &Stage, scene: &Scene) -> String {
        if let Some(info) = &self.renderer {
            return info.id.clone();
        }
        let device = stage.device().map(|device| &**device);
        // One that refines, such as an exact one, is for those who ask for it.
        let suitable = |info: &Arc<PluginInfo>| {
            let reason = suitability(&info.entry.needs, scene, device);
            reason.reason().is_none() && !info.entry.gives.progressive
        };
        let found = stage.registry().renderers().into_iter().find(suitable);
        match found {
            Some(info) if !self.is_fallback => info.id.clone(),
            _ => FALLBACK_ID.to_owned(),
        }
    }

    /// Those whose settings can change along a path, when `renderer` draws.
    pub(super) fn drawers<'a>(
        &'a self,
        renderer: &'a str,
        info: Option<&'a PluginInfo>,
    ) -> Vec<Drawer<'a>> {
        let structure = self.structure.as_deref().map(|info| Drawer {
            id: &info.id,
            alias: &info.entry.alias,
            schema: &info.entry.settings,
            is_structure: true,
        });
        let drawer = Drawer {
            id: renderer,
            alias: info.map_or("fallback", |info| &info.entry.alias),
            schema: drawing::schema(info),
            is_structure: false,
        };
        std::iter::once(drawer).chain(structure).collect()
    }

    /// The request for one view.
    pub(super) fn request(
        &self,
        scene: &Arc<Scene>,
        view: &ViewRecord,
        renderer: String,
        arguments: &RenderArguments,
        plan: &Plan,
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
            lights: plan.lights.clone(),
            show: plan.look.show.clone(),
            shows_marks: arguments.show_selection,
            background: plan.look.background,
            exposure: plan.look.exposure,
            radius_scale: plan.look.radius_scale,
            ..FrameRequest::still(
                scene.clone(),
                view.camera(),
                [view.width, view.height],
                renderer,
            )
        }
    }
}

/// The session's values and those that `--set` gives, checked against the schema. A value of the session that does not fit is
/// a warning: the plugin may have become another one since.
fn values_of(
    info: Option<&PluginInfo>,
    given: &[(String, String)],
    plan: &Plan,
) -> Outcome<SettingValues> {
    let schema = drawing::schema(info);
    let mut values = SettingValues::new();
    for (id, value) in info.into_iter().flat_map(|info| plan.settings_of(&info.id)) {
        match find_setting(schema, id).and_then(|setting| setting.check(value)) {
            Ok(value) => {
                values.insert(id.clone(), value);
            }
            Err(error) => plan.warn(&format!("{error}; the default is taken")),
        }
    }
    drawing::set_values(&mut values, schema, given).map_err(Failure::usage_from)?;
    Ok(values)
}

/// Refuses targets that the renderer does not write.
pub(super) fn check_targets(
    info: &PluginInfo,
    arguments: &RenderArguments,
    show: &Show,
) -> Outcome {
    let given: Vec<&str> = info
        .entry
        .gives
        .targets
        .iter()
        .map(|target| target.key.as_str())
        .collect();
    let shown = match show {
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
