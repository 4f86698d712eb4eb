//! Carries out intents about the objects.

use std::path::PathBuf;
use std::time::Instant;

use pointstage_engine::stage::Severity;
use pointstage_scene::{LoadOptions, Object, ObjectId, Provenance, WarningKind};

use crate::window::app::App;
use crate::window::intent::SceneIntent;
use crate::window::loading::{Place, flipped, with_estimates};

impl App {
    pub(super) fn apply_scene(&mut self, intent: SceneIntent) {
        match intent {
            SceneIntent::Estimate => self.estimate(),
            SceneIntent::EstimateAnew(steps) => self.estimate_anew(steps),
            SceneIntent::SetNeighbours(count) => self.session.neighbours = count,
            SceneIntent::Flip(id) => self.flip(id),
            SceneIntent::SetVisible(id, visible) => {
                self.session
                    .edit_scene(|scene| scene.edit(id, |object| object.visible = visible));
            }
            SceneIntent::RemoveSelected => {
                let ids = self.selected_objects();
                self.remove_objects(&ids);
            }
            SceneIntent::Duplicate => self.duplicate_selected(),
            SceneIntent::Merge => self.merge_selected(),
            SceneIntent::Rename(id, name) => self.edit_object(id, |object| object.name = name),
            SceneIntent::SetTransform(id, map) => {
                self.edit_object(id, |object| object.world_from_object = map);
            }
            SceneIntent::SetRadiusScale(id, scale) => {
                self.edit_object(id, |object| object.radius_scale = scale);
            }
            SceneIntent::Select(id) => {
                self.session.active = Some(id);
                self.select(|object| object.id == id);
            }
            SceneIntent::ToggleSelected(id) => {
                self.select(|object| object.selected != (object.id == id));
                let object = self.session.scene.object(id);
                let is_selected = object.is_some_and(|object| object.selected);
                self.session.active = is_selected.then_some(id);
            }
            SceneIntent::SelectAll => self.select(|_| true),
            SceneIntent::SelectNone => self.select(|_| false),
            SceneIntent::Remove(id) => self.remove_objects(&[id]),
        }
    }

    /// Selects just the objects of which `is_selected` says yes.
    pub(super) fn select(&mut self, is_selected: impl Fn(&Object) -> bool) {
        let objects = self.session.scene.objects().iter();
        let changed: Vec<ObjectId> = objects
            .filter(|object| is_selected(object) != object.selected)
            .map(|object| object.id)
            .collect();
        if changed.is_empty() {
            return;
        }
        self.session.edit_scene(|scene| {
            for id in changed {
                scene.edit(id, |object| object.selected = !object.selected);
            }
        });
    }

    fn estimate(&mut self) {
        let objects = self.without_estimates();
        if objects.is_empty() {
            let text = "No object with a file lacks normals or radii.";
            self.log.say(Severity::Info, text, Instant::now());
        }
        for (id, path) in objects {
            let options = with_estimates(self.loaded_as(id));
            self.push_load(
                path,
                options,
                Place::InsteadOf(id),
                "Estimate normals and radii of",
            );
        }
    }

    fn flip(&mut self, id: ObjectId) {
        let source = self
            .session
            .scene
            .object(id)
            .and_then(|object| object.source.clone());
        if let Some(path) = source {
            let options = flipped(self.loaded_as(id));
            self.push_load(path, options, Place::InsteadOf(id), "Flip");
        }
    }

    /// How the object's file was loaded, as it and its warnings tell.
    pub(in crate::window) fn loaded_as(&self, id: ObjectId) -> LoadOptions {
        let is_flipped = self
            .session
            .warnings
            .get(&id)
            .is_some_and(|warnings| warnings.count(&WarningKind::Flipped) > 0);
        let options = LoadOptions {
            loader: self
                .session
                .scene
                .object(id)
                .and_then(|object| object.loader.clone()),
            ..LoadOptions::default()
        };
        if is_flipped {
            flipped(options)
        } else {
            options
        }
    }

    /// Objects that lack normals or radii, with the files to read them from again.
    fn without_estimates(&self) -> Vec<(ObjectId, PathBuf)> {
        let objects = self.session.scene.objects().iter();
        objects
            .filter(|object| {
                let origins = &object.geometry.origins;
                origins.normals == Provenance::Missing || origins.radii == Provenance::Missing
            })
            .filter_map(|object| Some((object.id, object.source.clone()?)))
            .collect()
    }
}
