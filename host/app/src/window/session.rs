//! What the window shows: the scene, how it is looked at, and what draws it. Plain data, without widgets.

use std::collections::BTreeMap;
use std::sync::Arc;

use pointstage_engine::stage::{Background, SettingValues, Show};
use pointstage_scene::estimate::DEFAULT_NEIGHBOURS;
use pointstage_scene::{Camera, Lights, Material, NearClipping, Object, ObjectId, Scene, Warnings};

use super::comparison::Comparison;
use super::navigation::NavigationOptions;
use super::pacing::Pacing;
use super::presets::{ActivePresets, Presets};
use super::several::Several;
use super::views::StoredViews;
use crate::camera_path::MotionPath;
use crate::toml_form::Look;

/// All that a picture depends on, and what the user chose for renderers that are not chosen now.
#[derive(Clone, Debug)]
pub(crate) struct Session {
    /// The objects.
    pub(crate) scene: Arc<Scene>,
    /// The object that was chosen last; see [`active_object`](Self::active_object).
    pub(crate) active: Option<ObjectId>,
    /// What loading each object gave to say.
    pub(crate) warnings: BTreeMap<ObjectId, Warnings>,
    /// What each view shows; panels, menus and keys act on the active one.
    pub(crate) panes: Several<Pane>,
    /// How views are compared.
    pub(crate) comparison: Comparison,
    /// How the camera answers to pointer and keys.
    pub(crate) navigation: NavigationOptions,
    /// The material of objects that come.
    pub(crate) material: Material,
    /// Values under names.
    pub(crate) presets: Presets,
    /// How often it is drawn.
    pub(crate) pacing: Pacing,
    /// Neighbours that a point is compared with where columns are estimated anew.
    pub(crate) neighbours: usize,
    /// Views that were kept.
    pub(crate) views: StoredViews,
    /// How camera and settings change over time.
    pub(crate) path: MotionPath,
}

/// One view: how the scene is looked at, and what draws it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pane {
    /// The eye.
    pub(crate) camera: Camera,
    /// What decides where the camera's near plane stands.
    pub(crate) near: NearClipping,
    /// The lights.
    pub(crate) lights: Lights,
    /// The main renderer's id.
    pub(crate) renderer: String,
    /// The id of the renderer that stands in while things move; none lets the main one draw then too.
    pub(crate) preview: Option<String>,
    /// The chosen structure's id, if any.
    pub(crate) structure: Option<String>,
    /// Values that differ from the default, by renderer id.
    pub(crate) settings: BTreeMap<String, SettingValues>,
    /// Which presets the values come from.
    pub(crate) active_presets: ActivePresets,
    /// How the picture is shown.
    pub(crate) view: ViewOptions,
}

/// How a picture is shown, whatever the renderer.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ViewOptions {
    /// Colours or a target.
    pub(crate) show: Show,
    /// What lies behind the scene.
    pub(crate) background: Background,
    /// Factor on linear colours.
    pub(crate) exposure: f32,
    /// Factor on every radius.
    pub(crate) radius_scale: f32,
}

impl Default for ViewOptions {
    fn default() -> Self {
        Look::default().into()
    }
}

impl Session {
    /// An empty scene, drawn by `renderer`.
    pub(crate) fn new(renderer: String) -> Self {
        Self {
            scene: Arc::new(Scene::new()),
            active: None,
            warnings: BTreeMap::new(),
            panes: Several::one(Pane::new(renderer)),
            comparison: Comparison::default(),
            navigation: NavigationOptions::default(),
            material: Material::default(),
            presets: Presets::new(),
            pacing: Pacing::default(),
            neighbours: DEFAULT_NEIGHBOURS,
            views: StoredViews::default(),
            path: MotionPath::default(),
        }
    }

    /// The values of the active view's renderer.
    pub(crate) fn chosen_settings(&self) -> SettingValues {
        let pane = &self.panes.active;
        pane.settings_of(&pane.renderer)
    }

    /// The values that the active view has for a renderer or structure.
    pub(crate) fn settings_of(&self, renderer: &str) -> SettingValues {
        self.panes.active.settings_of(renderer)
    }

    /// The object that panels and commands are about: the one that was chosen last, else the first that is selected, else
    /// the only one.
    pub(crate) fn active_object(&self) -> Option<&Object> {
        let objects = self.scene.objects();
        let chosen = self.active.and_then(|id| self.scene.object(id));
        let selected = || objects.iter().find(|object| object.selected);
        let only = match objects {
            [object] => Some(object),
            _ => None,
        };
        chosen.or_else(selected).or(only)
    }

    /// Takes all objects out.
    pub(crate) fn clear_scene(&mut self) {
        self.scene = Arc::new(Scene::new());
        self.warnings.clear();
    }

    /// Changes the scene; frames that are being drawn keep the one they started with.
    pub(crate) fn edit_scene<T>(&mut self, change: impl FnOnce(&mut Scene) -> T) -> T {
        change(Arc::make_mut(&mut self.scene))
    }
}

impl Pane {
    /// A view by `renderer`, everything else as in a new window.
    pub(crate) fn new(renderer: String) -> Self {
        Self {
            camera: Camera::default(),
            near: NearClipping::default(),
            lights: Lights::default(),
            renderer,
            preview: None,
            structure: None,
            settings: BTreeMap::new(),
            active_presets: ActivePresets::new(),
            view: ViewOptions::default(),
        }
    }

    /// The values of a renderer or structure.
    pub(crate) fn settings_of(&self, owner: &str) -> SettingValues {
        self.settings.get(owner).cloned().unwrap_or_default()
    }
}
