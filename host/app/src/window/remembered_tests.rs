//! What outlives the window: sessions, settings and recent files, without a display or a device.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use glam::{DAffine3, DVec3};
use pointstage_engine::stage::{Background, SettingValue};
use pointstage_scene::ViewRecord;

use super::app::App;
use super::app_tests::{self, SQUARE, app, window_of};
use super::intent::{FileIntent, Intent, OpenMode, Overwrite, WindowIntent};
use crate::preferences;

/// Longer than any step takes on a machine that other tests keep busy.
const LIMIT: Duration = Duration::from_mins(1);

type Window = Harness<'static, App>;

/// A window that remembers in `folder`.
fn window(folder: &Path) -> Window {
    let mut app = app();
    app.remember(preferences::open(&folder.join("state")))
        .expect("a thread");
    let mut window = window_of(app);
    window.run_steps(3);
    window
}

fn wait_until(window: &mut Window, what: &str, holds: impl Fn(&Window) -> bool) {
    let start = Instant::now();
    while !holds(window) {
        assert!(
            start.elapsed() < LIMIT,
            "{what} did not come: {:?}",
            messages(window)
        );
        window.step();
        std::thread::yield_now();
    }
}

fn ask(window: &mut Window, intent: impl Into<Intent>) {
    app_tests::ask(window, intent, 1);
}

fn messages(window: &Window) -> Vec<String> {
    let entries = window.state().log.entries().iter();
    entries.map(|entry| entry.notice.text.clone()).collect()
}

fn names(window: &Window) -> Vec<String> {
    let objects = window.state().session.scene.objects().iter();
    objects.map(|object| object.name.clone()).collect()
}

fn scan(folder: &Path, name: &str) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, SQUARE).expect("written");
    path
}

fn open(window: &mut Window, path: &Path) {
    ask(
        window,
        FileIntent::Open(vec![path.to_path_buf()], OpenMode::Replace),
    );
    wait_until(window, "the end of the load", |window| {
        window.state().tasks.open().is_empty()
    });
}

fn save(window: &mut Window, path: &Path) {
    ask(
        window,
        FileIntent::SaveSession(path.to_path_buf(), Overwrite::Agreed),
    );
    wait_until(window, "the saved session", |window| {
        window.state().remembered.session_path.as_deref() == Some(path)
    });
}

#[test]
fn a_saved_session_gives_back_all_that_it_was_saved_with() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = std::fs::canonicalize(folder.path()).expect("it is there");
    let (a, b) = (scan(&folder, "a.ply"), scan(&folder, "b.ply"));
    let mut window = window(&folder);
    open(&mut window, &a);
    let session = &mut window.state_mut().session;
    let id = session.scene.objects()[0].id;
    session.edit_scene(|scene| {
        scene.edit(id, |object| {
            object.name = "Büste".to_owned();
            object.visible = false;
            object.material.ks = 0.7;
            object.world_from_object = DAffine3::from_translation(DVec3::new(1e6, 0.1, -0.0));
        })
    });
    session.panes.active.camera.eye = DVec3::new(0.1, 0.2, 0.3);
    session.panes.active.view.background = Background::Solid([0.1, 0.2, 0.3]);
    session.panes.active.lights.lights.truncate(1);
    session.views.slots[3] = Some(ViewRecord::new(session.panes.active.camera, 8, 6));
    let values = session
        .panes
        .active
        .settings
        .entry("org.example.gone".to_owned());
    values
        .or_default()
        .insert("size".to_owned(), SettingValue::Float(3.0));
    session.panes.active.preview = Some("org.example.gone".to_owned());
    let saved = window.state().session.clone();
    let path = folder.join("a.pointstage.toml");
    save(&mut window, &path);
    let text = std::fs::read_to_string(&path).expect("readable");
    assert!(text.contains("file = \"a.ply\""), "{text}");

    open(&mut window, &b);
    let state = window.state_mut();
    assert_eq!(
        state.remembered.session_path, None,
        "another scan is another session"
    );
    state.session.panes.active.settings.clear();
    state.session.panes.active.preview = None;
    open(&mut window, &path);
    let now = &window.state().session;
    assert_eq!(names(&window), ["Büste"]);
    let (object, before) = (&now.scene.objects()[0], &saved.scene.objects()[0]);
    assert_eq!(
        (object.visible, object.material, object.world_from_object),
        (before.visible, before.material, before.world_from_object)
    );
    assert_eq!(
        now.panes.active.camera, saved.panes.active.camera,
        "opening frames nothing"
    );
    assert_eq!(
        (&now.panes.active.view, &now.panes.active.lights),
        (&saved.panes.active.view, &saved.panes.active.lights)
    );
    assert_eq!(now.views, saved.views);
    assert_eq!(
        now.panes.active.settings, saved.panes.active.settings,
        "also of renderers that are not there"
    );
    assert_eq!(now.panes.active.preview, saved.panes.active.preview);
    let warned = messages(&window);
    assert!(
        warned
            .iter()
            .any(|text| text.contains("'org.example.gone' is not there")),
        "{warned:?}"
    );
    // What is saved again says the same.
    save(&mut window, &path);
    assert_eq!(std::fs::read_to_string(&path).expect("readable"), text);
}

