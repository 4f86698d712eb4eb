//! An object's radius scale draws as the view's does, by all paths of all renderers.

use std::sync::Arc;

use glam::{DAffine3, DQuat, DVec3};
use pointstage_engine::stage::{FALLBACK_ID, FrameRequest, FrameResult, Stage};
use pointstage_plugin_api::columns::NO_NORMAL;
use pointstage_scene::{Geometry, Object, Scene};
use pointstage_tests::models::{Surfel, ball, disks, object};
use pointstage_tests::sharp::{plate, scene};
use pointstage_tests::shots::{
    all_paths, blended, both_paths, choice, draw, perspective, request, scene_of, stage,
};

const EYE: DVec3 = DVec3::new(0.0, 0.0, 3.5);

/// A power of two, so that it makes no difference when it is multiplied with what.
const SCALE: f32 = 2.0;

/// The same object, with no surfel's normal known.
fn without_normals(mut object: Object) -> Object {
    let Geometry {
        mut blocks,
        origins,
        ..
    } = (*object.geometry).clone();
    for block in &mut blocks {
        block.normal = Some(vec![NO_NORMAL; block.len()].into());
    }
    object.geometry = Arc::new(Geometry::new(blocks, None, origins));
    object
}

/// Turned, moved and scaled.
fn placed(mut object: Object) -> Object {
    object.world_from_object = DAffine3::from_scale_rotation_translation(
        DVec3::splat(0.7),
        DQuat::from_rotation_y(0.6),
        DVec3::new(0.1, -0.1, 0.2),
    );
    object
}

/// Round surfels, surfels that face the eye, ellipses, and ellipses with clip lines.
fn scenes() -> [(&'static str, Arc<Scene>); 4] {
    let round: Vec<Surfel> = ball(4_000, 0.03, 5);
    [
        ("round", scene_of(placed(object("round", &round)))),
        (
            "facing",
            scene_of(placed(without_normals(object("facing", &round)))),
        ),
        (
            "ellipses",
            scene_of(placed(object("ellipses", &disks(300, EYE)))),
        ),
        ("clipped", scene(&plate(), true)),
    ]
}

fn with_object_scale(scene: &Scene) -> Arc<Scene> {
    let mut scaled = scene.clone();
    for object in scene.objects() {
        scaled.edit(object.id, |object| object.radius_scale = SCALE);
    }
    Arc::new(scaled)
}

/// Asserts that `draw_all` gives the same with the object's scale as with the view's, and other pictures without one.
fn assert_same<const N: usize>(
    stage: &mut Stage,
    renderer: &str,
    draw_all: impl Fn(&mut Stage, &FrameRequest) -> [FrameResult; N],
) {
    for (name, scene) in scenes() {
        let plain = request(&scene, perspective(EYE), renderer, &[]);
        let of_view = FrameRequest {
            radius_scale: SCALE,
            ..plain.clone()
        };
        let of_object = FrameRequest {
            scene: with_object_scale(&scene),
            ..plain.clone()
        };
        let [plain, of_view, of_object] =
            [plain, of_view, of_object].map(|request| draw_all(stage, &request));
        for (number, of_view) in of_view.iter().enumerate() {
            let what = format!("{renderer}, {name}, path {number}");
            let is_same = of_view.picture.rgba == of_object[number].picture.rgba;
            assert!(is_same, "the object's scale draws otherwise: {what}");
            let is_seen = plain[number].picture.rgba != of_object[number].picture.rgba;
            assert!(is_seen, "the scale changes nothing: {what}");
        }
    }
}

#[test]
fn all_paths_of_surfel_take_it() {
    let Some(mut stage) = stage() else { return };
    assert_same(&mut stage, "surfel", all_paths);
}

#[test]
fn all_paths_of_hqss_and_the_reference_take_it() {
    let Some(mut stage) = stage() else { return };
    assert_same(&mut stage, "hqss", blended);
}

#[test]
fn points_and_the_built_in_renderer_take_it() {
    let Some(mut stage) = stage() else { return };
    assert_same(&mut stage, FALLBACK_ID, |stage, request| {
        // It writes fewer targets.
        let mut request = request.clone();
        request.read_back.clear();
        [draw(stage, &request)]
    });
    assert_same(&mut stage, "points", |stage, request| {
        let mut attenuated = request.clone();
        let mode = ("size_mode".to_owned(), choice("attenuated"));
        attenuated.settings.extend([mode]);
        both_paths(stage, &attenuated)
    });
}
