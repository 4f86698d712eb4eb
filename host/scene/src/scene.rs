//! Objects and the scene that holds them.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::{DAffine3, DVec3};
use serde::{Deserialize, Serialize};

use crate::bounds::Bounds;
use crate::geometry::Geometry;
use crate::load::LoaderChoice;
use crate::marks::Marks;

/// State of a thing; two states with the same revision are the same. Later states have greater revisions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Revision(u64);

/// Identity of an object, unique in this process; it survives edits and clones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectId(pub u64);

/// What is shown. A clone shares all columns with the original, so a render thread takes one a frame.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    objects: Vec<Object>,
    revision: Revision,
    marks_revision: Revision,
}

/// One thing in the scene.
#[derive(Clone, Debug)]
pub struct Object {
    /// Identity.
    pub id: ObjectId,
    /// Name for people; the file's stem at first.
    pub name: String,
    /// The file that it came from.
    pub source: Option<PathBuf>,
    /// The loader that the user chose for that file; none if the file's content decided.
    pub loader: Option<LoaderChoice>,
    /// What the columns' positions are relative to, before `world_from_object`; f64, so that map coordinates keep their
    /// digits.
    pub origin: DVec3,
    /// Where it stands: `world = world_from_object · (origin + local)`.
    pub world_from_object: DAffine3,
    /// Where its file puts it: the `world_from_object` that it came with.
    pub placed: DAffine3,
    /// How it takes light.
    pub material: Material,
    /// Factor on the radii and axes of its surfels as they are drawn, above 0; the columns keep theirs.
    pub radius_scale: f32,
    /// Is it drawn?
    pub visible: bool,
    /// Is it marked?
    pub selected: bool,
    /// Its surfels.
    pub geometry: Arc<Geometry>,
    /// The revision of the surfels that its file gave; see [`is_as_in_file`](Self::is_as_in_file).
    pub loaded: Option<Revision>,
    /// Which surfels the user has marked; see [`Object::marked`]. No renderer sees it, so it has no part in the revisions.
    pub marks: Option<Arc<Marks>>,
    /// Changes with every change of the above but `marks` through [`Scene::edit`].
    pub revision: Revision,
}

/// Blinn-Phong reflection; ambient and diffuse light take the surfel's colour, the highlight is white.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Part of the ambient light reflected.
    pub ka: f32,
    /// Part of the light reflected in all directions.
    pub kd: f32,
    /// Part of the light reflected as a highlight.
    pub ks: f32,
    /// Exponent of the highlight; greater is smaller and sharper.
    pub shininess: f32,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            ka: 1.0,
            kd: 0.85,
            ks: 0.1,
            shininess: 32.0,
        }
    }
}

impl Revision {
    /// A revision greater than all before it in this process.
    pub fn next() -> Self {
        static LAST: AtomicU64 = AtomicU64::new(0);
        Self(LAST.fetch_add(1, Ordering::Relaxed) + 1)
    }

    /// The number, for the border and for logs.
    pub const fn number(self) -> u64 {
        self.0
    }
}

impl ObjectId {
    /// An identity that no other object of this process has.
    pub fn next() -> Self {
        static LAST: AtomicU64 = AtomicU64::new(0);
        Self(LAST.fetch_add(1, Ordering::Relaxed) + 1)
    }
}

impl Object {
    /// A visible object in its file's place.
    pub fn new(name: impl Into<String>, origin: DVec3, geometry: Geometry) -> Self {
        Self {
            id: ObjectId::next(),
            name: name.into(),
            source: None,
            loader: None,
            origin,
            world_from_object: DAffine3::IDENTITY,
            placed: DAffine3::IDENTITY,
            material: Material::default(),
            radius_scale: 1.0,
            visible: true,
            selected: false,
            loaded: None,
            geometry: Arc::new(geometry),
            marks: None,
            revision: Revision::next(),
        }
    }

    /// Whether its file holds its surfels: nobody has made others of them since they were read.
    pub fn is_as_in_file(&self) -> bool {
        self.source.is_some() && self.loaded == Some(self.geometry.revision)
    }

    /// Centre of its box, in its own coordinates: what it turns and grows about.
    pub fn pivot(&self) -> DVec3 {
        self.origin + self.geometry.bounds.centre()
    }

    /// Map from the columns' positions to the world: `world_from_object` after the shift by `origin`.
    pub fn world_from_local(&self) -> DAffine3 {
        self.world_from_object * DAffine3::from_translation(self.origin)
    }

    /// Whether the two look the same and share their surfels, whatever their revisions.
    pub fn is_like(&self, other: &Self) -> bool {
        self.id == other.id
            && self.name == other.name
            && self.source == other.source
            && self.loader == other.loader
            && self.origin == other.origin
            && self.world_from_object == other.world_from_object
            && self.material == other.material
            && self.radius_scale == other.radius_scale
            && (self.visible, self.selected) == (other.visible, other.selected)
            && Arc::ptr_eq(&self.geometry, &other.geometry)
    }

