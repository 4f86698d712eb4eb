//! What happens when a plugin that loaded misbehaves: panics, errors, bad commands, endless work.
//!
//! Every case ends in a notice that names the plugin and the fault, with a picture by the last good renderer, and with a
//! session in which that renderer goes on drawing.

use anyhow::{Context as _, Result, ensure};
use pointstage_engine::plugins::{
    CallState, ChildProgram, DiscoverOptions, Examination, HostInstance, Registry,
};
use pointstage_engine::stage::{
    FALLBACK_ID, FrameRequest, FrameResult, Notice, Patience, Role, SettingValue, Stage,
    StageOptions,
};
use pointstage_plugin_api::ErrorCode;
use pointstage_plugin_api::abi::{PrepareRecord, SceneRecord};
use pointstage_scene::{Block, Camera, Geometry, Object, Origins, Scene};
use pointstage_tests::data::skip;
use pointstage_tests::plugins::{self, Variant};
use pointstage_tests::stages::of_libraries;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How long a picture may be in the making; only an endless preparation takes so long.
const LONGEST_WAIT: Duration = Duration::from_mins(1);

fn id(fault: &str) -> String {
    format!("org.pointstage.test.{fault}")
}

fn request(fault: &str) -> FrameRequest {
    let position_radius = vec![[0.0, 0.0, 0.0, 0.5]].into();
    let block = Block {
        position_radius,
        ..Block::default()
    };
    let geometry = Geometry::new(vec![block], None, Origins::default());
    let mut scene = Scene::new();
    scene.add(Object::new("one surfel", glam::DVec3::ZERO, geometry));
    let camera = Camera {
        eye: glam::DVec3::new(0.0, 0.0, 4.0),
        ..Camera::default()
    };
    let mut request = FrameRequest::still(Arc::new(scene), camera, [32, 24], id(fault));
    request.patience = Patience::DrawMeanwhile;
    request
}

