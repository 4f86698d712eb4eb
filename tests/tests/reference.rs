//! `ewa-reference` as a yardstick: the same picture however it is drawn, and how near the others come to it and to the truth.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::sync::Arc;
use std::time::Duration;

use glam::{DVec3, Vec3};
use pointstage_engine::plugins::DiscoverOptions;
use pointstage_engine::stage::{
    Background, FrameRequest, FrameResult, SettingValue, Stage, StageOptions, ViewportId,
};
use pointstage_plugin_api::abi::Interaction;
use pointstage_scene::{Camera, Scene};
use pointstage_tests::data::{long, sample, shared, skip};
use pointstage_tests::models::{Surfel, ball, coloured, object};
use pointstage_tests::program::plugin_library;
use pointstage_tests::shots::{
    NEAR, SIZE_PX, Setting, choice, draw, floats, in_tiles, loaded, orthographic, perspective,
    psnr, request, scene_of, stage, uints,
};
use pointstage_tests::stages;

/// Sixteen samples a pixel, averaged in linear light, and no filter.
const TRUTH: [Setting; 2] = [
    ("samples", SettingValue::Int(4)),
    ("filter", SettingValue::Bool(false)),
];

/// Colourful, so that whatever blends shows.
fn beach_ball() -> Arc<Scene> {
    let surfels = ball(40_000, 0.025, 8);
    scene_of(coloured("ball", &surfels, |surfel| {
        let centre = surfel.centre;
        let stripe = |value: f32| 0.5 + 0.5 * (6.0 * value).sin();
        Vec3::new(stripe(centre.x), stripe(centre.y), stripe(centre.z))
    }))
}

fn on_white(
    scene: &Arc<Scene>,
    camera: Camera,
    renderer: &str,
    settings: &[Setting],
) -> FrameRequest {
    FrameRequest {
        background: Background::Solid([1.0; 3]),
        ..request(scene, camera, renderer, settings)
    }
}

#[test]
fn one_thread_draws_what_many_draw_to_the_last_bit_with_no_device() {
    let planes = [1, 3].map(|thread_count| {
        let mut stage = Stage::new(StageOptions {
            use_device: false,
            thread_count,
            plugins: DiscoverOptions {
                files: vec![plugin_library("ewa_reference").expect("it was built")],
                ..Default::default()
            },
            ..StageOptions::default()
        })
        .expect("a stage");
        let settings = [("samples", SettingValue::Int(2))];
        let request = request(
            &beach_ball(),
            perspective(DVec3::new(0.4, 0.3, 2.6)),
            "ewa-reference",
            &settings,
        );
        let result = draw(&mut stage, &request);
        (result.planes, result.picture.rgba)
    });
    assert!(planes[0] == planes[1]);
}

#[test]
fn a_picture_in_small_pieces_of_time_is_the_same_picture() {
    let Some(mut stage) = stage() else { return };
    let settings = [("samples", SettingValue::Int(3))];
    let camera = perspective(DVec3::new(0.4, 0.3, 2.6));
    let whole = request(&beach_ball(), camera, "ewa-reference", &settings);
    let at_once = draw(&mut stage, &whole);
    let pieces = FrameRequest {
        time_budget: Some(Duration::from_millis(20)),
        viewport: ViewportId(7),
        ..whole
    };
    let mut progress = Vec::new();
    let last = loop {
        let result = stage.frame(&pieces).expect("a frame");
        progress.push(result.progress);
        if result.progress >= 1.0 {
            break result;
        }
    };
    assert!(progress.len() > 2, "it came at once: {progress:?}");
    assert!(progress.is_sorted(), "{progress:?}");
    assert!(last.picture.rgba == at_once.picture.rgba);
    assert!(last.planes == at_once.planes);
}

#[test]
fn while_something_moves_the_picture_with_one_sample_comes() {
    let Some(mut stage) = stage() else { return };
    let camera = perspective(DVec3::new(0.4, 0.3, 2.6));
    for samples in [1, 2] {
        let settings = [("samples", SettingValue::Int(samples))];
        let moving = FrameRequest {
            interaction: Interaction::MOVING,
            viewport: ViewportId(8),
            ..request(&beach_ball(), camera, "ewa-reference", &settings)
        };
        // Other work on the machine may need a second call.
        let area = |_| area(&stage.frame(&moving).expect("a frame"));
        let areas: Vec<f64> = (0..20).map(area).collect();
        assert!(areas[19] > 10_000.0, "{samples}: {areas:?}");
    }
}

