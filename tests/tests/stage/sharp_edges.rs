//! Surfels with clip lines end at sharp edges: a cube and a plate with an inner corner, of large disks that stick out without their
//! lines, against rays cast on the shapes themselves.

use std::sync::Arc;

use glam::{DAffine3, DQuat, DVec3};
use pointstage_engine::stage::{FrameResult, SettingValue, Stage};
use pointstage_scene::{Camera, Projection, Scene};
use pointstage_tests::models::{ball, object};
use pointstage_tests::sharp::{COLOURS, Shape, cube, plate, scene};
use pointstage_tests::shots::{
    SIZE_PX, Setting, all_paths, blended, choice, floats, orthographic, perspective, psnr, request,
    stage, uints,
};

/// Pixels no nearer to an edge show what is on their side of it. Half a pixel from a single edge; two that meet at an acute corner
/// cover a little beyond it.
const EDGE_PX: f64 = 1.5;

/// A pixel away from edges: its place, and the face that it shows, none for the background.
type Pixel = (usize, Option<u32>);

/// All pixels away from edges.
fn truth(shape: &Shape, camera: &Camera) -> Vec<Pixel> {
    let forward = (camera.pivot - camera.eye).normalize();
    let right = forward.cross(camera.up).normalize();
    let up = right.cross(forward);
    let [width, height] = SIZE_PX.map(f64::from);
    let met = |x: f64, y: f64| {
        let across = right * (x - 0.5 * width) / (0.5 * height);
        let offset = across - up * (y - 0.5 * height) / (0.5 * height);
        match camera.projection {
            Projection::Perspective { fov_y_rad } => {
                (shape.face_met)(camera.eye, forward + offset * (0.5 * fov_y_rad).tan())
            }
            Projection::Orthographic { height } => {
                (shape.face_met)(camera.eye + offset * 0.5 * height, forward)
            }
        }
    };
    let pixel = |place: u32| {
        let [x, y] = [place % SIZE_PX[0], place / SIZE_PX[0]].map(|at| f64::from(at) + 0.5);
        let here = met(x, y);
        let mut round =
            (0..16).map(|step| (f64::from(step) * 0.125 * core::f64::consts::PI).sin_cos());
        round
            .all(|(dy, dx)| met(x + EDGE_PX * dx, y + EDGE_PX * dy) == here)
            .then_some((place as usize, here))
    };
    (0..SIZE_PX[0] * SIZE_PX[1]).filter_map(pixel).collect()
}

/// Pixels away from edges: the place, the face that it should show, and the one that it shows; none is the background.
fn faces<'a>(
    shape: &Shape,
    truth: &'a [Pixel],
    result: &FrameResult,
) -> impl Iterator<Item = (usize, Option<u32>, Option<u32>)> + use<'a> {
    let surfels_a_face = shape.surfels_a_face;
    let ids = uints(result, "id");
    let shown = move |place: usize| Some(ids[place].checked_sub(1)? / surfels_a_face);
    truth
        .iter()
        .map(move |(place, face)| (*place, *face, shown(*place)))
}

/// How many pixels away from edges show another face than they should.
fn elsewhere(shape: &Shape, truth: &[Pixel], result: &FrameResult) -> usize {
    let pixels = faces(shape, truth, result);
    pixels.filter(|(_, face, shown)| face != shown).count()
}

/// How many show another face than they should, or its colour mixed with another's.
fn wrong(shape: &Shape, truth: &[Pixel], result: &FrameResult) -> usize {
    let colours = floats(result, "colour");
    let is_wrong = |(place, face, shown): &(usize, Option<u32>, Option<u32>)| {
        let expected = face.map_or([0; 3], |face| COLOURS[face as usize]);
        let found = &colours[4 * place..4 * place + 3];
        let mut pairs = expected.iter().zip(found);
        let is_right =
            pairs.all(|(expected, found)| (f32::from(*expected) / 255.0 - found).abs() < 0.01);
        face != shown || !is_right
    };
    faces(shape, truth, result).filter(is_wrong).count()
}

/// By all paths of `hqss`, and by the reference; unlit. Large disks of one side blend with backs beside an outline, so those are hidden.
fn unlit(
    stage: &mut Stage,
    scene: &Arc<Scene>,
    camera: Camera,
    more: &[Setting],
) -> [FrameResult; 4] {
    let own: [Setting; 2] = [
        ("shows", choice("colours")),
        ("cull_backs", SettingValue::Bool(true)),
    ];
    blended(
        stage,
        &request(scene, camera, "hqss", &[&own[..], more].concat()),
    )
}

fn assert_paths_agree(what: &str, paths: &[FrameResult]) {
    for (number, first) in paths.iter().enumerate() {
        for second in &paths[number + 1..] {
            let db = psnr(first, second);
            assert!(db >= 50.0, "{db:.1} dB, {what}");
        }
    }
}

fn cameras() -> [Camera; 2] {
    let eye = DVec3::new(2.6, 2.1, 3.5);
    // Off the middle: an edge that lies half way between pixel centres covers them by nothing or by as good as nothing.
    let pivot = DVec3::new(0.03, -0.02, 0.01);
    [perspective(eye), orthographic(eye, 4.2)].map(|camera| Camera { pivot, ..camera })
}