#[test]
fn objects_whose_files_are_gone_are_named_and_saved_again() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = std::fs::canonicalize(folder.path()).expect("it is there");
    let mut window = window(&folder);
    for name in ["a.ply", "b.ply", "c.ply"] {
        let path = scan(&folder, name);
        ask(&mut window, FileIntent::Open(vec![path], OpenMode::Add));
    }
    wait_until(&mut window, "three objects", |window| {
        names(window).len() == 3
    });
    let path = folder.join("abc.pointstage.toml");
    save(&mut window, &path);
    std::fs::remove_file(folder.join("b.ply")).expect("removed");
    std::fs::write(folder.join("c.ply"), "no scan").expect("written");
    open(&mut window, &path);
    assert_eq!(names(&window), ["a"]);
    let said = messages(&window).join("\n");
    for part in ["1 scene file is not there", "b.ply", "c.ply: starts with"] {
        assert!(said.contains(part), "no '{part}' in {said}");
    }
    save(&mut window, &path);
    let text = std::fs::read_to_string(&path).expect("readable");
    for name in ["a.ply", "b.ply", "c.ply"] {
        assert!(text.contains(&format!("file = \"{name}\"")), "{text}");
    }
}

#[test]
fn a_session_with_a_flaw_changes_nothing_and_says_where_it_is() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut window = window(folder.path());
    let a = scan(folder.path(), "a.ply");
    open(&mut window, &a);
    let path = folder.path().join("bad.pointstage.toml");
    std::fs::write(&path, "format = 1\nview = 3\n").expect("written");
    open(&mut window, &path);
    let said = messages(&window).join("\n");
    assert!(
        said.contains("bad.pointstage.toml, line 2, column 8"),
        "{said}"
    );
    assert_eq!(names(&window), ["a"]);
}

#[test]
fn saving_over_another_file_asks_first() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut window = window(folder.path());
    let path = folder.path().join("mine.toml");
    std::fs::write(&path, "precious").expect("written");
    ask(
        &mut window,
        FileIntent::SaveSession(path.clone(), Overwrite::Ask),
    );
    window.run_steps(2);
    window.get_by_label("mine.toml is there already. Save replaces it.");
    assert_eq!(std::fs::read(&path).expect("readable"), b"precious");
    window.get_by_label("Save").click();
    wait_until(&mut window, "the saved session", |window| {
        window.state().remembered.session_path.as_ref() == Some(&path)
    });
    let text = std::fs::read_to_string(&path).expect("readable");
    assert!(text.starts_with("format = 1"), "{text}");
}

#[test]
fn reloading_reads_what_changed_and_keeps_the_rest() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut window = window(folder.path());
    let path = scan(folder.path(), "a.ply");
    open(&mut window, &path);
    let session = &mut window.state_mut().session;
    let id = session.scene.objects()[0].id;
    session.edit_scene(|scene| scene.edit(id, |object| object.material.ks = 0.7));
    let camera = session.panes.active.camera;
    let more = SQUARE.replace("vertex 4", "vertex 5") + "2 2 0 0 0 1\n";
    std::fs::write(&path, more).expect("written");
    ask(&mut window, FileIntent::Reload);
    wait_until(&mut window, "the fifth surfel", |window| {
        window.state().session.scene.surfel_count() == 5
    });
    let session = &window.state().session;
    assert_eq!(session.panes.active.camera, camera);
    assert_eq!(session.scene.objects()[0].material.ks, 0.7);
}

#[test]
fn a_window_goes_on_with_what_the_last_one_left() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = scan(folder.path(), "a.ply");
    let mut first = window(folder.path());
    open(&mut first, &path);
    ask(
        &mut first,
        WindowIntent::Theme(egui::ThemePreference::Light),
    );
    ask(&mut first, WindowIntent::TextScale(1.5));
    let state = first.state_mut();
    state.panels.log = true;
    state.session.panes.active.view.exposure = 2.0;
    state.session.pacing.rate_limit = Some(30);
    first.run_steps(3);
    drop(first);

    std::fs::remove_file(&path).expect("removed");
    let mut second = window(folder.path());
    wait_until(&mut second, "the look for recent files", |window| {
        !window.state().remembered.missing.is_empty()
    });
    second.run_steps(2);
    let state = second.state();
    assert!(state.panels.log);
    assert_eq!(state.session.panes.active.view.exposure, 2.0);
    assert_eq!(state.session.pacing.rate_limit, Some(30));
    assert_eq!(second.ctx.zoom_factor(), 1.5);
    assert!(!second.ctx.global_style().visuals.dark_mode);
    // The welcome offers the file, greyed out since it is gone.
    let recent = second.get_by_label_contains("a.ply – ");
    assert!(recent.accesskit_node().is_disabled());
    assert!(messages(&second).is_empty(), "{:?}", messages(&second));
}

#[test]
fn damaged_settings_are_set_aside_with_one_message() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let state = folder.path().join("state");
    std::fs::create_dir(&state).expect("made");
    std::fs::write(
        state.join("settings.toml"),
        "format = 1\n[look]\nexposure = -1\n",
    )
    .expect("written");
    let window = window(folder.path());
    let said = messages(&window);
    assert!(
        said.len() == 1
            && said[0].contains("line 3, column 12")
            && said[0].contains("settings.damaged-1.toml"),
        "{said:?}"
    );
    assert_eq!(window.state().session.panes.active.view.exposure, 1.0);
}

#[test]
fn a_bug_report_is_put_together_from_the_window() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut window = window(folder.path());
    let path = scan(folder.path(), "a.ply");
    open(&mut window, &path);
    ask(&mut window, FileIntent::CopyBugReport);
    let text = window.state().bug_report();
    for part in ["# Pointstage: bug report", "## Plugins", "```toml", "a.ply"] {
        assert!(text.contains(part), "no '{part}' in {text}");
    }
    let said = messages(&window).join("\n");
    assert!(said.contains("on the clipboard"), "{said}");
}