#[test]
fn tiles_make_up_the_picture_with_every_filter() {
    let Some(mut stage) = stage() else { return };
    let camera = perspective(DVec3::new(0.4, 0.3, 2.6));
    let gaussian = [
        ("samples", SettingValue::Int(3)),
        ("sample_filter", choice("gaussian")),
    ];
    for settings in [&[][..], &gaussian] {
        let request = on_white(&beach_ball(), camera, "ewa-reference", settings);
        let whole = draw(&mut stage, &request).picture.rgba;
        let tiles = in_tiles(&mut stage, &request, [117, 100]);
        let apart = whole
            .iter()
            .zip(&tiles)
            .filter(|(a, b)| a.abs_diff(**b) > 1)
            .count();
        assert!(apart * 10_000 <= whole.len(), "{apart} values differ");
    }
}

#[test]
fn hqss_comes_within_thirty_eight_decibels_of_it() {
    let Some(mut stage) = stage() else { return };
    let unfiltered = [("filter", SettingValue::Bool(false))];
    for camera in [
        perspective(DVec3::new(0.5, 0.7, 3.0)),
        orthographic(DVec3::new(0.5, 0.7, 3.0), 2.4),
    ] {
        for (settings, least) in [(&[][..], 38.0), (&unfiltered, 45.0)] {
            let mut draw = |renderer| {
                draw(
                    &mut stage,
                    &on_white(&beach_ball(), camera, renderer, settings),
                )
            };
            let found = psnr(&draw("hqss"), &draw("ewa-reference"));
            assert!(found >= least, "{found:.1} dB, {settings:?}");
        }
    }
}

/// How far two renderers' pictures of the snake are apart.
fn snake_psnr(stage: &mut Stage, [a, b]: [(&str, &[Setting]); 2]) -> f64 {
    let scene = scene_of(loaded(&sample("knotted_snake.ply")));
    let mut draw = |(renderer, settings): (&str, &[Setting])| {
        let window = stages::window_frame(&scene, SIZE_PX, renderer);
        draw(stage, &on_white(&scene, window.camera, renderer, settings))
    };
    psnr(&draw(a), &draw(b))
}

#[test]
fn on_a_scan_hqss_is_nearer_to_it_and_to_the_truth_than_surfel() {
    let Some(mut stage) = stage() else { return };
    let near = |stage: &mut Stage, renderer, settings| {
        snake_psnr(stage, [(renderer, &[]), ("ewa-reference", settings)])
    };
    let hqss = near(&mut stage, "hqss", &[]);
    assert!(hqss >= 38.0, "{hqss:.1} dB");
    let [hqss, surfel] = ["hqss", "surfel"].map(|name| near(&mut stage, name, &TRUTH));
    assert!(
        hqss >= surfel + 1.0,
        "hqss {hqss:.1} dB, surfel {surfel:.1} dB"
    );
}

/// A chequered square in the plane y = 0, seen at a grazing angle; `count` surfels along each side, twelve to a check.
fn chequered(count: usize) -> Arc<Scene> {
    let spacing = 2.0 / count as f32;
    let surfels: Vec<Surfel> = (0..count * count)
        .map(|index| Surfel {
            centre: Vec3::new(
                ((index % count) as f32 + 0.5) * spacing - 1.0,
                0.0,
                ((index / count) as f32 + 0.5) * spacing - 1.0,
            ),
            radius: 0.8 * spacing,
            normal: Vec3::Y,
            axes: None,
        })
        .collect();
    let check = 12.0 * spacing;
    scene_of(coloured("chequered", &surfels, |surfel| {
        let [column, row] =
            [surfel.centre.x, surfel.centre.z].map(|at| (at / check).floor() as i32);
        let is_white = (column + row) % 2 == 0;
        Vec3::splat(f32::from(u8::from(is_white)))
    }))
}

