//! Several viewports on one stage: one scene on the device, and nothing prepared twice or taken from each other.

use anyhow::Result;
use pointstage_engine::plugins::DiscoverOptions;
use pointstage_engine::stage::{
    FrameRequest, Patience, SettingValue, SettingValues, Stage, StageOptions, ViewportId,
};
use pointstage_tests::plugins::{self, replace_all, spoiled};
use pointstage_tests::{scenes, stages};
use std::time::{Duration, Instant};

const SLEEPER: &str = "org.pointstage.test.sleeper";

fn slowly_prepared(request: &FrameRequest, viewport: u32, prepare_ms: i64) -> FrameRequest {
    let settings = [("prepare_ms".to_owned(), SettingValue::Int(prepare_ms))];
    FrameRequest {
        viewport: ViewportId(viewport),
        settings: SettingValues::from(settings),
        patience: Patience::DrawMeanwhile,
        ..request.clone()
    }
}

/// Asks again until what is prepared for the request draws.
fn draw_when_prepared(stage: &mut Stage, request: &FrameRequest) -> Result<()> {
    let start = Instant::now();
    while stage.frame(request)?.preparing.is_some() {
        anyhow::ensure!(start.elapsed() < Duration::from_mins(1), "never prepared");
    }
    Ok(())
}

#[test]
fn one_renderer_with_different_costly_settings_is_prepared_once_for_each() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let mut stage = stage_with(vec![plugins::sleeper()?])?;
    let scene = stages::scene(folder.path(), "grid.ply", &scenes::grid(4))?;
    let frame = stages::window_frame(&scene, [8, 6], SLEEPER);
    let views = [(0, 300), (1, 301), (2, 302)];
    let requests = views.map(|(viewport, time)| slowly_prepared(&frame, viewport, time));
    for request in &requests {
        draw_when_prepared(&mut stage, request)?;
    }
    for round in 0..3 {
        for request in &requests {
            let again = stage.frame(request)?;
            assert_eq!(again.preparing, None, "round {round}: {request:?}");
        }
    }
    // One that takes over another's settings finds them prepared.
    let shared = stage.frame(&slowly_prepared(&frame, 2, 301))?;
    assert_eq!(shared.preparing, None);
    // What only that one had drawn with is not kept.
    let left = stage.frame(&slowly_prepared(&frame, 2, 302))?;
    assert!(left.preparing.is_some());
    // Closing it takes nothing from those that go on.
    stage.close_viewport(ViewportId(2));
    for request in &requests[..2] {
        assert_eq!(stage.frame(request)?.preparing, None);
    }
    Ok(())
}

#[test]
fn two_builds_of_one_plugin_draw_side_by_side() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let build = plugins::sleeper()?;
    let other = spoiled(&build, folder.path(), "other", |bytes| {
        assert!(replace_all(bytes, b"takes as long", b"needs as long") > 0);
    })?;
    let mut stage = stage_with(vec![build, other])?;
    let builds = stage.registry().renderers();
    let keys: Vec<String> = builds
        .iter()
        .map(|info| format!("{}#{}", info.id, info.hash))
        .collect();
    assert_eq!(keys.len(), 2, "{keys:?}");
    let scene = stages::scene(folder.path(), "grid.ply", &scenes::grid(4))?;
    let frame = stages::window_frame(&scene, [8, 6], SLEEPER);
    let requests: Vec<FrameRequest> = keys
        .iter()
        .zip(0..)
        .map(|(key, viewport)| FrameRequest {
            renderer: key.clone(),
            ..slowly_prepared(&frame, viewport, 300)
        })
        .collect();
    for request in &requests {
        draw_when_prepared(&mut stage, request)?;
    }
    for request in requests.iter().chain(&requests) {
        assert_eq!(stage.frame(request)?.preparing, None, "{request:?}");
    }
    Ok(())
}

#[test]
fn four_viewports_hold_the_scene_once() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let mut stage = stages::stage(&["points", "surfel"])?;
    let scene = stages::scene(folder.path(), "sphere.ply", &scenes::sphere(20_000, 0.01))?;
    let of = |viewport: u32, renderer: &str| FrameRequest {
        viewport: ViewportId(viewport),
        ..stages::window_frame(&scene, [64, 48], renderer)
    };
    let alone = stage.frame(&of(0, "points"))?.stats.scene_bytes;
    assert!(alone >= 20_000 * 16, "{alone} bytes");
    for (viewport, renderer) in [(1, "surfel"), (2, "points"), (3, "surfel")] {
        let stats = stage.frame(&of(viewport, renderer))?.stats;
        assert_eq!(stats.scene_bytes, alone, "viewport {viewport}");
    }
    // A scene that one of the viewports still draws stays; what none draws goes.
    let other = stages::scene(folder.path(), "small.ply", &scenes::sphere(100, 0.1))?;
    let with_other = |viewport: u32| FrameRequest {
        scene: other.clone(),
        ..of(viewport, "points")
    };
    let both = stage.frame(&with_other(0))?.stats.scene_bytes;
    assert!(both > alone, "{both} bytes");
    for viewport in 1..3 {
        stage.frame(&with_other(viewport))?;
    }
    stage.close_viewport(ViewportId(3));
    let small = stage.frame(&with_other(0))?.stats.scene_bytes;
    assert_eq!(small, both - alone);
    Ok(())
}

fn stage_with(files: Vec<std::path::PathBuf>) -> Result<Stage> {
    let options = StageOptions {
        use_device: false,
        plugins: DiscoverOptions {
            files,
            ..DiscoverOptions::default()
        },
        ..StageOptions::default()
    };
    Ok(Stage::new(options)?)
}
