//! All that the settings panel changes, and the scene's objects: what undo and redo bring back.

use std::collections::{BTreeMap, BTreeSet};

use pointstage_engine::stage::SettingValues;
use pointstage_plugin_api::settings_schema::SettingSchema;
use pointstage_scene::{Bounds, Lights, Material, Projection};

use super::comparison::Comparison;
use super::object_choices::ObjectChoices;
use super::pacing::Pacing;
use super::presets::{ActivePresets, Presets};
use super::rows::Rows;
use super::session::{Pane, Session, ViewOptions};
use crate::camera_path::MotionPath;

/// A snapshot of what the user has chosen.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Choices {
    /// One for each view, in order.
    panes: Vec<PaneChoices>,
    comparison: Comparison,
    presets: Presets,
    material: Material,
    pacing: Pacing,
    path: MotionPath,
    objects: ObjectChoices,
}

/// What the user has chosen for one view.
#[derive(Clone, Debug, PartialEq)]
struct PaneChoices {
    renderer: String,
    preview: Option<String>,
    structure: Option<String>,
    settings: BTreeMap<String, SettingValues>,
    active_presets: ActivePresets,
    lights: Lights,
    view: ViewOptions,
    lens: Lens,
}

/// How the camera projects. The height of an orthographic picture changes with every zoom; that is no choice.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Lens {
    Perspective { fov_y_rad: f64 },
    Orthographic,
}

/// One thing that differs between two snapshots.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Field {
    /// Saved, renamed, deleted or chosen presets of this renderer.
    Presets(String),
    /// The main renderer.
    Renderer,
    /// The preview renderer.
    Preview,
    /// The structure.
    Structure,
    /// A setting.
    Setting {
        /// The renderer's or structure's id.
        owner: String,
        /// The setting's id.
        id: String,
    },
    /// The ambient light.
    Ambient,
    /// The headlight.
    Headlight,
    /// How many lights there are.
    LightCount,
    /// One light, by its place.
    Light(usize),
    /// A material.
    Material,
    /// What is shown.
    Show,
    /// What lies behind the scene.
    Background,
    /// The exposure.
    Exposure,
    /// The radius scale.
    RadiusScale,
    /// How often pictures are drawn.
    Pacing,
    /// Field of view, or the kind of projection.
    Lens,
    /// How many views there are.
    Views,
    /// How views are compared.
    Comparison,
    /// Objects that came or went, in words.
    Objects(String),
    /// The surfels of an object.
    Surfels,
    /// Which surfels of an object are selected.
    SelectedSurfels,
    /// What an object is called.
    ObjectName,
    /// Where an object stands.
    Transform,
    /// The radius scale of an object.
    ObjectRadiusScale,
    /// Which views and values the camera path has, and their order.
    PathParts,
    /// Times and numbers of the camera path.
    Path,
    /// Which objects are drawn.
    Visibility,
    /// Which objects are selected.
    Selection,
}

impl Field {
    /// Whether a change of this kind is done at once: the next one is a step of its own, however soon it comes.
    pub(super) fn is_done_at_once(&self) -> bool {
        matches!(
            self,
            Self::Objects(_) | Self::Surfels | Self::SelectedSurfels
        )
    }
}

impl Lens {
    fn of(projection: Projection) -> Self {
        match projection {
            Projection::Perspective { fov_y_rad } => Self::Perspective { fov_y_rad },
            Projection::Orthographic { .. } => Self::Orthographic,
        }
    }
}

impl PaneChoices {
    fn of(pane: &Pane) -> Self {
        Self {
            renderer: pane.renderer.clone(),
            preview: pane.preview.clone(),
            structure: pane.structure.clone(),
            settings: without_empty(&pane.settings),
            active_presets: pane.active_presets.clone(),
            lights: pane.lights.clone(),
            view: pane.view.clone(),
            lens: Lens::of(pane.camera.projection),
        }
    }

    fn restore(&self, pane: &mut Pane, bounds: &Bounds) {
        pane.renderer.clone_from(&self.renderer);
        pane.preview.clone_from(&self.preview);
        pane.structure.clone_from(&self.structure);
        pane.settings.clone_from(&self.settings);
        pane.active_presets.clone_from(&self.active_presets);
        pane.lights.clone_from(&self.lights);
        pane.view.clone_from(&self.view);
        self.restore_lens(pane, bounds);
    }

    fn restore_lens(&self, pane: &mut Pane, bounds: &Bounds) {
        let camera = &mut pane.camera;
        match (self.lens, camera.projection) {
            (Lens::Perspective { fov_y_rad }, Projection::Perspective { .. }) => {
                camera.projection = Projection::Perspective { fov_y_rad };
            }
            (Lens::Orthographic, Projection::Orthographic { .. }) => return,
            // Towards orthographic, the angle is not used.
            (Lens::Perspective { fov_y_rad }, Projection::Orthographic { .. })
            | (Lens::Orthographic, Projection::Perspective { fov_y_rad }) => {
                *camera = camera.with_projection_switched(fov_y_rad);
            }
        }
        camera.fit_depth(bounds);
    }