/// Draws until no preparation is under way; the last result, and all notices.
fn settled(stage: &mut Stage, request: &FrameRequest) -> Result<(FrameResult, Vec<Notice>)> {
    let start = Instant::now();
    let mut notices = Vec::new();
    loop {
        let mut result = stage.frame(request)?;
        notices.append(&mut result.notices);
        if result.preparing.is_none() {
            return Ok((result, notices));
        }
        ensure!(
            start.elapsed() < LONGEST_WAIT,
            "still preparing: {:?}",
            result.preparing
        );
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Asserts that `fault` ends in a notice with `expected`, with the good renderer drawing before, meanwhile and after.
fn assert_survived(stage: &mut Stage, fault: &str, expected: &str) -> Result<()> {
    let (before, _) = settled(stage, &request("good"))?;
    assert_eq!(before.drawn_by, id("good"), "before {fault}");
    let (during, notices) = settled(stage, &request(fault))?;
    assert_eq!(
        during.drawn_by,
        id("good"),
        "the last good one stands in for {fault}: {notices:?}"
    );
    let told = notices.iter().find(|notice| notice.plugin == id(fault));
    let notice = told.with_context(|| format!("no notice about {fault} among {notices:?}"))?;
    assert!(
        notice.text.contains(expected),
        "{fault}: expected '{expected}' in '{}'",
        notice.text
    );
    let (after, _) = settled(stage, &request("good"))?;
    assert_eq!(after.drawn_by, id("good"), "after {fault}");
    Ok(())
}

#[test]
fn panics_and_errors_in_every_entry_point_are_survived() -> Result<()> {
    let mut stage = of_libraries(vec![plugins::misbehaving()?], false)?;
    for (fault, expected) in [
        ("panic-prepare", "asked to panic in prepare"),
        ("panic-view", "asked to panic in view"),
        ("panic-render", "asked to panic in render"),
        ("error-prepare", "asked to fail in prepare"),
        ("error-view", "asked to fail in view"),
        ("error-render", "asked to fail in render"),
    ] {
        assert_survived(&mut stage, fault, expected)?;
    }
    Ok(())
}

#[test]
fn a_panic_in_the_next_preparation_keeps_the_previous_one_drawing() -> Result<()> {
    let mut stage = of_libraries(vec![plugins::misbehaving()?], false)?;
    let mut request = request("panic-prepare-next");
    let (first, _) = settled(&mut stage, &request)?;
    assert_eq!(first.drawn_by, id("panic-prepare-next"));
    request
        .settings
        .insert("again".into(), SettingValue::Int(1));
    let (_, notices) = settled(&mut stage, &request)?;
    let told = notices
        .iter()
        .any(|notice| notice.text.contains("asked to panic in prepare_next"));
    assert!(told, "{notices:?}");
    settled(&mut stage, &self::request("good"))?;
    Ok(())
}

#[test]
fn a_panic_in_drop_reaches_the_log_and_nothing_else() -> Result<()> {
    let mut stage = of_libraries(vec![plugins::misbehaving()?], false)?;
    for fault in ["panic-drop-prepared", "panic-drop-view"] {
        let (result, _) = settled(&mut stage, &request(fault))?;
        assert_eq!(result.drawn_by, id(fault), "it draws well");
    }
    let log = stage.registry().log();
    drop(stage);
    let lines = log.lines();
    for place in ["renderer's drop", "view's drop"] {
        let told = lines.iter().any(|line| {
            line.text
                .contains(&format!("asked to panic in the {place}"))
        });
        assert!(told, "no line about the {place} in {lines:?}");
    }
    Ok(())
}

#[test]
fn an_endless_preparation_does_not_stop_the_session() -> Result<()> {
    let mut stage = of_libraries(vec![plugins::misbehaving()?], false)?;
    settled(&mut stage, &request("good"))?;
    let start = Instant::now();
    let result = stage.frame(&request("endless-prepare"))?;
    assert_eq!(result.drawn_by, id("good"));
    assert!(
        result.preparing.is_some(),
        "it is told that the other one is prepared"
    );
    // One frame, not the hour that the plugin would take: generous, since test machines are slow.
    assert!(
        start.elapsed() < Duration::from_secs(10),
        "{:?}",
        start.elapsed()
    );
    let (after, _) = settled(&mut stage, &request("good"))?;
    assert_eq!(after.drawn_by, id("good"));
    Ok(())
}

#[test]
fn while_a_preview_is_prepared_the_main_renderer_stands_in_for_it() -> Result<()> {
    let mut stage = of_libraries(vec![plugins::misbehaving()?], false)?;
    let main = FrameRequest {
        role: Role::Main,
        ..request("good")
    };
    settled(&mut stage, &main)?;
    let result = stage.frame(&FrameRequest {
        role: Role::Preview,
        ..request("endless-prepare")
    })?;
    assert_eq!(result.drawn_by, id("good"), "not the fallback");
    Ok(())
}

#[test]
fn an_endless_preparation_that_is_waited_for_ends_at_the_limit() -> Result<()> {
    let plugins = DiscoverOptions {
        files: vec![plugins::misbehaving()?],
        ..DiscoverOptions::default()
    };
    let prepare_limit = Duration::from_millis(300);
    let mut stage = Stage::new(StageOptions {
        use_device: false,
        plugins,
        prepare_limit,
        ..StageOptions::default()
    })?;
    for fault in ["endless-prepare", "slow-prepare"] {
        let waiting = FrameRequest {
            patience: Patience::Wait,
            ..request(fault)
        };
        let error = stage
            .frame(&waiting)
            .expect_err("the limit is far below what it takes");
        assert!(!error.to_string().is_empty());
    }
    let (after, _) = settled(&mut stage, &request("good"))?;
    assert_eq!(after.drawn_by, id("good"));
    Ok(())
}

#[test]
fn a_time_budget_ends_a_long_frame_with_what_there_is() -> Result<()> {
    let mut stage = of_libraries(vec![plugins::misbehaving()?], false)?;
    let request = FrameRequest {
        time_budget: Some(Duration::from_millis(50)),
        patience: Patience::Wait,
        ..request("slow-render")
    };
    let start = Instant::now();
    let result = stage.frame(&request)?;
    assert_eq!(result.drawn_by, id("slow-render"));
    assert!(result.progress < 1.0, "it says that there is more to come");
    // Not the minute that it would take: generous, since test machines are slow.
    assert!(
        start.elapsed() < Duration::from_secs(20),
        "{:?}",
        start.elapsed()
    );
    Ok(())
}

#[test]
fn a_renderer_that_gives_up_at_its_time_budget_draws_late_and_keeps_its_place() -> Result<()> {
    let mut stage = of_libraries(vec![plugins::misbehaving()?], false)?;
    let request = FrameRequest {
        time_budget: Some(Duration::from_millis(50)),
        ..request("giving-up-render")
    };
    for frame in ["first", "second"] {
        let (result, notices) = settled(&mut stage, &request)?;
        assert_eq!(result.drawn_by, id("giving-up-render"), "{frame}");
        assert_eq!(result.progress, 1.0, "{frame}");
        assert!(notices.is_empty(), "{notices:?}");
    }
    Ok(())
}

#[test]
fn nan_in_every_target_still_makes_a_picture() -> Result<()> {
    let mut stage = of_libraries(vec![plugins::misbehaving()?], false)?;
    let (result, _) = settled(&mut stage, &request("nan-targets"))?;
    assert_eq!(result.picture.size_px, [32, 24]);
    let (after, _) = settled(&mut stage, &request("good"))?;
    assert_eq!(after.drawn_by, id("good"));
    Ok(())
}

#[test]
fn without_a_good_renderer_the_built_in_one_stands_in() -> Result<()> {
    let mut stage = of_libraries(vec![plugins::misbehaving()?], false)?;
    let (result, notices) = settled(&mut stage, &request("panic-render"))?;
    assert_eq!(result.drawn_by, FALLBACK_ID);
    assert!(!notices.is_empty());
    Ok(())
}

#[test]
fn a_renderer_that_needs_a_device_says_so_where_there_is_none() -> Result<()> {
    let mut stage = of_libraries(vec![plugins::misbehaving()?], false)?;
    let (result, notices) = settled(&mut stage, &request("bad-wgsl"))?;
    assert_eq!(result.drawn_by, FALLBACK_ID);
    let told = notices
        .iter()
        .any(|notice| notice.text.contains("graphics device"));
    assert!(told, "{notices:?}");
    Ok(())
}

#[test]
fn bad_requests_to_the_gpu_service_are_survived() -> Result<()> {
    let mut stage = of_libraries(
        vec![plugins::misbehaving()?, plugins::variant(Variant::Newer)?],
        true,
    )?;
    if stage.device().is_none() {
        skip("no graphics device, not even a software one");
        return Ok(());
    }
    for (fault, expected) in [
        ("bad-wgsl", "nonsense"),
        ("draw-outside-pass", "command 0"),
        ("no-pipeline", "command 1"),
        ("stale-handle", "command 0"),
        ("unended-pass", "pass"),
        ("greedy", "quota"),
        ("huge", ""),
        ("novel-command", "operation 9999 is not known"),
    ] {
        assert_survived(&mut stage, fault, expected)?;
    }
    let (handles, bytes) = stage.holdings(&id("greedy"));
    assert_eq!(
        (handles, bytes),
        (0, 0),
        "what a failed preparation took is free again"
    );
    Ok(())
}

#[test]
fn a_lost_device_is_replaced_and_everybody_draws_on() -> Result<()> {
    let mut stage = of_libraries(vec![plugins::misbehaving()?], true)?;
    let Some(device) = stage.device().cloned() else {
        skip("no graphics device, not even a software one");
        return Ok(());
    };
    settled(&mut stage, &request("good"))?;
    device.destroy();
    let (_, notices) = settled(&mut stage, &request("good"))?;
    assert!(
        notices.iter().any(|notice| notice.text.contains("lost")),
        "{notices:?}"
    );
    let (after, _) = settled(&mut stage, &request("good"))?;
    assert_eq!(after.drawn_by, id("good"));
    let renewed = stage.device().context("a new device")?;
    assert!(renewed.generation > device.generation);
    Ok(())
}

#[test]
fn a_plugin_of_a_newer_border_draws() -> Result<()> {
    let mut stage = of_libraries(vec![plugins::variant(Variant::Newer)?], false)?;
    let (result, notices) = settled(&mut stage, &request("variant"))?;
    assert_eq!(result.drawn_by, id("variant"), "{notices:?}");
    let middle = (12 * 32 + 16) * 4;
    assert_eq!(
        result.picture.rgba[middle..middle + 4],
        [0, 255, 0, 255],
        "it paints all green"
    );
    Ok(())
}

#[test]
fn a_structure_that_panics_is_done_without() -> Result<()> {
    let mut stage = of_libraries(vec![plugins::misbehaving()?], false)?;
    let mut request = request("good");
    request.structure = Some(id("panic-select"));
    let (first, notices) = settled(&mut stage, &request)?;
    assert_eq!(first.drawn_by, id("good"), "{notices:?}");
    assert_eq!(first.stats.surfels_selected, 1, "the whole scene is drawn");
    let told = |notices: &[Notice]| {
        let of_structure = notices.iter().filter(|n| n.plugin == id("panic-select"));
        of_structure.map(|n| n.text.clone()).collect::<Vec<_>>()
    };
    let texts = told(&notices);
    assert!(
        texts.len() == 1 && texts[0].contains("asked to panic in select"),
        "{notices:?}"
    );
    let (next, notices) = settled(&mut stage, &request)?;
    assert_eq!(next.drawn_by, id("good"));
    assert_eq!(told(&notices), [""; 0], "it is told once");
    request.patience = Patience::Wait;
    let error = stage.frame(&request).err().context("it was waited for")?;
    assert!(error.to_string().contains("panic-select"), "{error}");
    Ok(())
}

/// A crash is no error value: it has to happen in a process of its own.
#[test]
fn what_crashes_at_first_use_crashes_in_a_child() -> Result<()> {
    let child = ChildProgram::new(env!("CARGO_BIN_EXE_examiner").into());
    let plugins = DiscoverOptions {
        files: vec![plugins::misbehaving()?],
        examination: Examination::Child(child),
        ..DiscoverOptions::default()
    };
    let mut stage = Stage::new(StageOptions {
        use_device: false,
        plugins,
        ..StageOptions::default()
    })?;
    let (result, notices) = settled(&mut stage, &request("abort-render"))?;
    assert_eq!(result.drawn_by, FALLBACK_ID);
    let crashed = |notices: &[Notice], fault: &str| {
        let name = id(fault);
        notices
            .iter()
            .any(|notice| notice.text.contains(&name) && notice.text.contains("crashed"))
    };
    assert!(crashed(&notices, "abort-render"), "{notices:?}");

    let mut with_structure = request("good");
    with_structure.structure = Some(id("abort-prepare"));
    let (result, notices) = settled(&mut stage, &with_structure)?;
    assert_eq!(result.drawn_by, id("good"), "{notices:?}");
    assert!(crashed(&notices, "abort-prepare"), "{notices:?}");
    Ok(())
}

#[test]
#[expect(
    clippy::default_trait_access,
    reason = "the border's slices have no name outside of it"
)]
fn a_cancelled_preparation_returns_at_once() -> Result<()> {
    let files = vec![plugins::misbehaving()?];
    let registry = Registry::discover(&DiscoverOptions {
        files,
        ..DiscoverOptions::default()
    });
    let info = registry.find_renderer("slow-prepare")?;
    let factory = registry.load(&info)?;
    let call = CallState::new();
    let (code, time) = std::thread::scope(|scope| -> Result<_> {
        let worker = scope.spawn(|| {
            let record = PrepareRecord {
                host: HostInstance::border(&info, None, 1, registry.log()),
                scene: SceneRecord {
                    revision: 1,
                    objects: Default::default(),
                },
                changes: Default::default(),
                settings: Default::default(),
                call: call.border(),
            };
            factory
                .object()
                .prepare_renderer(&record)
                .into_result()
                .map_err(|error| error.code)
                .err()
        });
        while call.progress().0 == 0.0 && !worker.is_finished() {
            std::thread::sleep(Duration::from_millis(1));
        }
        let start = Instant::now();
        call.cancel();
        let code = worker
            .join()
            .map_err(|_| anyhow::anyhow!("the call panicked"))?;
        Ok((code, start.elapsed()))
    })?;
    assert_eq!(code, Some(ErrorCode::CANCELLED));
    // The rule is 200 ms; the plugin asks every 10 ms. The rest is for a machine with much else to do.
    assert!(time < Duration::from_secs(2), "{time:?}");
    Ok(())
}
