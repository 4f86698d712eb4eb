//! Surfels are selected and edited in a whole window, without a display or a device.

use egui::{Event, Key, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointstage_scene::{Bounds, MarkMode};

use crate::window::app::App;
use crate::window::app_tests::{SQUARE, type_path, wait_until, window};
use crate::window::intent::{EditIntent, Intent, SelectIntent};
use crate::window::selecting::{Drawn, Reach, Tool};

type Window = Harness<'static, App>;

/// A window with the square, which the camera looks at from the front.
fn with_square() -> (tempfile::TempDir, Window) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("square.ply");
    std::fs::write(&path, SQUARE).expect("a file");
    let mut harness = window();
    harness.step();
    type_path(&mut harness, &path);
    wait_until(&mut harness, |harness| {
        let app = harness.state();
        let is_loaded = app.session.scene.surfel_count() == 4;
        is_loaded && app.is_resting() && !app.navigator.is_moving()
    });
    (folder, harness)
}

fn apply(harness: &mut Window, intent: SelectIntent) {
    let ctx = harness.ctx.clone();
    harness.state_mut().apply(&ctx, Intent::Select(intent));
    wait_until(harness, |harness| harness.state().tasks.open().is_empty());
    harness.run_steps(2);
}

fn marked(harness: &Window) -> Vec<usize> {
    let objects = harness.state().session.scene.objects().iter();
    let marked = objects.filter_map(|object| object.marked());
    marked
        .flat_map(|marks| marks.iter().collect::<Vec<_>>())
        .collect()
}

fn surfel_counts(harness: &Window) -> Vec<usize> {
    let objects = harness.state().session.scene.objects().iter();
    objects.map(|object| object.geometry.surfel_count).collect()
}

/// A region of the active view.
fn region(tool: Tool, places: &[[f32; 2]]) -> Drawn {
    Drawn {
        view: 0,
        tool,
        places: places.to_vec(),
        radius: 0.05,
    }
}

fn left_half() -> Drawn {
    region(Tool::Rectangle, &[[0.0, 0.0], [0.5, 1.0]])
}

/// A place by its share of the picture.
fn at(harness: &Window, x: f32, y: f32) -> Pos2 {
    let viewport = harness.state().screens.active.viewport;
    let rect = viewport.expect("the picture is shown").rect;
    rect.min + vec2(x, y) * rect.size()
}

fn drag(harness: &mut Window, places: &[[f32; 2]], modifiers: Modifiers) {
    let places: Vec<Pos2> = places.iter().map(|[x, y]| at(harness, *x, *y)).collect();
    let button = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers,
    };
    harness.event(Event::ModifiersChanged(modifiers));
    harness.event(Event::PointerMoved(places[0]));
    harness.step();
    harness.event(button(places[0], true));
    harness.step();
    for place in &places[1..] {
        harness.event(Event::PointerMoved(*place));
        harness.step();
    }
    harness.event(button(places[places.len() - 1], false));
    harness.step();
    harness.event(Event::ModifiersChanged(Modifiers::NONE));
    harness.step();
    wait_until(harness, |harness| harness.state().tasks.open().is_empty());
    harness.run_steps(2);
}