    /// Notes what is not as it was in `before`.
    fn note_differences(&self, before: &Self, note: &mut impl FnMut(bool, Field)) {
        for owner in owners_of(&self.active_presets, &before.active_presets) {
            note(true, Field::Presets(owner));
        }
        note(self.renderer != before.renderer, Field::Renderer);
        note(self.preview != before.preview, Field::Preview);
        note(self.structure != before.structure, Field::Structure);
        let none = SettingValues::new();
        for owner in owners_of(&self.settings, &before.settings) {
            let [now, then] =
                [&self.settings, &before.settings].map(|all| all.get(&owner).unwrap_or(&none));
            for id in owners_of(now, then) {
                let owner = owner.clone();
                note(true, Field::Setting { owner, id });
            }
        }
        let (lights, old) = (&self.lights, &before.lights);
        note(lights.ambient != old.ambient, Field::Ambient);
        note(lights.headlight != old.headlight, Field::Headlight);
        if lights.lights.len() == old.lights.len() {
            let pairs = lights.lights.iter().zip(&old.lights).enumerate();
            for (index, (light, old)) in pairs {
                note(light != old, Field::Light(index));
            }
        } else {
            note(true, Field::LightCount);
        }
        let (view, old) = (&self.view, &before.view);
        note(view.show != old.show, Field::Show);
        note(view.background != old.background, Field::Background);
        note(view.exposure != old.exposure, Field::Exposure);
        note(view.radius_scale != old.radius_scale, Field::RadiusScale);
        note(self.lens != before.lens, Field::Lens);
    }

    /// Whether these are the view's choices.
    fn are_of(&self, pane: &Pane) -> bool {
        self.renderer == pane.renderer
            && self.preview == pane.preview
            && self.structure == pane.structure
            && same_values(&self.settings, &pane.settings)
            && self.active_presets == pane.active_presets
            && self.lights == pane.lights
            && self.view == pane.view
            && self.lens == Lens::of(pane.camera.projection)
    }
}

impl Choices {
    /// What the session holds now.
    pub(crate) fn of(session: &Session) -> Self {
        Self {
            panes: session.panes.iter().map(PaneChoices::of).collect(),
            comparison: session.comparison.clone(),
            presets: session.presets.clone(),
            material: session.material,
            pacing: session.pacing,
            path: session.path.clone(),
            objects: ObjectChoices::of(session),
        }
    }

    /// Gives the session these choices, with as many views and the objects that it had with them.
    pub(crate) fn restore(&self, session: &mut Session) {
        while session.panes.count() < self.panes.len() {
            let pane = session.panes.active.clone();
            session.panes.push(pane);
        }
        session.panes.truncate(self.panes.len());
        self.objects.restore(session);
        let bounds = session.scene.bounds_world();
        for (pane, choices) in session.panes.iter_mut().zip(&self.panes) {
            choices.restore(pane, &bounds);
        }
        session.comparison.clone_from(&self.comparison);
        session.presets.clone_from(&self.presets);
        session.material = self.material;
        session.pacing = self.pacing;
        session.path.clone_from(&self.path);
    }

    /// Takes the objects of another snapshot for its own.
    pub(crate) fn adopt_objects(&mut self, other: &Self) {
        self.objects = other.objects.clone();
    }

    /// Whether there are objects.
    pub(crate) fn has_objects(&self) -> bool {
        !self.objects.is_empty()
    }

    /// Address and size of every column of its objects, bytes.
    pub(crate) fn columns(&self) -> impl Iterator<Item = (usize, usize)> {
        self.objects.columns()
    }

    /// What is not as it was in `before`, in order, each once whichever views it is of.
    pub(crate) fn differences(&self, before: &Self) -> Vec<Field> {
        let mut fields = Vec::new();
        let mut note = |differs: bool, field: Field| {
            if differs && !fields.contains(&field) {
                fields.push(field);
            }
        };
        for owner in owners_of(&self.presets, &before.presets) {
            note(true, Field::Presets(owner));
        }
        note(self.panes.len() != before.panes.len(), Field::Views);
        for (pane, old) in self.panes.iter().zip(&before.panes) {
            pane.note_differences(old, &mut note);
        }
        note(self.comparison != before.comparison, Field::Comparison);
        note(self.material != before.material, Field::Material);
        note(self.pacing != before.pacing, Field::Pacing);
        note(!self.path.has_parts_of(&before.path), Field::PathParts);
        note(self.path != before.path, Field::Path);
        self.objects.note_differences(&before.objects, &mut note);
        fields
    }