#[test]
fn on_a_chequered_plane_the_filter_wins_where_splats_are_small_and_costs_nothing_elsewhere() {
    let Some(mut stage) = stage() else { return };
    let scene = chequered(360);
    let unfiltered = [("filter", SettingValue::Bool(false))];
    for (distance, least_gain_db) in [(0.9, -0.1), (3.0, -0.1), (14.0, 6.0)] {
        let camera = perspective(DVec3::new(0.3, 0.25, 1.0).normalize() * distance);
        let mut draw = |renderer, settings: &[Setting]| {
            draw(&mut stage, &on_white(&scene, camera, renderer, settings))
        };
        let truth = draw("ewa-reference", &TRUTH);
        for renderer in ["hqss", "ewa-reference"] {
            let on = psnr(&draw(renderer, &[]), &truth);
            let off = psnr(&draw(renderer, &unfiltered), &truth);
            assert!(
                on - off >= least_gain_db,
                "{renderer} from {distance}: {on:.1} dB with the filter, {off:.1} dB without"
            );
        }
    }
}

/// Sum of coverage, px.
fn area(result: &FrameResult) -> f64 {
    let colours = floats(result, "colour");
    let alphas = colours.chunks_exact(4).map(|pixel| f64::from(pixel[3]));
    alphas.sum()
}

#[test]
fn silhouettes_have_the_area_of_the_truth() {
    let Some(mut stage) = stage() else { return };
    let camera = perspective(DVec3::new(0.5, 0.7, 3.0));
    let mut draw = |renderer, settings: &[Setting]| {
        draw(
            &mut stage,
            &request(&beach_ball(), camera, renderer, settings),
        )
    };
    let truth = area(&draw("ewa-reference", &TRUTH));
    for renderer in ["hqss", "ewa-reference"] {
        let found = area(&draw(renderer, &[]));
        assert!(
            (found / truth - 1.0).abs() < 0.005,
            "{renderer}: {found} px of {truth}"
        );
    }
}

/// A sphere of radius 1 as a mesh, through a file: normals and radii come from its faces.
fn mesh() -> Arc<Scene> {
    let (rings, sides) = (40_u32, 80_u32);
    let mut vertices = String::new();
    for ring in 0..=rings {
        let (sine, cosine) = (PI * f64::from(ring) / f64::from(rings)).sin_cos();
        for side in 0..sides {
            let (x, z) = (2.0 * PI * f64::from(side) / f64::from(sides)).sin_cos();
            let _ = writeln!(vertices, "{} {} {}", x * sine, cosine, z * sine);
        }
    }
    let mut faces = String::new();
    for ring in 0..rings {
        for side in 0..sides {
            let [here, next] = [side, (side + 1) % sides].map(|side| ring * sides + side);
            let _ = writeln!(faces, "4 {here} {} {} {next}", here + sides, next + sides);
        }
    }
    let (vertex_count, face_count) = ((rings + 1) * sides, rings * sides);
    let text = format!(
        "ply\nformat ascii 1.0\nelement vertex {vertex_count}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {face_count}\nproperty list uchar int vertex_indices\nend_header\n{vertices}{faces}"
    );
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("sphere.ply");
    std::fs::write(&path, text).expect("written");
    scene_of(loaded(&path))
}

#[test]
fn triangles_are_drawn_where_an_object_has_some() {
    let Some(mut stage) = stage() else { return };
    let triangles = [("surface", choice("triangles"))];
    let camera = perspective(DVec3::new(0.5, 0.7, 3.0));
    let mut both = |scene: &Arc<Scene>| {
        [&triangles[..], &[]].map(|settings| {
            let request = on_white(scene, camera, "ewa-reference", settings);
            draw(&mut stage, &request)
        })
    };
    let [as_triangles, as_splats] = both(&mesh());
    let alike = psnr(&as_triangles, &as_splats);
    assert!(alike >= 30.0 && alike.is_finite(), "{alike:.1} dB");
    let kinds = uints(&as_triangles, "kind");
    assert!(kinds.contains(&2) && !kinds.contains(&1), "2 is a triangle");
    let middle = (SIZE_PX[0] * (SIZE_PX[1] / 2) + SIZE_PX[0] / 2) as usize;
    let depth = f64::from(floats(&as_triangles, "depth")[middle]);
    let distance = NEAR / depth;
    let expected = camera.eye.length() - 1.0;
    assert!((distance - expected).abs() < 3e-3, "{distance}, {expected}");
    let id = uints(&as_triangles, "id")[middle];
    assert!(
        as_triangles.ids.resolve(id).is_some(),
        "a vertex can be picked"
    );

    // Points have no triangles: their splats are drawn.
    let points = scene_of(object("ball", &ball(5_000, 0.05, 2)));
    let [as_triangles, as_splats] = both(&points);
    assert!(as_triangles.picture.rgba == as_splats.picture.rgba);
}