    /// The marked surfels, if any is: marks of a geometry that the object no longer has do not count.
    pub fn marked(&self) -> Option<&Arc<Marks>> {
        let marks = self.marks.as_ref()?;
        (!marks.is_empty() && marks.len() == self.geometry.surfel_count).then_some(marks)
    }

    /// Box around the object in the world.
    pub fn bounds_world(&self) -> Bounds {
        self.geometry.bounds.transformed(&self.world_from_local())
    }

    /// Box in the world that a picture should show: without points that stray far from all others.
    pub fn framed_world(&self) -> Bounds {
        let framed = self.geometry.framed_bounds();
        framed.transformed(&self.world_from_local())
    }
}

impl Scene {
    /// A scene without objects.
    pub fn new() -> Self {
        Self::default()
    }

    /// State of the whole: changes when any object does.
    pub fn revision(&self) -> Revision {
        self.revision
    }

    /// State of all marks: changes when any object's do through [`set_marks`](Self::set_marks).
    pub fn marks_revision(&self) -> Revision {
        self.marks_revision
    }

    /// Marks surfels of an object, or none; what renderers have prepared of the scene stays good. True if it changes anything.
    pub fn set_marks(&mut self, id: ObjectId, marks: Option<Arc<Marks>>) -> bool {
        let Some(object) = self.objects.iter_mut().find(|object| object.id == id) else {
            return false;
        };
        let marks = marks.filter(|marks| !marks.is_empty());
        if object.marks == marks {
            return false;
        }
        object.marks = marks;
        self.marks_revision = Revision::next();
        true
    }

    /// Marked surfels of all objects.
    pub fn marked_count(&self) -> usize {
        let marked = self.objects.iter().filter_map(Object::marked);
        marked.map(|marks| marks.count()).sum()
    }

    /// The objects, in the order in which they were added.
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// The object with this identity.
    pub fn object(&self, id: ObjectId) -> Option<&Object> {
        self.objects.iter().find(|object| object.id == id)
    }

    /// Adds an object; one with the same identity is replaced in place.
    pub fn add(&mut self, object: Object) -> ObjectId {
        let id = object.id;
        match self.objects.iter_mut().find(|old| old.id == id) {
            Some(old) => *old = object,
            None => self.objects.push(object),
        }
        self.revision = Revision::next();
        id
    }

    /// Takes an object out.
    pub fn remove(&mut self, id: ObjectId) -> Option<Object> {
        let position = self.objects.iter().position(|object| object.id == id)?;
        self.revision = Revision::next();
        Some(self.objects.remove(position))
    }

    /// Changes an object and notes that it changed; `None` if there is no such object.
    ///
    /// To change columns, make the geometry's copy with `Arc::make_mut`, and call [`Geometry::touch`].
    pub fn edit<T>(&mut self, id: ObjectId, change: impl FnOnce(&mut Object) -> T) -> Option<T> {
        let object = self.objects.iter_mut().find(|object| object.id == id)?;
        let answer = change(object);
        object.id = id;
        object.revision = Revision::next();
        self.revision = Revision::next();
        Some(answer)
    }

    /// Puts the objects of `then`, in their order and with their marks, in the place of these: undo and redo. Those that differ
    /// take new revisions, since a later state has greater ones.
    pub fn turn_to(&mut self, then: &Self) {
        let looks_same = self.looks_like(then);
        if self.marks_revision != then.marks_revision {
            self.marks_revision = Revision::next();
        }
        let objects = then.objects.iter().map(|object| {
            let now = self.object(object.id).filter(|now| now.is_like(object));
            Object {
                revision: now.map_or_else(Revision::next, |now| now.revision),
                ..object.clone()
            }
        });
        self.objects = objects.collect();
        if !looks_same {
            self.revision = Revision::next();
        }
    }

    /// Whether both have the same objects in the same order with the same marks, whatever their revisions.
    pub fn is_like(&self, other: &Self) -> bool {
        let pairs = self.objects.iter().zip(&other.objects);
        let is_unchanged =
            (self.revision, self.marks_revision) == (other.revision, other.marks_revision);
        is_unchanged
            || (self.looks_like(other)
                && pairs
                    .into_iter()
                    .all(|(one, other)| one.marks == other.marks))
    }

    /// The same without a look at marks.
    fn looks_like(&self, other: &Self) -> bool {
        let mut pairs = self.objects.iter().zip(&other.objects);
        self.revision == other.revision
            || (self.objects.len() == other.objects.len()
                && pairs.all(|(one, other)| one.is_like(other)))
    }

    /// Box around all visible objects, in the world.
    pub fn bounds_world(&self) -> Bounds {
        self.objects
            .iter()
            .filter(|object| object.visible)
            .fold(Bounds::EMPTY, |bounds, object| {
                bounds.union(object.bounds_world())
            })
    }