#[test]
fn blended_surfels_with_clip_lines_end_where_the_shape_does() {
    let Some(mut stage) = stage() else { return };
    let variants: [&[Setting]; 3] = [
        &[],
        &[("filter", SettingValue::Bool(false))],
        // Lines stay where they are.
        &[("splat_scale", SettingValue::Float(1.3))],
    ];
    for shape in [cube(4), plate()] {
        let [ragged, sharp] = [false, true].map(|has_lines| scene(&shape, has_lines));
        for camera in cameras() {
            let truth = truth(&shape, &camera);
            for settings in variants {
                let what = format!("{}, {:?}, {settings:?}", shape.name, camera.projection);
                let without = unlit(&mut stage, &ragged, camera, settings);
                let with = unlit(&mut stage, &sharp, camera, settings);
                for (without, with) in without.iter().zip(&with) {
                    let [before, after] = [without, with].map(|it| wrong(&shape, &truth, it));
                    assert!(before > 500, "{before} wrong pixels without lines, {what}");
                    assert_eq!(after, 0, "wrong pixels, {what}");
                }
                assert_paths_agree(&what, &with[..3]);
            }
        }
    }
}

#[test]
fn far_away_clip_lines_leave_no_holes() {
    let Some(mut stage) = stage() else { return };
    let shape = cube(50);
    let scene = scene(&shape, true);
    let [near, _] = cameras();
    // From there a surfel is 1.5, 0.6 and 0.3 px wide.
    for distance in [1.5, 4.0, 8.0] {
        let eye = near.eye * distance;
        let camera = Camera { eye, ..near };
        let truth = truth(&shape, &camera);
        let inside = truth.iter().filter(|(_, face)| face.is_some()).count();
        assert!(inside > 80, "{inside} pixels at {distance}");
        for result in unlit(&mut stage, &scene, camera, &[]) {
            let found = wrong(&shape, &truth, &result);
            assert_eq!(found, 0, "of {inside} pixels at {distance}");
        }
    }
}

#[test]
fn opaque_surfels_with_clip_lines_end_where_the_shape_does() {
    let Some(mut stage) = stage() else { return };
    for shape in [cube(4), plate()] {
        let [ragged, sharp] = [false, true].map(|has_lines| scene(&shape, has_lines));
        for camera in cameras() {
            let truth = truth(&shape, &camera);
            let mut draw = |scene: &Arc<Scene>| {
                let request = request(scene, camera, "surfel", &[]);
                all_paths(&mut stage, &request)
            };
            let what = format!("{}, {:?}", shape.name, camera.projection);
            let (without, with) = (draw(&ragged), draw(&sharp));
            for (without, with) in without.iter().zip(&with) {
                let [before, after] = [without, with].map(|it| elsewhere(&shape, &truth, it));
                assert!(before > 500, "{before} wrong pixels without lines, {what}");
                assert_eq!(after, 0, "wrong pixels, {what}");
            }
            assert_paths_agree(&what, &with);
        }
    }
}

#[test]
fn objects_without_lines_stay_whole_beside_one_with() {
    let Some(mut stage) = stage() else { return };
    let [camera, _] = cameras();
    // In front of the cube, on both sides of it in the list of objects.
    let ball = |name: &str, seed: u64, shift: DVec3| {
        let mut object = object(name, &ball(3_000, 0.08, seed));
        object.world_from_object =
            DAffine3::from_scale_rotation_translation(DVec3::splat(0.25), DQuat::IDENTITY, shift);
        object
    };
    let balls = [
        ball("first", 1, DVec3::new(1.6, 1.2, 1.4)),
        ball("last", 2, DVec3::new(1.1, 1.3, 2.0)),
    ];
    let cube = scene(&cube(4), true).objects()[0].clone();
    let [first, last] = balls.clone();
    let [alone, beside] = [
        [first.clone(), last.clone()].to_vec(),
        vec![first, cube, last],
    ]
    .map(|objects| {
        let mut scene = Scene::new();
        for object in objects {
            scene.add(object);
        }
        Arc::new(scene)
    });
    for renderer in ["hqss", "surfel"] {
        let mut draw = |scene| {
            let request = request(scene, camera, renderer, &[]);
            all_paths(&mut stage, &request)
        };
        let (alone, beside) = (draw(&alone), draw(&beside));
        assert_paths_agree(renderer, &beside);
        for (alone, beside) in alone.iter().zip(&beside) {
            let [alone, beside] = [alone, beside].map(|result| floats(result, "depth"));
            let pixels = alone.iter().zip(&beside);
            let of_balls: Vec<_> = pixels.filter(|(depth, _)| **depth > 0.0).collect();
            assert!(of_balls.len() > 1_000, "{} pixels", of_balls.len());
            let apart = of_balls
                .iter()
                .filter(|(alone, beside)| alone != beside)
                .count();
            assert_eq!(
                apart, 0,
                "pixels of the balls have another depth, {renderer}"
            );
        }
    }
}
