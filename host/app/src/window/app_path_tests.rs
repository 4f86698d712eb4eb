//! The camera path in the whole window: made, played, undone, rendered.

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointstage_scene::Camera;

use super::app::App;
use super::app_tests::{self, wait_until, window, window_with_square};
use super::intent::{
    CameraIntent, EditIntent, FileIntent, FilmFiles, Intent, OpenMode, Part, PathIntent, Replace,
    WindowIntent,
};
use super::navigation::CameraMove;
use super::views::ListWay;

fn ask(harness: &mut Harness<'static, App>, intent: impl Into<Intent>) {
    app_tests::ask(harness, intent, 2);
}

fn turn(harness: &mut Harness<'static, App>) {
    let turn = CameraMove::Turn {
        yaw_rad: 0.6,
        pitch_rad: 0.2,
    };
    ask(harness, CameraIntent::Move(turn));
}

fn camera(harness: &Harness<'static, App>) -> Camera {
    harness.state().session.panes.active.camera
}

/// A window with a scene and a path of two views, two seconds apart, seen from the second one.
fn with_path(folder: &std::path::Path) -> Harness<'static, App> {
    let mut harness = window_with_square(folder);
    ask(&mut harness, WindowIntent::Toggle(Part::Path));
    harness.get_by_label("Add this view").click();
    harness.run_steps(2);
    turn(&mut harness);
    harness.get_by_label("Add this view").click();
    harness.run_steps(2);
    assert_eq!(harness.state().session.path.duration_s(), 2.0);
    harness
}

#[test]
fn a_path_is_played_to_its_end_and_a_hand_stops_it() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut harness = with_path(folder.path());
    let end = camera(&harness);
    harness.get_by_label("Go to View 1").click();
    harness.run_steps(3);
    let start = camera(&harness);
    assert_ne!(start, end);
    harness.get_by_label("Play").click();
    harness.run_steps(3);
    let there = camera(&harness);
    assert!(there != start && there != end, "{there:?}");
    assert!(harness.state().player.is_playing());
    wait_until(&mut harness, |harness| !harness.state().player.is_playing());
    assert_eq!(camera(&harness), end, "it ends exactly there");

    ask(&mut harness, PathIntent::Scrub(0.5));
    ask(&mut harness, PathIntent::TogglePlay);
    assert!(harness.state().player.is_playing());
    turn(&mut harness);
    assert!(!harness.state().player.is_playing(), "a hand stops it");
    let by_hand = camera(&harness);
    harness.run_steps(5);
    assert_eq!(camera(&harness), by_hand);
}

#[test]
fn changes_are_undone_and_playing_is_none() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut harness = with_path(folder.path());
    let made = harness.state().session.path.clone();
    ask(&mut harness, PathIntent::Shift(0, ListWay::Down));
    let shifted = harness.state().session.path.clone();
    assert_eq!(shifted.keys[0].name, "View 2");
    ask(&mut harness, PathIntent::Scrub(1.0));
    ask(&mut harness, EditIntent::Undo);
    assert_eq!(harness.state().session.path, made, "not the scrubbing");
    ask(&mut harness, EditIntent::Redo);
    assert_eq!(harness.state().session.path, shifted);
    ask(&mut harness, PathIntent::Clear);
    assert!(harness.state().session.path.is_empty());
    assert_eq!(harness.state().history.next_undo(), Some("Camera path"));
    ask(&mut harness, EditIntent::Undo);
    assert_eq!(harness.state().session.path, shifted);
}

#[test]
fn a_session_file_has_the_path() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let harness = with_path(folder.path());
    let app = harness.state();
    let text = app
        .session_file()
        .to_toml_string(folder.path())
        .expect("Unicode");
    let file = folder.path().join("a.pointstage.toml");
    std::fs::write(&file, text).expect("written");
    let read = crate::session_file::SessionFile::read(&file).expect("right");
    let path = app.session.path.clone();
    assert_eq!(read.path.as_ref(), Some(&path));
    let mut another = window();
    another.run_steps(2);
    ask(
        &mut another,
        FileIntent::Open(vec![file], OpenMode::Replace),
    );
    wait_until(&mut another, |another| another.state().session.path == path);
    ask(&mut another, PathIntent::Scrub(2.0));
    assert_eq!(camera(&another), path.keys[1].view.camera());
}

#[test]
fn pictures_are_rendered_beside_each_other_and_not_over_older_ones_unasked() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut harness = with_path(folder.path());
    let files = |replace| FilmFiles {
        path: folder.path().join("frames").join("a_%03d.png"),
        size_px: [32, 24],
        fps: 2.0,
        replace,
    };
    ask(&mut harness, PathIntent::ShowDialog);
    ask(&mut harness, PathIntent::Render(files(Replace::Ask)));
    assert!(harness.state().film_dialog.is_none(), "it closed");
    wait_until(&mut harness, |harness| {
        harness
            .query_by_label_contains("Rendered 5 pictures")
            .is_some()
    });
    let names = |count: usize| {
        let at = |index| folder.path().join(format!("frames/a_{index:03}.png"));
        (0..count).map(at).collect::<Vec<_>>()
    };
    let bytes: Vec<Vec<u8>> = names(5)
        .iter()
        .map(|name| std::fs::read(name).expect("a picture"))
        .collect();
    assert!(bytes.windows(2).all(|pair| pair[0] != pair[1]), "it moves");
    let count = std::fs::read_dir(folder.path().join("frames"))
        .expect("listable")
        .count();
    assert_eq!(count, 5, "nothing else is left");

    ask(&mut harness, PathIntent::ShowDialog);
    ask(&mut harness, PathIntent::Render(files(Replace::Ask)));
    harness.get_by_label("There are such files already.");
    ask(&mut harness, PathIntent::Render(files(Replace::Yes)));
    assert!(harness.state().film_dialog.is_none(), "it closed");
}