    /// Box in the world that a picture of all visible objects should show: without points that stray far from all others.
    pub fn framed_world(&self) -> Bounds {
        self.objects
            .iter()
            .filter(|object| object.visible)
            .fold(Bounds::EMPTY, |bounds, object| {
                bounds.union(object.framed_world())
            })
    }

    /// Surfels of all objects.
    pub fn surfel_count(&self) -> usize {
        self.objects
            .iter()
            .map(|object| object.geometry.surfel_count)
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Block, Origins};

    fn point_at(x: f32) -> Object {
        let block = Block {
            position_radius: Arc::from([[x, 0.0, 0.0, 1.0]]),
            ..Block::default()
        };
        Object::new(
            "point",
            DVec3::new(500_000.0, 0.0, 0.0),
            Geometry::new(vec![block], None, Origins::default()),
        )
    }

    #[test]
    fn every_edit_takes_a_greater_revision() {
        let mut scene = Scene::new();
        let id = scene.add(point_at(1.0));
        let before = (scene.revision(), scene.objects()[0].revision);
        scene.edit(id, |object| object.visible = false);
        assert!(scene.revision() > before.0 && scene.objects()[0].revision > before.1);
        assert!(scene.edit(ObjectId(u64::MAX), |_| ()).is_none());
    }

    #[test]
    fn world_is_transform_of_origin_plus_local() {
        let mut object = point_at(0.25);
        object.world_from_object = DAffine3::from_scale(DVec3::splat(2.0));
        let bounds = object.bounds_world();
        assert_eq!((bounds.min.x, bounds.max.x), (1_000_000.5, 1_000_000.5));
    }

    #[test]
    fn turning_back_brings_objects_and_looks_back_under_greater_revisions() {
        let mut scene = Scene::new();
        let [first, second] = [1.0, 2.0].map(|x| scene.add(point_at(x)));
        let then = scene.clone();
        scene.remove(first);
        scene.edit(second, |object| object.radius_scale = 2.0);
        let now = scene.clone();
        scene.turn_to(&then);
        assert!(scene.is_like(&then) && !scene.is_like(&now));
        assert!(scene.revision() > now.revision());
        let revision = |scene: &Scene| scene.object(second).map(|object| object.revision);
        assert!(revision(&scene) > revision(&now));
    }

    #[test]
    fn hidden_objects_do_not_count_in_the_bounds() {
        let mut scene = Scene::new();
        let id = scene.add(point_at(1.0));
        scene.edit(id, |object| object.visible = false);
        assert!(scene.bounds_world().is_empty());
    }

    #[test]
    fn marks_change_nothing_that_a_renderer_sees() {
        let mut scene = Scene::new();
        let id = scene.add(point_at(1.0));
        let before = scene.clone();
        assert!(scene.set_marks(id, Some(Arc::new(Marks::all(1)))));
        assert!(
            !scene.set_marks(id, Some(Arc::new(Marks::all(1)))),
            "the same"
        );
        assert_eq!(scene.revision(), before.revision());
        assert_eq!(scene.objects()[0].revision, before.objects()[0].revision);
        assert!(scene.marks_revision() > before.marks_revision());
        assert_eq!((before.marked_count(), scene.marked_count()), (0, 1));
        assert!(scene.set_marks(id, Some(Arc::new(Marks::none(1)))));
        assert!(scene.objects()[0].marks.is_none(), "no marks are none");
        assert!(!scene.set_marks(ObjectId(u64::MAX), None));
    }

    #[test]
    fn marks_come_back_and_prepare_nothing_anew() {
        let mut scene = Scene::new();
        let id = scene.add(point_at(1.0));
        let then = scene.clone();
        scene.set_marks(id, Some(Arc::new(Marks::all(1))));
        let (revision, marks_revision) = (scene.revision(), scene.marks_revision());
        assert!(!scene.is_like(&then));
        scene.turn_to(&then);
        assert!(scene.is_like(&then) && scene.marked_count() == 0);
        assert_eq!(scene.revision(), revision);
        assert!(scene.marks_revision() > marks_revision);
    }

    #[test]
    fn marks_of_another_geometry_do_not_count() {
        let mut scene = Scene::new();
        let id = scene.add(point_at(1.0));
        scene.set_marks(id, Some(Arc::new(Marks::all(7))));
        assert_eq!(
            (scene.objects()[0].marked(), scene.marked_count()),
            (None, 0)
        );
    }

    #[test]
    fn clones_share_columns() {
        let mut scene = Scene::new();
        scene.add(point_at(1.0));
        let copy = scene.clone();
        assert!(Arc::ptr_eq(
            &scene.objects()[0].geometry,
            &copy.objects()[0].geometry
        ));
    }
}
