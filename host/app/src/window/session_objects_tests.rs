//! A session with objects that no file holds, through the window: saved, opened, the same again.

use glam::{DAffine3, DVec3};
use pointstage_scene::{Bounds, MarkMode, Material, Object, Scene};

use super::app_tests::{SQUARE, wait_until, window};
use super::intent::{FileIntent, OpenMode, Overwrite, SceneIntent, SelectIntent};

/// What must come back.
type Kept = (String, bool, DAffine3, Material, f32, Vec<[f32; 4]>);

/// What a session keeps of an object.
fn kept(object: &Object) -> Kept {
    (
        object.name.clone(),
        object.visible,
        object.world_from_object,
        object.material,
        object.radius_scale,
        object.geometry.blocks[0].position_radius.to_vec(),
    )
}

fn all_kept(scene: &Scene) -> Vec<Kept> {
    scene.objects().iter().map(kept).collect()
}

#[test]
fn copies_and_unions_come_back_with_their_session() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("square.ply");
    std::fs::write(&file, SQUARE).expect("written");
    let session = folder.path().join("work.pointstage.toml");
    let mut harness = window();
    harness.run_steps(2);
    let ctx = harness.ctx.clone();
    let app = harness.state_mut();
    app.apply(
        &ctx,
        FileIntent::Open(vec![file.clone(), file], OpenMode::Replace).into(),
    );
    wait_until(&mut harness, |harness| {
        harness.state().session.scene.objects().len() == 2
    });
    let app = harness.state_mut();
    let first = app.session.scene.objects()[0].id;
    app.apply(&ctx, SceneIntent::Select(first).into());
    app.apply(&ctx, SceneIntent::Duplicate.into());
    let copy = app.session.scene.objects()[2].id;
    let map = DAffine3::from_translation(DVec3::new(0.25, 2.0, 0.0));
    app.apply(&ctx, SceneIntent::SetTransform(copy, map).into());
    app.apply(&ctx, SceneIntent::SetRadiusScale(first, 0.5).into());
    app.apply(&ctx, SceneIntent::ToggleSelected(first).into());
    // Selected are the first and its copy; the second square stays alone.
    app.apply(&ctx, SceneIntent::Merge.into());
    wait_until(&mut harness, |harness| {
        harness.state().session.scene.objects().len() == 2
    });
    let app = harness.state_mut();
    let [alone, union] = [0, 1].map(|index| app.session.scene.objects()[index].id);
    app.apply(&ctx, SceneIntent::SetRadiusScale(union, 3.0).into());
    app.apply(&ctx, SceneIntent::SetTransform(union, map).into());
    app.apply(&ctx, SceneIntent::SetVisible(alone, false).into());
    app.session
        .edit_scene(|scene| scene.edit(union, |object| object.material.ks = 0.75));
    app.apply(
        &ctx,
        FileIntent::SaveSession(session.clone(), Overwrite::Agreed).into(),
    );
    let saved = app.session.scene.clone();
    assert_eq!(saved.surfel_count(), 12);
    wait_until(&mut harness, |_| session.is_file());
    assert!(folder.path().join("work.objects/square.ply").is_file());

    // The folder may be moved.
    let moved = tempfile::tempdir().expect("a temporary folder");
    let moved = moved.path().join("there");
    std::fs::rename(folder.path(), &moved).expect("moved");
    let mut harness = window();
    harness.run_steps(2);
    let path = moved.join("work.pointstage.toml");
    let app = harness.state_mut();
    app.apply(&ctx, FileIntent::Open(vec![path], OpenMode::Replace).into());
    wait_until(&mut harness, |harness| {
        harness.state().session.scene.objects().len() == 2
    });
    let session = &harness.state().session;
    assert_eq!(all_kept(&session.scene), all_kept(&saved));
    let active = session.active_object().map(|object| object.name.clone());
    assert_eq!(active, Some(saved.objects()[1].name.clone()));
}

#[test]
fn what_was_cut_and_pasted_comes_back_with_its_session() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("square.ply");
    std::fs::write(&file, SQUARE).expect("written");
    let session = folder.path().join("cut.pointstage.toml");
    let mut harness = window();
    harness.run_steps(2);
    let ctx = harness.ctx.clone();
    let open = FileIntent::Open(vec![file.clone()], OpenMode::Replace);
    harness.state_mut().apply(&ctx, open.into());
    wait_until(&mut harness, |harness| {
        harness.state().session.scene.surfel_count() == 4
    });
    let app = harness.state_mut();
    let left = Bounds::new(DVec3::splat(-1.0), DVec3::new(0.5, 2.0, 1.0));
    app.apply(&ctx, SelectIntent::SetCropBox(left).into());
    app.apply(
        &ctx,
        SelectIntent::SelectInCropBox(MarkMode::Replace).into(),
    );
    wait_until(&mut harness, |harness| {
        let marks = harness.state().session.scene.objects()[0].marks.clone();
        marks.is_some_and(|marks| marks.count() == 2)
    });
    harness.state_mut().apply(&ctx, SelectIntent::Cut.into());
    wait_until(&mut harness, |harness| {
        harness.state().session.scene.surfel_count() == 2
    });
    harness.state_mut().apply(&ctx, SelectIntent::Paste.into());
    wait_until(&mut harness, |harness| {
        harness.state().session.scene.objects().len() == 2
    });
    let app = harness.state_mut();
    let save = FileIntent::SaveSession(session.clone(), Overwrite::Agreed);
    app.apply(&ctx, save.into());
    let saved = app.session.scene.clone();
    assert_eq!(saved.surfel_count(), 4);
    wait_until(&mut harness, |_| session.is_file());
    let original = std::fs::read_to_string(&file).expect("still there");
    assert_eq!(original, SQUARE, "the file that was opened stays as it was");

    let mut harness = window();
    harness.run_steps(2);
    let open = FileIntent::Open(vec![session], OpenMode::Replace);
    harness.state_mut().apply(&ctx, open.into());
    wait_until(&mut harness, |harness| {
        harness.state().session.scene.objects().len() == 2
    });
    assert_eq!(all_kept(&harness.state().session.scene), all_kept(&saved));
}
