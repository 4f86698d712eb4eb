//! The scene's objects as undo and redo keep them: a scene shares its columns with every snapshot of it.

use std::collections::BTreeMap;
use std::sync::Arc;

use pointstage_scene::{Object, ObjectId, Scene, Warnings};

use super::choices::Field;
use super::session::Session;

/// The objects of a snapshot, with what loading them gave to say.
#[derive(Clone, Debug, Default)]
pub(super) struct ObjectChoices {
    scene: Arc<Scene>,
    warnings: BTreeMap<ObjectId, Warnings>,
}

impl PartialEq for ObjectChoices {
    fn eq(&self, other: &Self) -> bool {
        self.scene.is_like(&other.scene)
    }
}

impl ObjectChoices {
    pub(super) fn of(session: &Session) -> Self {
        Self {
            scene: Arc::clone(&session.scene),
            warnings: session.warnings.clone(),
        }
    }

    /// Whether these are the session's objects. Cheap where nothing has changed.
    pub(super) fn are_of(&self, session: &Session) -> bool {
        self.scene.is_like(&session.scene)
    }

    /// Gives the session these objects; the session's own go.
    pub(super) fn restore(&self, session: &mut Session) {
        session.warnings.clone_from(&self.warnings);
        if !self.are_of(session) {
            session.edit_scene(|scene| scene.turn_to(&self.scene));
        }
    }

    /// Whether there are any.
    pub(super) fn is_empty(&self) -> bool {
        self.scene.objects().is_empty()
    }

    /// Address and size of every column, bytes; columns that snapshots share have the same address.
    pub(super) fn columns(&self) -> impl Iterator<Item = (usize, usize)> {
        let objects = self.scene.objects().iter();
        objects.flat_map(|object| object.geometry.columns())
    }

    /// Notes what is not as it was in `before`.
    pub(super) fn note_differences(&self, before: &Self, note: &mut impl FnMut(bool, Field)) {
        if self.scene.is_like(&before.scene) {
            return;
        }
        let only_in = |of: &'_ Self, other: &Self| -> Vec<Object> {
            let objects = of.scene.objects().iter();
            objects
                .filter(|object| other.scene.object(object.id).is_none())
                .cloned()
                .collect()
        };
        if let Some(words) = in_words(&only_in(self, before), &only_in(before, self)) {
            note(true, Field::Objects(words));
        }
        for now in self.scene.objects() {
            let Some(then) = before.scene.object(now.id) else {
                continue;
            };
            note(
                !Arc::ptr_eq(&now.geometry, &then.geometry) || now.origin != then.origin,
                Field::Surfels,
            );
            note(
                Arc::ptr_eq(&now.geometry, &then.geometry) && now.marks != then.marks,
                Field::SelectedSurfels,
            );
            note(now.name != then.name, Field::ObjectName);
            note(
                now.world_from_object != then.world_from_object,
                Field::Transform,
            );
            note(now.material != then.material, Field::Material);
            note(
                now.radius_scale != then.radius_scale,
                Field::ObjectRadiusScale,
            );
            note(now.visible != then.visible, Field::Visibility);
            note(now.selected != then.selected, Field::Selection);
        }
    }
}

/// What came and what went, for the menu; `None` if nothing did.
fn in_words(came: &[Object], went: &[Object]) -> Option<String> {
    let named = |objects: &[Object], verb: &str| match objects {
        [object] => format!("{} '{}'", verb, object.name),
        objects => format!("{verb} {} objects", objects.len()),
    };
    Some(match (came, went) {
        ([], []) => return None,
        (came, []) => named(came, "Add"),
        ([], went) => named(went, "Remove"),
        // One that came from no file was made of those that went.
        ([merged], went) if merged.source.is_none() => named(went, "Merge"),
        (came, _) => named(came, "Open"),
    })
}
