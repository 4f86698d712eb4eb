//! Camera and stored views in the whole window, by keys.

use egui::{Event, Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointstage_scene::{Camera, NearClipping, ViewRecord};

use super::app::App;
use super::app_tests::{self, SQUARE, wait_until, window};
use super::intent::{CameraIntent, FileIntent, Intent, LightIntent, OpenMode, ViewsIntent};
use super::navigation::{Axis, CameraMove, UpAxis};

/// As the system tells of Ctrl.
const CTRL: Modifiers = Modifiers {
    ctrl: true,
    command: true,
    ..Modifiers::NONE
};

/// Passes until a flight has ended: each is a quarter of a second.
const FLIGHT_PASSES: usize = 5;

fn ask(harness: &mut Harness<'static, App>, intent: impl Into<Intent>) {
    app_tests::ask(harness, intent, FLIGHT_PASSES);
}

fn turn(harness: &mut Harness<'static, App>) {
    let turn = CameraMove::Turn {
        yaw_rad: 0.4,
        pitch_rad: 0.2,
    };
    ask(harness, CameraIntent::Move(turn));
}

fn camera(harness: &Harness<'static, App>) -> Camera {
    harness.state().session.panes.active.camera
}

#[test]
fn ctrl_and_a_number_stores_and_the_number_recalls() {
    for key in [Key::Num3, Key::Num0] {
        let mut harness = window();
        harness.run_steps(2);
        turn(&mut harness);
        let stored = camera(&harness);
        harness.key_press_modifiers(CTRL, key);
        harness.run_steps(3);
        turn(&mut harness);
        assert_ne!(camera(&harness), stored);
        harness.key_press(key);
        harness.run_steps(1);
        assert_ne!(camera(&harness), stored, "it flies");
        harness.run_steps(FLIGHT_PASSES);
        assert_eq!(camera(&harness), stored);
        assert!(!harness.state().navigator.is_moving());
    }
}

#[test]
fn an_empty_number_says_how_to_fill_it() {
    let mut harness = window();
    harness.run_steps(2);
    let before = camera(&harness);
    harness.key_press(Key::Num7);
    harness.run_steps(3);
    harness.get_by_label_contains("There is no view 7; Ctrl+7 stores one.");
    assert_eq!(camera(&harness), before);
}

#[test]
fn a_pasted_view_is_flown_to_and_other_text_is_refused() {
    let mut harness = window();
    harness.run_steps(2);
    turn(&mut harness);
    let text = ViewRecord::new(camera(&harness), 640, 480).to_json();
    let copied = camera(&harness);
    turn(&mut harness);
    harness.event(Event::Paste(text));
    harness.run_steps(FLIGHT_PASSES);
    assert_eq!(camera(&harness), copied);
    harness.event(Event::Paste("dear diary".into()));
    harness.run_steps(3);
    harness.get_by_label_contains("The text on the clipboard is no view: line 1");
    assert_eq!(camera(&harness), copied);
}

#[test]
fn a_view_that_was_clipped_by_hand_is_so_again() {
    let mut harness = window();
    harness.run_steps(2);
    let near = NearClipping::Distance(1.5);
    ask(&mut harness, CameraIntent::Near(near));
    ask(&mut harness, ViewsIntent::Store(0));
    ask(&mut harness, CameraIntent::Near(NearClipping::Automatic));
    turn(&mut harness);
    assert!(camera(&harness).near < 0.1);
    ask(&mut harness, ViewsIntent::Recall(0));
    assert_eq!(harness.state().session.panes.active.near, near);
    turn(&mut harness);
    assert_eq!(camera(&harness).near, 1.5);
}

#[test]
fn a_damaged_view_is_refused_with_its_field() {
    let mut harness = window();
    harness.run_steps(2);
    let before = camera(&harness);
    let mut record = ViewRecord::new(before, 640, 480);
    record.pivot = record.eye;
    harness.state_mut().session.views.slots[0] = Some(record);
    ask(&mut harness, ViewsIntent::Recall(0));
    assert_eq!(camera(&harness), before);
    harness.get_by_label_contains("view record: eye is");
}

#[test]
fn the_lock_levels_the_horizon_again() {
    let mut harness = window();
    harness.run_steps(2);
    harness.key_press(Key::T);
    harness.run_steps(2);
    ask(
        &mut harness,
        CameraIntent::Move(CameraMove::Roll { roll_rad: 0.7 }),
    );
    assert_eq!(UpAxis::exactly(&camera(&harness)), None);
    harness.key_press(Key::T);
    harness.run_steps(FLIGHT_PASSES);
    assert_eq!(UpAxis::exactly(&camera(&harness)), Some(UpAxis::Y));
}

#[test]
fn a_light_that_is_dragged_is_the_first_and_without_one_nothing_happens() {
    let mut harness = window();
    harness.run_steps(2);
    let drag = LightIntent::Drag {
        right: 0.2,
        up: 0.1,
    };
    let before = harness.state().session.panes.active.lights.clone();
    ask(&mut harness, drag.clone());
    let after = &harness.state().session.panes.active.lights;
    assert_ne!(after.lights[0], before.lights[0]);
    assert_eq!(after.lights[1..], before.lights[1..]);
    harness
        .state_mut()
        .session
        .panes
        .active
        .lights
        .lights
        .clear();
    ask(&mut harness, drag);
}

#[test]
fn the_window_rests_after_a_flight() {
    let mut harness = window();
    harness.run_steps(2);
    ask(
        &mut harness,
        CameraIntent::Move(CameraMove::Axis(Axis::Right)),
    );
    let viewport = harness.state().screens.active.viewport.expect("a pass");
    assert_eq!(
        viewport.interaction,
        pointstage_plugin_api::abi::Interaction::STILL
    );
}

#[test]
fn files_that_are_opened_together_are_all_shown() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let [near, far] = ["near.ply", "far.ply"].map(|name| folder.path().join(name));
    std::fs::write(&near, SQUARE).expect("written");
    std::fs::write(&far, SQUARE.replace("\n1 ", "\n400 ")).expect("written");
    let mut harness = window();
    harness.run_steps(2);
    let open = FileIntent::Open(vec![near, far], OpenMode::Replace);
    ask(&mut harness, open);
    wait_until(&mut harness, |harness| {
        harness.state().session.scene.objects().len() == 2
    });
    let shown = camera(&harness);
    ask(&mut harness, CameraIntent::Move(CameraMove::Frame));
    let (now, size) = (camera(&harness), 400.0);
    assert!(
        (now.eye - shown.eye).length() < 0.01 * size,
        "{shown:?} {now:?}"
    );
}
