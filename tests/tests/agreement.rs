//! Where renderers must agree: the paths of each with one another, and both with each other in silhouette and depth.

use std::sync::Arc;

use glam::{DAffine3, DQuat, DVec3};
use pointstage_engine::stage::{FrameResult, SettingValue, Stage};
use pointstage_scene::Scene;
use pointstage_tests::models::{ball, object};
use pointstage_tests::shots::{
    NEAR, SIZE_PX, Setting, both_paths, choice, draw, floats, perspective, psnr, request, stage,
    uints,
};

/// Where the eye stands in all of these pictures.
const EYE: DVec3 = DVec3::new(0.0, 0.0, 3.5);

/// A dense ball, and in front of it a smaller, turned and scaled one of large surfels.
fn two_balls() -> Arc<Scene> {
    let mut scene = Scene::new();
    scene.add(object("dense", &ball(40_000, 0.02, 1)));
    let mut near = object("near", &ball(2_000, 0.2, 2));
    near.world_from_object = DAffine3::from_scale_rotation_translation(
        DVec3::splat(0.3),
        DQuat::from_rotation_y(0.7),
        DVec3::new(0.4, 0.3, 2.0),
    );
    scene.add(near);
    Arc::new(scene)
}

/// Two balls by both paths of a renderer.
fn draw_balls(stage: &mut Stage, renderer: &str, settings: &[Setting]) -> [FrameResult; 2] {
    both_paths(
        stage,
        &request(&two_balls(), perspective(EYE), renderer, settings),
    )
}

#[test]
fn both_paths_of_points_cover_the_same_pixels() {
    let Some(mut stage) = stage() else { return };
    let variants = [
        ("fixed", 1.0, "square"),
        ("fixed", 3.0, "round"),
        ("attenuated", 1.0, "square"),
        ("attenuated", 1.0, "round"),
    ];
    for (mode, size, shape) in variants {
        for cull_backs in [false, true] {
            let settings = [
                ("shape", choice(shape)),
                ("size_mode", choice(mode)),
                ("size", SettingValue::Float(size)),
                ("cull_backs", SettingValue::Bool(cull_backs)),
            ];
            let [raster, compute] = draw_balls(&mut stage, "points", &settings);
            let what = format!("{mode} {size} {shape}, backs hidden: {cull_backs}");
            let (raster_kind, compute_kind) = (uints(&raster, "kind"), uints(&compute, "kind"));
            assert!(raster_kind.iter().any(|kind| *kind != 0), "empty, {what}");
            assert!(raster_kind == compute_kind, "coverage differs, {what}");
            let db = psnr(&raster, &compute);
            assert!(db >= 50.0, "{db:.1} dB, {what}");
        }
    }
}

#[test]
fn both_paths_of_surfel_agree() {
    let Some(mut stage) = stage() else { return };
    let [raster, compute] = draw_balls(&mut stage, "surfel", &[]);
    let (raster_kind, compute_kind) = (uints(&raster, "kind"), uints(&compute, "kind"));
    let pairs = raster_kind.iter().zip(&compute_kind);
    let apart = pairs.filter(|(a, b)| a != b).count();
    // Rounding decides at the edges of disks.
    let count = raster_kind.len();
    assert!(apart * 10_000 <= count, "{apart} of {count} pixels differ");
    let db = psnr(&raster, &compute);
    assert!(db >= 45.0, "{db:.1} dB");
}

#[test]
fn both_paths_of_hqss_agree() {
    let Some(mut stage) = stage() else { return };
    let variants: [&[Setting]; 6] = [
        &[],
        &[("filter", SettingValue::Bool(false))],
        &[
            ("shading", choice("flat")),
            ("cull_backs", SettingValue::Bool(true)),
        ],
        &[("shading", choice("toon"))],
        &[("shows", choice("normals"))],
        &[
            ("shows", choice("weight")),
            ("two_sided", SettingValue::Bool(true)),
        ],
    ];
    for settings in variants {
        let [raster, compute] = draw_balls(&mut stage, "hqss", settings);
        let covered = uints(&raster, "kind")
            .iter()
            .filter(|kind| **kind != 0)
            .count();
        assert!(covered > 10_000, "{covered} pixels, {settings:?}");
        let db = psnr(&raster, &compute);
        assert!(db >= 50.0, "{db:.1} dB, {settings:?}");
    }
}

/// Whether a pixel within `reach` of `place` in both directions shows something.
fn shows_near(kind: &[u32], place: u32, reach: i64) -> bool {
    let [width, height] = SIZE_PX.map(i64::from);
    let (x, y) = (i64::from(place) % width, i64::from(place) / width);
    let rows = (y - reach).max(0)..=(y + reach).min(height - 1);
    let mut columns = rows.flat_map(|y| {
        let columns = (x - reach).max(0)..=(x + reach).min(width - 1);
        columns.map(move |x| y * width + x)
    });
    columns.any(|place| kind[place as usize] != 0)
}

#[test]
fn points_and_surfels_have_one_silhouette_and_one_depth() {
    let Some(mut stage) = stage() else { return };
    let mut scene = Scene::new();
    // Small enough that a sprite and a disk of one surfel differ by a pixel or two.
    let radius = 0.015;
    scene.add(object("ball", &ball(60_000, radius, 4)));
    let scene = Arc::new(scene);
    let settings = [
        ("size_mode", choice("attenuated")),
        ("shape", choice("round")),
    ];
    let points = draw(
        &mut stage,
        &request(&scene, perspective(EYE), "points", &settings),
    );
    let settings = [("cull_backs", SettingValue::Bool(false))];
    let surfels = draw(
        &mut stage,
        &request(&scene, perspective(EYE), "surfel", &settings),
    );
    let (point_kind, surfel_kind) = (uints(&points, "kind"), uints(&surfels, "kind"));
    for (place, (point, surfel)) in (0..).zip(point_kind.iter().zip(&surfel_kind)) {
        let surfel_near = *point == 0 || shows_near(&surfel_kind, place, 2);
        assert!(surfel_near, "a point at {place}, no surfel within 2 px");
        let point_near = *surfel == 0 || shows_near(&point_kind, place, 2);
        assert!(point_near, "a surfel at {place}, no point within 2 px");
    }
    let (point_depth, surfel_depth) = (floats(&points, "depth"), floats(&surfels, "depth"));
    let both = (0..point_kind.len()).filter(|&at| point_kind[at] != 0 && surfel_kind[at] != 0);
    // Reversed depth with an infinite far plane.
    let distance = |depth: f32| NEAR as f32 / depth;
    let mut differences: Vec<f32> = both
        .map(|at| (distance(point_depth[at]) - distance(surfel_depth[at])).abs())
        .collect();
    differences.sort_by(f32::total_cmp);
    // The median, since through a gap of one picture the far side shows. A sprite has its centre's depth, a disk its own
    // at each pixel: within about a radius of the surface.
    let median = differences[differences.len() / 2];
    assert!(median < radius, "depths differ by {median} in the median");
}
