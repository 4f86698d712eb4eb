//! Managing plugins while a session runs: cancel, set aside, try again, reload, add and remove a folder.

use anyhow::{Context as _, Result};
use pointstage_engine::plugins::{DiscoverOptions, FoundIn, VerdictClass};
use pointstage_engine::stage::{
    FALLBACK_ID, FrameRequest, Patience, SettingValue, Stage, StageOptions, StageThread, ViewportId,
};
use pointstage_scene::Scene;
use pointstage_tests::plugins::{self, replace_all, spoiled};
use pointstage_tests::{scenes, stages};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};

const DOTS: &str = "org.pointstage.test.dots";
/// Far longer than anything here takes.
const PATIENCE: Duration = Duration::from_mins(1);

fn options(files: Vec<PathBuf>, state_folder: Option<PathBuf>) -> StageOptions {
    StageOptions {
        use_device: false,
        plugins: DiscoverOptions {
            files,
            state_folder,
            ..DiscoverOptions::default()
        },
        ..StageOptions::default()
    }
}

fn ball(folder: &Path) -> Result<Arc<Scene>> {
    stages::scene(folder, "ball", &scenes::sphere(500, 1.0))
}

fn draws(stage: &mut Stage, request: &FrameRequest) -> Result<(String, Arc<[u8]>)> {
    let result = stage.frame(request)?;
    Ok((result.drawn_by, result.picture.rgba))
}

/// A request that does not wait.
fn meanwhile(request: FrameRequest) -> FrameRequest {
    FrameRequest {
        patience: Patience::DrawMeanwhile,
        ..request
    }
}

#[test]
fn a_changed_library_is_loaded_anew_while_scene_and_settings_stay() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let plugin_folder = tempfile::tempdir()?;
    let library = spoiled(&plugins::sound()?, plugin_folder.path(), "dots", |_| {})?;
    let mut stage = Stage::new(options(vec![library], None))?;
    let mut request = stages::window_frame(&ball(folder.path())?, [64, 48], "dots");
    request
        .settings
        .insert("invert".into(), SettingValue::Bool(false));
    let (_, bright) = draws(&mut stage, &request)?;

    stage.rescan();
    let (_, same) = draws(&mut stage, &request)?;
    assert_eq!(bright, same, "nothing has changed");

    // The next build: another version, and dark unless told otherwise.
    spoiled(&plugins::sound()?, plugin_folder.path(), "dots", |bytes| {
        let count = replace_all(bytes, b"\"version\": \"0.1.0\"", b"\"version\": \"0.2.0\"");
        assert!(count > 0);
        let old = b"\"kind\": \"float\", \"default\": 1.0";
        assert_eq!(
            replace_all(bytes, old, b"\"kind\": \"float\", \"default\": 0.0"),
            1
        );
    })?;
    stage.rescan();
    let info = stage.registry().find_renderer("dots")?;
    assert_eq!(info.entry.version, "0.2.0");
    let (drawn_by, dark) = draws(&mut stage, &request)?;
    assert_eq!(drawn_by, DOTS);
    assert_ne!(bright, dark, "the new build draws");
    Ok(())
}

#[test]
fn a_file_set_aside_stays_so_in_the_next_session_until_it_is_tried_again() -> Result<()> {
    let (folder, state) = (tempfile::tempdir()?, tempfile::tempdir()?);
    let library = plugins::sound()?;
    let open = || {
        Stage::new(options(
            vec![library.clone()],
            Some(state.path().to_owned()),
        ))
    };
    let mut stage = open()?;
    let file = stage.registry().files()[0].clone();
    assert_eq!(file.found_in, FoundIn::Named);
    let request = stages::window_frame(&ball(folder.path())?, [64, 48], "dots");
    assert_eq!(draws(&mut stage, &request)?.0, DOTS);
    let load_time = stage.registry().files()[0].load_time();
    assert!(
        load_time.is_some_and(|time| !time.is_zero()),
        "it is loaded"
    );

    assert!(stage.set_plugin_aside(&file.path));
    assert!(!stage.set_plugin_aside(Path::new("/no/such/plugin.so")));
    let error = stage.frame(&request).expect_err("set aside");
    assert!(error.to_string().contains("set aside by you"), "{error}");
    drop(stage);

    let mut stage = open()?;
    let verdict = stage.registry().files()[0].verdict.clone();
    assert_eq!(verdict.class, VerdictClass::SetAside, "{}", verdict.message);
    assert!(verdict.is_quarantined() && verdict.in_words().contains("by you"));
    stage.retry_plugin(&file.path);
    assert_eq!(draws(&mut stage, &request)?.0, DOTS);
    Ok(())
}