    /// Whether these are the session's choices. Cheap: it is asked every pass.
    pub(crate) fn are_of(&self, session: &Session) -> bool {
        let panes = session.panes.iter().zip(&self.panes);
        self.panes.len() == session.panes.count()
            && panes.into_iter().all(|(pane, then)| then.are_of(pane))
            && self.comparison == session.comparison
            && self.presets == session.presets
            && self.material == session.material
            && self.pacing == session.pacing
            && self.objects.are_of(session)
            && self.path == session.path
    }

    /// Whether no renderer has been chosen yet: the window has just opened.
    pub(crate) fn is_without_renderer(&self) -> bool {
        self.panes.iter().all(|pane| pane.renderer.is_empty())
    }
}

/// A renderer without values that differ is like one that was never touched.
fn without_empty(settings: &BTreeMap<String, SettingValues>) -> BTreeMap<String, SettingValues> {
    let filled = settings.iter().filter(|(_, values)| !values.is_empty());
    filled
        .map(|(owner, values)| (owner.clone(), values.clone()))
        .collect()
}

fn same_values(
    kept: &BTreeMap<String, SettingValues>,
    now: &BTreeMap<String, SettingValues>,
) -> bool {
    kept.iter()
        .eq(now.iter().filter(|(_, values)| !values.is_empty()))
}

/// Keys of the entries that differ, in order.
fn owners_of<T: PartialEq>(
    now: &BTreeMap<String, T>,
    then: &BTreeMap<String, T>,
) -> impl Iterator<Item = String> {
    let keys: BTreeSet<&String> = now.keys().chain(then.keys()).collect();
    let differing = keys
        .into_iter()
        .filter(|key| now.get(*key) != then.get(*key));
    differing.cloned().collect::<Vec<_>>().into_iter()
}

/// What a step changed, for the menu: `Point size`, `Light 2`, `Point size and more`.
pub(crate) fn in_words(fields: &[Field], rows: &Rows) -> String {
    let Some(first) = fields.first() else {
        return String::new();
    };
    // Objects that come are selected.
    let objects = fields
        .iter()
        .find(|field| matches!(field, Field::Objects(_)));
    if let Some(objects) = objects {
        return name_of(objects, rows);
    }
    let name = name_of(first, rows);
    // A preset that was chosen brings its values; a renderer brings nothing else.
    if fields.len() == 1 || matches!(first, Field::Presets(_)) {
        return name;
    }
    let is_of_one = |field: &Field| match (first, field) {
        (Field::Setting { owner, .. }, Field::Setting { owner: other, .. }) => owner == other,
        _ => false,
    };
    match first {
        Field::Setting { owner, .. } if fields.iter().all(is_of_one) => {
            format!("Settings of {}", title_of(owner, rows))
        }
        Field::PathParts => name,
        Field::Ambient | Field::Headlight | Field::LightCount | Field::Light(_) => {
            "Lights".to_owned()
        }
        _ => format!("{name} and more"),
    }
}

fn name_of(field: &Field, rows: &Rows) -> String {
    let name = match field {
        Field::Presets(_) => "Preset",
        Field::Renderer => "Renderer",
        Field::Preview => "Preview renderer",
        Field::Structure => "Level of detail",
        Field::Setting { owner, id } => {
            let schema = schema_of(owner, rows);
            let setting = schema.iter().find(|setting| setting.id == *id);
            return setting.map_or(id.clone(), |setting| setting.label.clone());
        }
        Field::Ambient => "Ambient light",
        Field::Headlight => "Headlight",
        Field::LightCount => "Lights",
        Field::Light(index) => return format!("Light {}", index + 1),
        Field::Material => "Material",
        Field::Show => "What is shown",
        Field::Background => "Background",
        Field::Exposure => "Exposure",
        Field::RadiusScale => "Radius scale",
        Field::Pacing => "Rate",
        Field::Lens => "Projection",
        Field::Views => "Views",
        Field::Comparison => "Comparison",
        Field::Objects(words) => words,
        Field::Surfels => "Surfels",
        Field::SelectedSurfels => "Selected surfels",
        Field::ObjectName => "Name",
        Field::Transform => "Position",
        Field::ObjectRadiusScale => "Radius scale of objects",
        Field::PathParts | Field::Path => "Camera path",
        Field::Visibility => "Visibility",
        Field::Selection => "Selection",
    };
    name.to_owned()
}

fn schema_of<'a>(owner: &str, rows: &'a Rows) -> &'a [SettingSchema] {
    let row = rows.renderer(owner).or_else(|| rows.structure(owner));
    row.map_or(&[], |row| &row.settings)
}

fn title_of<'a>(owner: &'a str, rows: &'a Rows) -> &'a str {
    let row = rows.renderer(owner).or_else(|| rows.structure(owner));
    row.map_or(owner, |row| &row.title)
}