#[test]
fn drags_with_a_tool_select_and_leave_the_camera_alone() {
    let (_folder, mut harness) = with_square();
    let camera = harness.state().session.panes.active.camera;
    harness.key_press(Key::R);
    harness.run_steps(2);
    assert_eq!(harness.state().selecting.tool, Tool::Rectangle);
    drag(
        &mut harness,
        &[[0.02, 0.02], [0.3, 0.5], [0.5, 0.98]],
        Modifiers::NONE,
    );
    assert_eq!(marked(&harness), [0, 2], "the left half");
    drag(
        &mut harness,
        &[[0.5, 0.02], [0.7, 0.3], [0.98, 0.5]],
        Modifiers::SHIFT,
    );
    assert_eq!(marked(&harness), [0, 2, 3], "the upper right joined");
    let ctrl = Modifiers {
        ctrl: true,
        command: true,
        ..Modifiers::NONE
    };
    drag(&mut harness, &[[0.02, 0.5], [0.3, 0.8], [0.98, 0.98]], ctrl);
    assert_eq!(marked(&harness), [2, 3], "the lower half left");
    harness.get_by_label_contains("2 of 4 surfels selected");
    assert_eq!(harness.state().session.panes.active.camera, camera);
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert_eq!(harness.state().selecting.tool, Tool::Navigate);
    drag(
        &mut harness,
        &[[0.4, 0.4], [0.5, 0.5], [0.6, 0.5]],
        Modifiers::NONE,
    );
    assert_ne!(
        harness.state().session.panes.active.camera,
        camera,
        "it turns"
    );
    assert_eq!(marked(&harness), [2, 3]);
}

#[test]
fn a_lasso_and_a_brush_select_what_they_go_around_and_over() {
    let (_folder, mut harness) = with_square();
    let corner = region(Tool::Lasso, &[[0.0, 0.0], [0.5, 0.0], [0.0, 0.9]]);
    apply(
        &mut harness,
        SelectIntent::Region(corner, MarkMode::Replace),
    );
    assert_eq!(marked(&harness), [2], "the upper left one");
    let far = region(Tool::Brush, &[[0.01, 0.01]]);
    apply(&mut harness, SelectIntent::Region(far, MarkMode::Replace));
    assert_eq!(marked(&harness), [0_usize; 0], "the brush missed");
    let wide = Drawn {
        radius: 5.0,
        ..region(Tool::Brush, &[[0.5, 0.5]])
    };
    apply(&mut harness, SelectIntent::Region(wide, MarkMode::Replace));
    assert_eq!(marked(&harness), [0, 1, 2, 3]);
    apply(&mut harness, SelectIntent::Clear);
    apply(&mut harness, SelectIntent::Reach(Reach::Visible));
    // Depths come with the second picture.
    wait_until(&mut harness, |harness| {
        let shown = harness.state().screens.active.shown.as_ref();
        shown.is_some_and(|shown| shown.planes.contains_key("depth"))
    });
    apply(
        &mut harness,
        SelectIntent::Region(left_half(), MarkMode::Replace),
    );
    let log = harness.state().log.entries();
    assert_eq!(marked(&harness), [0, 2], "nothing hides them: {log:?}");
}

#[test]
fn inverting_twice_and_clearing_come_back() {
    let (_folder, mut harness) = with_square();
    apply(
        &mut harness,
        SelectIntent::Region(left_half(), MarkMode::Replace),
    );
    apply(&mut harness, SelectIntent::Invert);
    assert_eq!(marked(&harness), [1, 3]);
    apply(&mut harness, SelectIntent::Invert);
    assert_eq!(marked(&harness), [0, 2]);
    apply(&mut harness, SelectIntent::Clear);
    assert_eq!(marked(&harness), [0_usize; 0]);
    apply(&mut harness, SelectIntent::Invert);
    assert_eq!(marked(&harness), [0, 1, 2, 3], "all others than none");
}

#[test]
fn what_is_cut_is_pasted_in_its_place() {
    let (_folder, mut harness) = with_square();
    let bounds = harness.state().session.scene.bounds_world();
    apply(
        &mut harness,
        SelectIntent::Region(left_half(), MarkMode::Replace),
    );
    harness.event(Event::Cut);
    harness.run_steps(2);
    wait_until(&mut harness, |harness| surfel_counts(harness) == [2]);
    assert_eq!(marked(&harness), [0_usize; 0]);
    let token = harness.state().selecting.clipboard.token.clone();
    harness.event(Event::Paste(token));
    harness.run_steps(2);
    assert_eq!(surfel_counts(&harness), [2, 2]);
    assert_eq!(marked(&harness), [0, 1], "what was pasted is selected");
    let scene = &harness.state().session.scene;
    assert_eq!(scene.bounds_world(), bounds);
    let names: Vec<&str> = scene
        .objects()
        .iter()
        .map(|object| object.name.as_str())
        .collect();
    assert_eq!(names, ["square", "square (part)"]);
    assert!(
        scene.objects().iter().all(|object| object.source.is_none()),
        "no file holds these"
    );
    harness.key_press(Key::Delete);
    harness.run_steps(2);
    wait_until(&mut harness, |harness| surfel_counts(harness) == [2]);
}

