//! All that the settings panel changes, apart from the scene's columns: what undo and redo bring back.

use std::collections::{BTreeMap, BTreeSet};

use pointstage_engine::stage::SettingValues;
use pointstage_plugin_api::settings_schema::SettingSchema;
use pointstage_scene::{Lights, Material, Object, ObjectId, Projection};

use super::pacing::Pacing;
use super::presets::{ActivePresets, Presets};
use super::rows::Rows;
use super::session::{Session, ViewOptions};

/// A snapshot of what the user has chosen.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Choices {
    renderer: String,
    preview: Option<String>,
    structure: Option<String>,
    settings: BTreeMap<String, SettingValues>,
    presets: Presets,
    active_presets: ActivePresets,
    lights: Lights,
    material: Material,
    view: ViewOptions,
    pacing: Pacing,
    lens: Lens,
    objects: BTreeMap<ObjectId, ObjectChoices>,
}

/// How the camera projects. The height of an orthographic picture changes with every zoom; that is no choice.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Lens {
    Perspective { fov_y_rad: f64 },
    Orthographic,
}

/// What the panel changes of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ObjectChoices {
    visible: bool,
    selected: bool,
    material: Material,
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
    /// Which objects are drawn.
    Visibility,
    /// Which objects are selected.
    Selection,
}

impl Lens {
    fn of(projection: Projection) -> Self {
        match projection {
            Projection::Perspective { fov_y_rad } => Self::Perspective { fov_y_rad },
            Projection::Orthographic { .. } => Self::Orthographic,
        }
    }
}

impl ObjectChoices {
    fn of(object: &Object) -> Self {
        Self {
            visible: object.visible,
            selected: object.selected,
            material: object.material,
        }
    }
}

impl Choices {
    /// What the session holds now.
    pub(crate) fn of(session: &Session) -> Self {
        let objects = session.scene.objects().iter();
        Self {
            renderer: session.renderer.clone(),
            preview: session.preview.clone(),
            structure: session.structure.clone(),
            settings: without_empty(&session.settings),
            presets: session.presets.clone(),
            active_presets: session.active_presets.clone(),
            lights: session.lights.clone(),
            material: session.material,
            view: session.view.clone(),
            pacing: session.pacing,
            lens: Lens::of(session.camera.projection),
            objects: objects
                .map(|object| (object.id, ObjectChoices::of(object)))
                .collect(),
        }
    }

    /// Gives the session these choices. Objects that have come since keep theirs; what has gone stays away.
    pub(crate) fn restore(&self, session: &mut Session) {
        session.renderer.clone_from(&self.renderer);
        session.preview.clone_from(&self.preview);
        session.structure.clone_from(&self.structure);
        session.settings.clone_from(&self.settings);
        session.presets.clone_from(&self.presets);
        session.active_presets.clone_from(&self.active_presets);
        session.lights.clone_from(&self.lights);
        session.material = self.material;
        session.view.clone_from(&self.view);
        session.pacing = self.pacing;
        self.restore_lens(session);
        let now = session.scene.objects().iter();
        let changed: Vec<(ObjectId, ObjectChoices)> = now
            .filter_map(|object| {
                let then = *self.objects.get(&object.id)?;
                (then != ObjectChoices::of(object)).then_some((object.id, then))
            })
            .collect();
        if changed.is_empty() {
            return;
        }
        session.edit_scene(|scene| {
            for (id, then) in changed {
                scene.edit(id, |object| {
                    let ObjectChoices {
                        visible,
                        selected,
                        material,
                    } = then;
                    (object.visible, object.selected) = (visible, selected);
                    object.material = material;
                });
            }
        });
    }

    fn restore_lens(&self, session: &mut Session) {
        let camera = &mut session.camera;
        match (self.lens, camera.projection) {
            (Lens::Perspective { fov_y_rad }, Projection::Perspective { .. }) => {
                camera.projection = Projection::Perspective { fov_y_rad };
            }
            (Lens::Orthographic, Projection::Orthographic { .. }) => return,
            (Lens::Perspective { fov_y_rad }, Projection::Orthographic { .. }) => {
                *camera = camera.with_projection_switched(fov_y_rad);
            }
            // The angle is used when perspective comes back only.
            (Lens::Orthographic, Projection::Perspective { fov_y_rad }) => {
                *camera = camera.with_projection_switched(fov_y_rad);
            }
        }
        let bounds = session.scene.bounds_world();
        camera.fit_depth(&bounds);
    }

    /// What is not as it was in `before`, in order. Objects count that both have: files that came or went are no choice.
    pub(crate) fn differences(&self, before: &Self) -> Vec<Field> {
        let mut fields = Vec::new();
        let mut note = |differs: bool, field: Field| {
            if differs {
                fields.push(field);
            }
        };
        for owner in owners_of(&self.presets, &before.presets)
            .chain(owners_of(&self.active_presets, &before.active_presets))
            .collect::<BTreeSet<_>>()
        {
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
        let both = || {
            let now = self.objects.iter();
            now.filter_map(|(id, object)| Some((object, before.objects.get(id)?)))
        };
        note(
            self.material != before.material
                || both().any(|(now, then)| now.material != then.material),
            Field::Material,
        );
        let (view, old) = (&self.view, &before.view);
        note(view.show != old.show, Field::Show);
        note(view.background != old.background, Field::Background);
        note(view.exposure != old.exposure, Field::Exposure);
        note(view.radius_scale != old.radius_scale, Field::RadiusScale);
        note(self.pacing != before.pacing, Field::Pacing);
        note(self.lens != before.lens, Field::Lens);
        note(
            both().any(|(now, then)| now.visible != then.visible),
            Field::Visibility,
        );
        note(
            both().any(|(now, then)| now.selected != then.selected),
            Field::Selection,
        );
        fields
    }

    /// Whether these are the session's choices. Cheap: it is asked every pass.
    pub(crate) fn are_of(&self, session: &Session) -> bool {
        let objects = session.scene.objects();
        self.renderer == session.renderer
            && self.preview == session.preview
            && self.structure == session.structure
            && same_values(&self.settings, &session.settings)
            && self.presets == session.presets
            && self.active_presets == session.active_presets
            && self.lights == session.lights
            && self.material == session.material
            && self.view == session.view
            && self.pacing == session.pacing
            && self.lens == Lens::of(session.camera.projection)
            && self.objects.len() == objects.len()
            && objects.iter().all(|object| {
                let then = self.objects.get(&object.id);
                then == Some(&ObjectChoices::of(object))
            })
    }

    /// Whether no renderer has been chosen yet: the window has just opened.
    pub(crate) fn is_without_renderer(&self) -> bool {
        self.renderer.is_empty()
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
