//! A picture drawn in tiles is the picture drawn at once: every renderer by every path, both projections, every background,
//! and a shown target.

use std::sync::Arc;

use glam::DVec3;
use pointstage_engine::stage::{
    Background, FALLBACK_ID, FrameRequest, Plane, Show, Stage, StageOptions, Tile,
};
use pointstage_scene::Scene;
use pointstage_tests::models::{ball, object};
use pointstage_tests::shots::{
    PATHS, PATHS_WITH_CPU, SIZE_PX, choice, draw, in_tiles, orthographic, perspective, stage,
};

/// Tiles that do not divide the picture: the last ones are smaller, and one row of pixels is a tile of its own.
const TILE_PX: [u32; 2] = [117, 239];

/// Only rounding at the edges of splats may differ, since a tile's projection has other numbers: a pixel in ten thousand.
const MOST_APART: f64 = 1e-4;
/// The coverage of a blended outline looks at the pixels beside it, and a tile does not know those of the next one.
const MOST_APART_BLENDED: f64 = 5e-4;

fn scene() -> Arc<Scene> {
    let mut scene = Scene::new();
    scene.add(object("ball", &ball(30_000, 0.03, 7)));
    Arc::new(scene)
}

/// What is drawn: both projections, with a gradient; and depth on its ramp, with the range that the whole picture has.
fn requests(stage: &mut Stage, renderer: &str) -> Vec<(String, FrameRequest)> {
    let scene = scene();
    let eye = DVec3::new(0.6, 0.5, 2.4);
    let mut requests = Vec::new();
    for (name, camera) in [
        ("perspective", perspective(eye)),
        ("orthographic", orthographic(eye, 1.7)),
    ] {
        let colours = FrameRequest {
            background: Background::Gradient([0.9, 0.2, 0.1], [0.0, 0.3, 1.0]),
            ..FrameRequest::still(Arc::clone(&scene), camera, SIZE_PX, renderer)
        };
        let depth = FrameRequest {
            show: Show::Target("depth".to_owned()),
            ..colours.clone()
        };
        let shown_range = draw(stage, &depth).shown_range;
        assert!(shown_range.is_some(), "something is in view");
        requests.push((format!("{renderer}, {name}"), colours));
        requests.push((
            format!("{renderer}, {name}, depth"),
            FrameRequest {
                shown_range,
                ..depth
            },
        ));
    }
    requests
}

/// Asserts that the tiles make up the picture, but for rounding at edges.
fn assert_tiles_match(stage: &mut Stage, what: &str, request: &FrameRequest) {
    let whole = draw(stage, request);
    let tiles = in_tiles(stage, request, TILE_PX);
    let pairs = whole
        .picture
        .rgba
        .chunks_exact(4)
        .zip(tiles.chunks_exact(4));
    let count = pairs.len() as f64;
    let differs = |(a, b): &(&[u8], &[u8])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 1);
    let apart = pairs.filter(differs).count() as f64;
    let most = if request.renderer == "hqss" {
        MOST_APART_BLENDED
    } else {
        MOST_APART
    };
    assert!(
        apart <= count * most,
        "{what}: {apart} of {count} pixels differ"
    );
}

#[test]
fn every_renderer_draws_in_tiles_what_it_draws_at_once() {
    let Some(mut stage) = stage() else { return };
    for renderer in ["points", "surfel", "hqss"] {
        for (what, mut request) in requests(&mut stage, renderer) {
            let paths = if renderer == "points" {
                &PATHS[..]
            } else {
                &PATHS_WITH_CPU
            };
            for (path, _) in paths {
                request.settings.insert("path".to_owned(), choice(path));
                assert_tiles_match(&mut stage, &format!("{what}, {path}"), &request);
            }
        }
    }
}

#[test]
fn the_reference_draws_in_tiles_what_it_draws_at_once() {
    let Some(mut stage) = stage() else { return };
    for (what, request) in requests(&mut stage, "ewa-reference") {
        assert_tiles_match(&mut stage, &what, &request);
    }
}

#[test]
fn the_built_in_renderer_draws_in_tiles_what_it_draws_at_once() {
    let options = StageOptions {
        use_device: false,
        ..StageOptions::default()
    };
    let mut stage = Stage::new(options).expect("a stage without a device");
    for (what, request) in requests(&mut stage, FALLBACK_ID) {
        assert_tiles_match(&mut stage, &what, &request);
    }
}

#[test]
fn all_targets_come_with_the_picture_and_a_pick_finds_the_same_surfel_in_a_tile() {
    let Some(mut stage) = stage() else { return };
    for renderer in ["points", "surfel", "hqss", "ewa-reference", FALLBACK_ID] {
        let camera = perspective(DVec3::new(0.0, 0.0, 3.0));
        let mut request = FrameRequest::still(scene(), camera, SIZE_PX, renderer);
        request.read_back = draw(&mut stage, &request).available_targets;
        let whole = draw(&mut stage, &request);
        let pixel_count = (SIZE_PX[0] * SIZE_PX[1]) as usize;
        assert_eq!(
            whole.planes.keys().len(),
            request.read_back.len(),
            "{renderer} gives what it says it gives"
        );
        for (key, plane) in &whole.planes {
            let length = match plane {
                Plane::Float { channels, values } => values.len() / *channels as usize,
                Plane::Uint(values) => values.len(),
            };
            assert_eq!(length, pixel_count, "{renderer}, {key}");
        }
        let origin_px = [100, 80];
        let tile = FrameRequest {
            size_px: [120, 90],
            tile: Some(Tile {
                origin_px,
                image_size_px: SIZE_PX,
            }),
            ..request.clone()
        };
        let tile = draw(&mut stage, &tile);
        let pixel = [160, 120];
        let there = whole.pick(pixel, 2).expect("the ball is in the middle");
        let in_tile = [0, 1].map(|axis| pixel[axis] - i64::from(origin_px[axis]));
        let here = tile.pick(in_tile, 2).expect("and in the tile's middle");
        assert_eq!(whole.ids.resolve(there.id), tile.ids.resolve(here.id));
        let apart = there.position_world.distance(here.position_world);
        assert!(apart < 1e-4, "{renderer}: {apart} units apart");
        assert!(
            (0.7..1.3).contains(&there.position_world.length()),
            "on the ball: {}",
            there.position_world
        );
    }
}