#[test]
fn undo_brings_surfels_and_selections_back() {
    let (_folder, mut harness) = with_square();
    apply(
        &mut harness,
        SelectIntent::Region(left_half(), MarkMode::Replace),
    );
    apply(&mut harness, SelectIntent::Invert);
    apply(&mut harness, SelectIntent::Delete);
    assert_eq!(
        (surfel_counts(&harness), marked(&harness)),
        (vec![2], vec![])
    );
    let mut step = |intent: EditIntent| {
        let ctx = harness.ctx.clone();
        harness.state_mut().apply(&ctx, Intent::Edit(intent));
        harness.run_steps(2);
        (surfel_counts(&harness), marked(&harness))
    };
    assert_eq!(step(EditIntent::Undo), (vec![4], vec![1, 3]), "deleted");
    assert_eq!(step(EditIntent::Undo), (vec![4], vec![0, 2]), "inverted");
    assert_eq!(step(EditIntent::Undo), (vec![4], vec![]), "selected");
    assert_eq!(step(EditIntent::Redo), (vec![4], vec![0, 2]));
    assert_eq!(step(EditIntent::Redo), (vec![4], vec![1, 3]));
    assert_eq!(step(EditIntent::Redo), (vec![2], vec![]));
    assert_eq!(step(EditIntent::Undo), (vec![4], vec![1, 3]));
    let source = harness.state().session.scene.objects()[0].source.clone();
    assert!(source.is_some(), "the file holds it again");
}

#[test]
fn copying_takes_nothing_out_and_an_empty_selection_is_no_command() {
    let (_folder, mut harness) = with_square();
    harness.event(Event::Copy);
    harness.run_steps(2);
    assert!(harness.state().selecting.clipboard.pieces.is_empty());
    apply(
        &mut harness,
        SelectIntent::Region(left_half(), MarkMode::Replace),
    );
    harness.event(Event::Copy);
    harness.run_steps(2);
    wait_until(&mut harness, |harness| {
        !harness.state().selecting.clipboard.pieces.is_empty()
    });
    assert_eq!(surfel_counts(&harness), [4]);
    assert_eq!(marked(&harness), [0, 2]);
    let source = harness.state().session.scene.objects()[0].source.clone();
    assert!(source.is_some(), "the object is still that of the file");
}

#[test]
fn the_crop_box_keeps_what_is_inside() {
    let (_folder, mut harness) = with_square();
    apply(&mut harness, SelectIntent::ToggleCropBox);
    let all = harness.state().selecting.crop_box.expect("it is shown");
    assert_eq!(all, harness.state().session.scene.bounds_world());
    harness.get_by_label("Keep inside");
    let lower = Bounds::new(all.min, all.max - glam::DVec3::Y * 0.5);
    apply(&mut harness, SelectIntent::SetCropBox(lower));
    apply(
        &mut harness,
        SelectIntent::SelectInCropBox(MarkMode::Replace),
    );
    assert_eq!(marked(&harness), [0, 1]);
    apply(&mut harness, SelectIntent::KeepInCropBox);
    assert_eq!(surfel_counts(&harness), [2]);
    apply(&mut harness, SelectIntent::SetCropBox(Bounds::EMPTY));
    apply(&mut harness, SelectIntent::KeepInCropBox);
    assert_eq!(surfel_counts(&harness), [0_usize; 0], "nothing is in it");
}
