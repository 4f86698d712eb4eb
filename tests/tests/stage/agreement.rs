//! Where renderers must agree: the paths of each with one another, and both with each other in silhouette and depth.

use std::sync::Arc;

use glam::{DAffine3, DQuat, DVec3, Vec3};
use pointstage_engine::stage::{FrameResult, SettingValue, Stage};
use pointstage_scene::{Block, Geometry, Object, Scene};
use pointstage_tests::models::{Surfel, ball, disks, object};
use pointstage_tests::shots::{
    NEAR, PATHS_WITH_CPU, SIZE_PX, Setting, all_paths, both_paths, choice, draw, floats,
    orthographic, perspective, psnr, request, stage, uints,
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

/// Asserts that every two pictures are alike.
fn assert_alike(what: &str, results: &[FrameResult], least_db: f64) {
    for (number, first) in results.iter().enumerate() {
        for (more, second) in results.iter().enumerate().skip(number + 1) {
            let db = psnr(first, second);
            let paths = [PATHS_WITH_CPU[number].0, PATHS_WITH_CPU[more].0];
            assert!(db >= least_db, "{db:.1} dB, {paths:?}, {what}");
        }
    }
}

#[test]
fn all_paths_of_surfel_agree() {
    let Some(mut stage) = stage() else { return };
    for cull_backs in [false, true] {
        let settings = [("cull_backs", SettingValue::Bool(cull_backs))];
        let request = request(&two_balls(), perspective(EYE), "surfel", &settings);
        let results = all_paths(&mut stage, &request);
        let [first, others @ ..] = &results;
        let first_kind = uints(first, "kind");
        for other in others {
            let other_kind = uints(other, "kind");
            let pairs = first_kind.iter().zip(&other_kind);
            let apart = pairs.filter(|(a, b)| a != b).count();
            // Rounding decides at the edges of disks.
            let count = first_kind.len();
            assert!(apart * 10_000 <= count, "{apart} of {count} pixels differ");
        }
        assert_alike(&format!("backs hidden: {cull_backs}"), &results, 45.0);
    }
}

#[test]
fn all_paths_of_hqss_agree() {
    let Some(mut stage) = stage() else { return };
    let variants: [&[Setting]; 7] = [
        &[],
        &[("filter", SettingValue::Bool(false))],
        &[
            ("shading", choice("flat")),
            ("cull_backs", SettingValue::Bool(true)),
        ],
        &[("shading", choice("splats"))],
        &[("shading", choice("toon"))],
        &[("shows", choice("normals"))],
        &[
            ("shows", choice("weight")),
            ("two_sided", SettingValue::Bool(true)),
        ],
    ];
    for settings in variants {
        let request = request(&two_balls(), perspective(EYE), "hqss", settings);
        let results = all_paths(&mut stage, &request);
        for result in &results {
            let kinds = uints(result, "kind");
            let covered = kinds.iter().filter(|kind| **kind != 0).count();
            assert!(covered > 10_000, "{covered} pixels, {settings:?}");
        }
        assert_alike(&format!("{settings:?}"), &results, 50.0);
    }
}

/// The same object in blocks of a few thousand surfels, without some of its columns.
fn in_blocks(object: &Object, has_normals: bool, has_colours: bool) -> Object {
    const SURFELS: usize = 3_001;
    let [whole] = object.geometry.blocks.as_slice() else {
        panic!("one block was made");
    };
    let count = whole.position_radius.len();
    let blocks = (0..count).step_by(SURFELS).map(|first| {
        let range = first..count.min(first + SURFELS);
        let part = |column: &Option<Arc<[u32]>>| Some(column.as_ref()?[range.clone()].into());
        Block {
            position_radius: whole.position_radius[range.clone()].into(),
            normal: part(&whole.normal).filter(|_| has_normals),
            colour: part(&whole.colour).filter(|_| has_colours),
            axes: whole.axes.as_ref().map(|axes| axes[range.clone()].into()),
            named: Vec::new(),
        }
    });
    let mut object = object.clone();
    object.geometry = Geometry::new(blocks.collect(), None, object.geometry.origins).into();
    object
}

/// Scenes that are hard in one way each: a name, and the objects.
fn hard_scenes() -> Vec<(&'static str, Vec<Object>)> {
    let dense = object("dense", &ball(20_000, 0.04, 8));
    let mut moved = object("moved", &ball(3_000, 0.1, 9));
    moved.world_from_object = DAffine3::from_scale_rotation_translation(
        DVec3::new(0.5, 0.2, 0.9),
        DQuat::from_rotation_z(0.9),
        DVec3::new(0.4, 0.3, 1.6),
    );
    let sizes = ball(4_000, 0.05, 10).into_iter().enumerate();
    let sizes = sizes.map(|(index, surfel)| Surfel {
        radius: surfel.radius * [0.0, 0.02, 1.0, 9.0][index % 4],
        normal: if index % 7 == 0 {
            surfel.normal.cross(Vec3::Y).normalize_or_zero()
        } else {
            surfel.normal
        },
        ..surfel
    });
    let sizes: Vec<_> = sizes.collect();
    vec![
        ("blocks", vec![in_blocks(&dense, true, true), moved.clone()]),
        ("no normals", vec![in_blocks(&dense, false, true), moved]),
        ("no colours", vec![in_blocks(&dense, true, false)]),
        (
            "axes, across the near plane",
            vec![object("disks", &disks(300, EYE))],
        ),
        ("sizes from nothing, edge-on", vec![object("sizes", &sizes)]),
    ]
}

#[test]
fn the_cpu_draws_hard_scenes_as_compute_does() {
    let Some(mut stage) = stage() else { return };
    let orthographic = orthographic(EYE, 2.5);
    for (name, objects) in hard_scenes() {
        let mut scene = Scene::new();
        for object in objects {
            scene.add(object);
        }
        let scene = Arc::new(scene);
        for camera in [perspective(EYE), orthographic, perspective(EYE * 0.35)] {
            for size_px in [SIZE_PX, [1, 1], [33, 7]] {
                for (renderer, settings) in [
                    ("surfel", &[][..]),
                    ("hqss", &[]),
                    ("hqss", &[("filter", SettingValue::Bool(false))]),
                ] {
                    let mut request = request(&scene, camera, renderer, settings);
                    request.size_px = size_px;
                    let [_, compute, cpu] = all_paths(&mut stage, &request);
                    let db = psnr(&compute, &cpu);
                    let what = format!(
                        "{name}, {renderer}, {settings:?}, {size_px:?}, {:?}",
                        camera.projection
                    );
                    // Single pixels at edges, where rounding decides, are all that may differ.
                    assert!(db >= 50.0, "{db:.1} dB, {what}");
                }
            }
        }
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
