//! The whole window without a display or a device: the built-in renderer draws.

use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointstage_engine::plugins::DiscoverOptions;
use pointstage_engine::stage::{FALLBACK_ID, StageOptions};

use super::app::{App, Start};
use super::intent::Intent;
use super::stage_link::StageLink;

/// Longer than any step takes on a machine that other tests keep busy.
const LIMIT: Duration = Duration::from_mins(1);

/// Four surfels with normals, facing +z.
pub(super) const SQUARE: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\nend_header\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n1 1 0 0 0 1\n";

/// An empty window's program.
pub(super) fn app() -> App {
    let options = StageOptions {
        use_device: false,
        plugins: DiscoverOptions::default(),
        ..StageOptions::default()
    };
    // The harness steps by itself; nobody needs to be woken.
    let wake: Arc<dyn Fn() + Send + Sync> = Arc::new(|| ());
    let app = App::new(Start {
        stage: StageLink::start(options, &wake).expect("a thread"),
        wake,
        files: Vec::new(),
        samples: Vec::new(),
    });
    app.expect("a thread")
}

/// The window of a program.
pub(super) fn window_of(app: App) -> Harness<'static, App> {
    Harness::builder()
        .with_size([1000.0, 700.0])
        .build_ui_state(|ui, app: &mut App| app.pass(ui), app)
}

/// An empty window.
pub(super) fn window() -> Harness<'static, App> {
    window_of(app())
}

/// Steps until `holds`.
pub(super) fn wait_until(
    harness: &mut Harness<'static, App>,
    holds: impl Fn(&Harness<'static, App>) -> bool,
) {
    let start = Instant::now();
    while !holds(harness) {
        assert!(
            start.elapsed() < LIMIT,
            "it did not come to pass: {:?}",
            harness.root()
        );
        harness.step();
        std::thread::yield_now();
    }
}

pub(super) fn type_path(harness: &mut Harness<'static, App>, path: &std::path::Path) {
    harness.get_by_label("Type a path…").click();
    harness.run_steps(3);
    let field = harness.get_by_role_and_label(Role::TextInput, "Path of a file:");
    field.type_text(&path.display().to_string());
    harness.run_steps(2);
    harness.key_press(egui::Key::Enter);
    harness.run_steps(2);
}

/// A window that shows the [`SQUARE`], from a file of that folder.
pub(super) fn window_with_square(folder: &std::path::Path) -> Harness<'static, App> {
    let path = folder.join("square.ply");
    std::fs::write(&path, SQUARE).expect("written");
    let mut harness = window();
    harness.run_steps(2);
    type_path(&mut harness, &path);
    wait_until(&mut harness, |harness| {
        harness.query_by_label("4 surfels, 4 drawn").is_some()
    });
    harness
}

/// Carries out what the user asked for, then makes so many passes.
pub(super) fn ask(harness: &mut Harness<'static, App>, intent: impl Into<Intent>, passes: usize) {
    let ctx = harness.ctx.clone();
    harness.state_mut().apply(&ctx, intent.into());
    harness.run_steps(passes);
}

#[test]
fn a_typed_path_is_loaded_and_drawn() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("square.ply");
    std::fs::write(&path, SQUARE).expect("written");
    let mut harness = window();
    harness.run_steps(2);
    harness.get_by_label("Nothing on the stage yet");
    type_path(&mut harness, &path);
    wait_until(&mut harness, |harness| {
        harness.query_by_label("4 surfels, 4 drawn").is_some()
    });
    assert!(harness.query_by_label("Nothing on the stage yet").is_none());
    assert_eq!(harness.state().session.panes.active.renderer, FALLBACK_ID);
}

#[test]
fn a_path_that_is_not_there_is_an_error_on_the_screen() {
    let mut harness = window();
    harness.run_steps(2);
    type_path(&mut harness, std::path::Path::new("/no/such.ply"));
    wait_until(&mut harness, |harness| {
        harness
            .query_by_label_contains("/no/such.ply: cannot be read")
            .is_some()
    });
    harness.get_by_label("Log: 1 error");
    harness.get_by_label("Nothing on the stage yet");
}

#[test]
fn dismissed_and_cleared_errors_are_gone() {
    let mut harness = window();
    harness.run_steps(2);
    type_path(&mut harness, std::path::Path::new("/no/such.ply"));
    wait_until(&mut harness, |harness| {
        harness.query_by_label("Dismiss").is_some()
    });
    harness.get_by_label("Dismiss").click();
    harness.run_steps(3);
    assert!(harness.query_by_label("Dismiss").is_none());
    harness.get_by_label("Log: 1 error").click();
    harness.run_steps(3);
    harness.get_by_label("Clear").click();
    harness.run_steps(3);
    harness.get_by_label("Nothing to report.");
}