#[test]
fn a_folder_is_added_and_removed_while_the_session_runs() -> Result<()> {
    let (folder, plugin_folder) = (tempfile::tempdir()?, tempfile::tempdir()?);
    spoiled(&plugins::sound()?, plugin_folder.path(), "dots", |_| {})?;
    let mut stage = Stage::new(options(Vec::new(), None))?;
    let request = meanwhile(stages::window_frame(
        &ball(folder.path())?,
        [64, 48],
        "dots",
    ));
    assert_eq!(draws(&mut stage, &request)?.0, FALLBACK_ID);

    stage.add_plugin_folder(plugin_folder.path())?;
    stage.add_plugin_folder(plugin_folder.path())?;
    assert_eq!(stage.plugin_folders().len(), 1, "once is enough");
    let registry = stage.registry();
    let file = registry.files().first().context("one plugin")?;
    assert_eq!(file.found_in.in_words(), "folder added by you");
    let waiting = FrameRequest {
        patience: Patience::Wait,
        ..request.clone()
    };
    assert_eq!(draws(&mut stage, &waiting)?.0, DOTS);

    assert!(stage.remove_plugin_folder(plugin_folder.path()));
    assert!(!stage.remove_plugin_folder(plugin_folder.path()));
    assert_eq!(draws(&mut stage, &request)?.0, FALLBACK_ID);
    Ok(())
}

#[test]
fn a_folder_that_is_none_is_refused_by_name_and_changes_nothing() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let mut stage = Stage::new(options(Vec::new(), None))?;
    let file = folder.path().join("file");
    std::fs::write(&file, b"")?;
    for bad in [folder.path().join("missing"), file] {
        let error = stage.add_plugin_folder(&bad).expect_err("no folder");
        let text = error.to_string();
        assert!(
            text.contains(&*bad.to_string_lossy()) && text.contains("choose a folder"),
            "{text}"
        );
    }
    assert!(stage.plugin_folders().is_empty());
    Ok(())
}

#[test]
fn a_cancelled_preparation_has_failed_until_it_is_tried_again() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let mut stage = Stage::new(options(vec![plugins::misbehaving()?], None))?;
    let scene = ball(folder.path())?;
    let frame = |name: &str| meanwhile(stages::window_frame(&scene, [32, 24], name));
    let good = FrameRequest {
        patience: Patience::Wait,
        ..frame("org.pointstage.test.good")
    };
    stage.frame(&good)?;
    for id in [
        "org.pointstage.test.endless-prepare",
        "org.pointstage.test.slow-prepare",
    ] {
        assert!(!stage.cancel_preparation(id), "nothing is under way");
        let waiting = stage.frame(&frame(id))?;
        assert!(waiting.preparing.is_some());
        assert!(stage.cancel_preparation(id));
        let after = stage.frame(&frame(id))?;
        assert_eq!(after.preparing, None, "it is not begun again");
        assert_eq!(after.drawn_by, "org.pointstage.test.good");
        let texts: Vec<&str> = after.notices.iter().map(|n| n.text.as_str()).collect();
        assert_eq!(texts.len(), 1, "told once: {texts:?}");
        assert!(texts[0].contains("cancelled"), "{texts:?}");
        assert_eq!(stage.frame(&frame(id))?.notices, []);
        stage.retry(id);
        let again = stage.frame(&frame(id))?;
        assert!(again.preparing.is_some(), "it is prepared again");
        assert!(stage.cancel_preparation(id));
    }
    Ok(())
}

#[test]
fn the_render_thread_cancels_while_the_window_only_watches() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let (wake, woken) = channel();
    let thread = StageThread::spawn(options(vec![plugins::misbehaving()?], None), move || {
        // Nobody listens any more when the test has ended.
        let _ = wake.send(());
    })?;
    let id = "org.pointstage.test.endless-prepare";
    let scene = ball(folder.path())?;
    thread.submit(meanwhile(stages::window_frame(&scene, [32, 24], id)));
    let start = Instant::now();
    let mut cancelled = false;
    loop {
        woken
            .recv_timeout(PATIENCE)
            .context("the thread is stuck")?;
        anyhow::ensure!(start.elapsed() < PATIENCE, "never cancelled");
        if !cancelled
            && thread
                .latest(ViewportId(0))
                .is_some_and(|frame| frame.preparing.is_some())
        {
            cancelled = true;
            thread.errand(move |stage| assert!(stage.cancel_preparation(id)));
        }
        // Without another frame: the notice comes with the errand.
        let notices = thread.take_notices();
        if notices
            .iter()
            .any(|notice| notice.text.contains("cancelled"))
        {
            return Ok(());
        }
    }
}