/// Pixels whose surroundings within `reach` in both directions all satisfy `is_in`.
fn eroded(is_in: &[bool], size_px: [u32; 2], reach: i64) -> Vec<bool> {
    let [width, height] = size_px.map(i64::from);
    let at = |x: i64, y: i64| {
        let is_inside = (0..width).contains(&x) && (0..height).contains(&y);
        is_inside && is_in[(y * width + x) as usize]
    };
    let all_round = |place: i64| {
        let (x, y) = (place % width, place / width);
        (y - reach..=y + reach).all(|y| (x - reach..=x + reach).all(|x| at(x, y)))
    };
    (0..width * height).map(all_round).collect()
}

/// Views of the test of holes; with `cargo xtask test --long` all of them.
const HOLE_VIEWS: usize = 200;

#[test]
fn a_scan_has_no_hole_that_its_mesh_has_not() {
    let Some(mut stage) = stage() else { return };
    let Some(path) = shared("mesh/dragon_vrip_437k_le.ply") else {
        skip("the dragon of the shared test data is not there");
        return;
    };
    let scene = scene_of(loaded(&path));
    let mut camera = Camera::default();
    camera.frame(&scene.bounds_world(), 1.0);
    let (pivot, distance) = (camera.pivot, camera.eye.distance(camera.pivot));
    let step = if long() { 1 } else { 50 };
    let triangles = [&[("surface", choice("triangles"))], &TRUTH[..]].concat();
    let mut pixel_count = 0;
    for view in (0..HOLE_VIEWS).step_by(step) {
        // Spread over the sphere; nearer and farther; twenty sizes.
        let z = 1.0 - (2.0 * view as f64 + 1.0) / HOLE_VIEWS as f64;
        let turn = view as f64 * PI * (3.0 - 5.0_f64.sqrt());
        let ring = (1.0 - z * z).sqrt();
        let direction = DVec3::new(ring * turn.cos(), z, ring * turn.sin());
        let nearness = 0.6 * 1.03_f64.powi((view * 37 % HOLE_VIEWS) as i32 / 2);
        let camera = Camera {
            eye: pivot + direction * distance * nearness,
            ..camera
        };
        let number = (view / step % 20) as u32;
        let size_px = [97 + 29 * number, 83 + 23 * number];
        let mut draw = |renderer, settings: &[Setting]| {
            let request = request(&scene, camera, renderer, settings);
            draw(&mut stage, &FrameRequest { size_px, ..request })
        };
        let mut alphas = |renderer, settings: &[Setting]| {
            let colours = floats(&draw(renderer, settings), "colour");
            let alphas = colours.chunks_exact(4).map(|pixel| pixel[3]);
            alphas.collect::<Vec<_>>()
        };
        // All samples of the pixel and of those round it meet the mesh. One ray a pixel is not enough: where the outline goes
        // through a pixel near its centre, the mesh may cover a little more than half of it and the disks a little less, and
        // then the pixel beside it is at the disks' outline alone.
        let mesh = alphas("ewa-reference", &triangles);
        let is_mesh: Vec<bool> = mesh.iter().map(|alpha| *alpha >= 0.999).collect();
        let inside = eroded(&is_mesh, size_px, 1);
        let splats = alphas("hqss", &[]);
        let covered = inside
            .iter()
            .zip(&splats)
            .filter(|(is_inside, _)| **is_inside);
        pixel_count += covered.clone().count();
        let partly = covered.filter(|(_, alpha)| **alpha < 0.999).count();
        assert!(
            partly == 0,
            "{partly} holes, whole or in part, in view {view} at {size_px:?}"
        );
    }
    assert!(
        pixel_count > 1_000,
        "{pixel_count} pixels are too few to tell"
    );
}
