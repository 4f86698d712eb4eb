use std::sync::Arc;

use egui_kittest::Harness;
use pointstage_scene::{Estimation, Job, LoadOptions, ObjectId, Provenance, load};

use super::*;
use crate::window::app_tests::wait_until;
use crate::window::apply::objects::tests::{apply, desk};
use crate::window::intent::{EditIntent, FileIntent, Overwrite, SceneIntent};

const ORIENTED: Steps = Steps {
    normals: true,
    orientation: true,
    radii: false,
    axes: true,
    neighbours: 8,
};

fn normals(harness: &Harness<'static, App>, id: ObjectId) -> Provenance {
    let object = harness.state().session.scene.object(id);
    object.expect("it is there").geometry.origins.normals
}

#[test]
fn columns_of_the_selected_object_are_estimated_and_undone() {
    let (mut harness, [bust, floor]) = desk();
    apply(&mut harness, SceneIntent::Select(bust));
    apply(&mut harness, SceneIntent::EstimateAnew(ORIENTED));
    wait_until(&mut harness, |harness| {
        normals(harness, bust) == Provenance::Oriented
    });
    assert_eq!(normals(&harness, floor), Provenance::Missing);
    harness.run_steps(2);
    apply(&mut harness, EditIntent::Undo);
    assert_eq!(normals(&harness, bust), Provenance::Missing);
    apply(&mut harness, EditIntent::Redo);
    assert_eq!(normals(&harness, bust), Provenance::Oriented);
}

#[test]
fn an_object_that_changed_meanwhile_stays_as_it_is() {
    let (mut harness, [bust, _]) = desk();
    let object = harness
        .state()
        .session
        .scene
        .object(bust)
        .expect("there")
        .clone();
    let (geometry, warnings) = estimate(&object.geometry, &ORIENTED, &Job::new()).expect("done");
    let from = object.geometry.revision;
    harness
        .state_mut()
        .session
        .edit_scene(|scene| scene.edit(bust, |object| Arc::make_mut(&mut object.geometry).touch()));
    harness.state_mut().take_estimated(Estimated {
        id: bust,
        from,
        geometry,
        warnings,
    });
    assert_eq!(normals(&harness, bust), Provenance::Missing);
}

#[test]
fn an_object_is_saved_and_a_file_that_is_there_is_asked_about() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("bust.ply");
    std::fs::write(&path, "precious").expect("written");
    let (mut harness, [bust, _]) = desk();
    apply(
        &mut harness,
        FileIntent::SaveObject(bust, path.clone(), Overwrite::Ask),
    );
    assert!(harness.state().path_field.is_some(), "it asks");
    assert_eq!(std::fs::read_to_string(&path).expect("there"), "precious");
    apply(
        &mut harness,
        FileIntent::SaveObject(bust, path.clone(), Overwrite::Agreed),
    );
    let options = LoadOptions {
        estimation: Estimation::FileOnly,
        ..LoadOptions::default()
    };
    wait_until(&mut harness, |_| load(&path, &options, &Job::new()).is_ok());
    let saved = load(&path, &options, &Job::new())
        .expect("a whole file")
        .object;
    let object = harness.state().session.scene.object(bust).expect("there");
    assert_eq!(saved.geometry.bounds, object.geometry.bounds);
}
