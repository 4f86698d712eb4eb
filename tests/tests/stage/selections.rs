//! Draws that a structure selects by numbers, from the host and on the device with a count on the device: `points` and
//! `surfel` draw of them what they draw of a scene with just those surfels.

use std::sync::Arc;

use anyhow::Result;
use glam::{DAffine3, DVec3};
use pointstage_engine::stage::{FrameRequest, Stage};
use pointstage_scene::Scene;
use pointstage_tests::data::skip;
use pointstage_tests::models::{Surfel, ball, object};
use pointstage_tests::program::plugin_library;
use pointstage_tests::shots::{
    PATHS, both_paths, choice, draw, floats, perspective, request, uints,
};
use pointstage_tests::{plugins, stages};

fn stage() -> Result<Stage> {
    let files = vec![
        plugin_library("points")?,
        plugin_library("surfel")?,
        plugin_library("hqss")?,
        plugins::sound()?,
    ];
    stages::of_libraries(files, true)
}

/// Two objects, of which the structure `thirds` draws one by numbers from the host and the other by numbers and a count
/// on the device; `step` 3 leaves just what it selects.
fn scene(step: usize) -> Arc<Scene> {
    let every =
        |surfels: Vec<Surfel>| -> Vec<Surfel> { surfels.into_iter().step_by(step).collect() };
    let mut scene = Scene::new();
    scene.add(object("by the host", &every(ball(9_001, 0.03, 11))));
    let mut second = object("on the device", &every(ball(6_002, 0.05, 12)));
    second.world_from_object = DAffine3::from_translation(DVec3::new(0.6, 0.2, 0.5))
        * DAffine3::from_scale(DVec3::splat(0.5));
    scene.add(second);
    Arc::new(scene)
}

#[test]
fn selected_surfels_draw_as_if_they_were_all_there_is() -> Result<()> {
    let mut stage = stage()?;
    if let Some(why) = stage.no_device() {
        skip(why);
        return Ok(());
    }
    for renderer in ["points", "surfel"] {
        let camera = perspective(DVec3::Z * 3.5);
        let expected = both_paths(&mut stage, &request(&scene(3), camera, renderer, &[]));
        let selecting = FrameRequest {
            structure: Some("thirds".into()),
            ..request(&scene(1), camera, renderer, &[])
        };
        let selected = both_paths(&mut stage, &selecting);
        for ((expected, selected), (path, _)) in expected.iter().zip(&selected).zip(PATHS) {
            let what = format!("{renderer}, {path}");
            assert_eq!(
                selected.stats.reported.get("nodes_visited"),
                Some(&2.0),
                "{what}"
            );
            let kinds = uints(selected, "kind");
            assert!(kinds.iter().any(|kind| *kind != 0), "{what}: empty");
            assert!(kinds == uints(expected, "kind"), "{what}: coverage differs");
            let depths = floats(selected, "depth");
            let pairs = depths.iter().zip(floats(expected, "depth"));
            let apart = pairs.filter(|(a, b)| (**a - b).abs() > 1e-6 * b).count();
            assert_eq!(apart, 0, "{what}: pixels with another depth");
        }
    }
    Ok(())
}

#[test]
fn the_cpu_leaves_to_compute_what_the_device_alone_selects() -> Result<()> {
    let mut stage = stage()?;
    if let Some(why) = stage.no_device() {
        skip(why);
        return Ok(());
    }
    for renderer in ["surfel", "hqss"] {
        let camera = perspective(DVec3::Z * 3.5);
        let settings = [("path", choice("cpu"))];
        let selecting = FrameRequest {
            structure: Some("thirds".into()),
            ..request(&scene(1), camera, renderer, &settings)
        };
        let drawn = draw(&mut stage, &selecting);
        assert_eq!(drawn.stats.reported.get("path"), Some(&1.0), "{renderer}");
        let kinds = uints(&drawn, "kind");
        assert!(kinds.iter().any(|kind| *kind != 0), "{renderer}: empty");
    }
    Ok(())
}
