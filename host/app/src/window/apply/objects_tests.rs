use std::sync::Arc;

use egui_kittest::Harness;
use glam::{DAffine3, DVec3};
use pointstage_scene::{Block, Geometry, Origins};

use super::*;
use crate::window::app_tests::{ask, wait_until, window};
use crate::window::intent::{EditIntent, Intent, SceneIntent};

fn object(name: &str, x: f32) -> Object {
    let block = Block {
        position_radius: Arc::from([[x, 0.0, 0.0, 1.0], [x, 1.0, 0.0, 1.0]]),
        ..Block::default()
    };
    Object::new(
        name,
        DVec3::ZERO,
        Geometry::new(vec![block], None, Origins::default()),
    )
}

/// A window with two objects.
pub(in crate::window::apply) fn desk() -> (Harness<'static, App>, [ObjectId; 2]) {
    let mut harness = window();
    // Before that, nothing is a step that can be undone.
    wait_until(&mut harness, |harness| {
        !harness.state().session.panes.active.renderer.is_empty()
    });
    let ids = harness.state_mut().session.edit_scene(|scene| {
        [("bust", 0.0), ("floor", 5.0)].map(|(name, x)| scene.add(object(name, x)))
    });
    harness.run_steps(2);
    (harness, ids)
}

pub(in crate::window::apply) fn apply(
    harness: &mut Harness<'static, App>,
    intent: impl Into<Intent>,
) {
    ask(harness, intent, 2);
}

fn names(harness: &Harness<'static, App>) -> Vec<String> {
    let objects = harness.state().session.scene.objects().iter();
    objects.map(|object| object.name.clone()).collect()
}

#[test]
fn copies_share_surfels_take_new_names_and_are_undone() {
    let (mut harness, [bust, _]) = desk();
    apply(&mut harness, SceneIntent::Select(bust));
    apply(&mut harness, SceneIntent::Duplicate);
    apply(&mut harness, SceneIntent::Duplicate);
    assert_eq!(
        names(&harness),
        ["bust", "floor", "bust copy", "bust copy 2"]
    );
    let session = &harness.state().session;
    let objects = session.scene.objects();
    assert!(Arc::ptr_eq(&objects[0].geometry, &objects[3].geometry));
    let active = session.active_object().map(|object| object.id);
    assert_eq!(active, Some(objects[3].id));
    apply(&mut harness, EditIntent::Undo);
    assert_eq!(names(&harness), ["bust", "floor", "bust copy"]);
}

#[test]
fn objects_are_merged_and_come_back() {
    let (mut harness, [_, floor]) = desk();
    apply(
        &mut harness,
        SceneIntent::SetTransform(floor, DAffine3::from_translation(DVec3::Z)),
    );
    apply(&mut harness, SceneIntent::SelectAll);
    let expected = harness.state().session.scene.bounds_world();
    apply(&mut harness, SceneIntent::Merge);
    wait_until(&mut harness, |harness| {
        harness.state().session.scene.objects().len() == 1
    });
    let scene = harness.state().session.scene.clone();
    let merged = &scene.objects()[0];
    assert_eq!((merged.geometry.surfel_count, merged.selected), (4, true));
    assert_eq!(merged.bounds_world(), expected);
    harness.run_steps(2);
    apply(&mut harness, EditIntent::Undo);
    assert_eq!(names(&harness), ["bust", "floor"]);
    apply(&mut harness, EditIntent::Redo);
    assert_eq!(names(&harness), ["bust"]);
}

#[test]
fn objects_that_changed_while_they_were_merged_stay() {
    let (mut harness, [bust, _]) = desk();
    let parts = harness.state().session.scene.objects().to_vec();
    let all: Vec<&Object> = parts.iter().collect();
    let merged = merge(&all, "both").expect("they can be merged");
    apply(&mut harness, SceneIntent::Rename(bust, "head".to_owned()));
    harness.state_mut().take_merged(Merged {
        object: merged,
        parts,
    });
    assert_eq!(names(&harness), ["head", "floor"]);
}

#[test]
fn place_radius_scale_and_name_are_set_and_undone_one_by_one() {
    let (mut harness, [bust, _]) = desk();
    let map = DAffine3::from_scale(DVec3::splat(2.0));
    apply(&mut harness, SceneIntent::Rename(bust, "head".to_owned()));
    apply(&mut harness, SceneIntent::SetTransform(bust, map));
    apply(&mut harness, SceneIntent::SetRadiusScale(bust, 3.0));
    let of = |harness: &Harness<'static, App>| {
        let object = harness.state().session.scene.objects()[0].clone();
        (object.name, object.world_from_object, object.radius_scale)
    };
    assert_eq!(of(&harness), ("head".to_owned(), map, 3.0));
    apply(&mut harness, EditIntent::Undo);
    assert_eq!(of(&harness), ("head".to_owned(), map, 1.0));
    apply(&mut harness, EditIntent::Undo);
    apply(&mut harness, EditIntent::Undo);
    assert_eq!(of(&harness), ("bust".to_owned(), DAffine3::IDENTITY, 1.0));
}

#[test]
fn removed_objects_come_back_where_they_were() {
    let (mut harness, [bust, _]) = desk();
    apply(&mut harness, SceneIntent::Select(bust));
    apply(&mut harness, SceneIntent::RemoveSelected);
    assert_eq!(names(&harness), ["floor"]);
    apply(&mut harness, EditIntent::Undo);
    assert_eq!(names(&harness), ["bust", "floor"]);
}

#[test]
fn copies_of_copies_count_on() {
    for (name, taken, expected) in [
        ("a", vec!["a"], "a copy"),
        ("a copy", vec!["a", "a copy"], "a copy 2"),
        ("a copy 2", vec!["a copy", "a copy 2"], "a copy 3"),
        ("a copybook", vec![], "a copybook copy"),
    ] {
        assert_eq!(name_of_copy(name, &taken), expected);
    }
}
