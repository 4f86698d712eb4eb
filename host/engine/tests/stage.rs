//! The stage from end to end without plugins: the fallback, CPU only and on a device, and its errors.

use glam::{DVec3, Vec3};
use pointstage_engine::plugins::DiscoverOptions;
use pointstage_engine::stage::{
    FALLBACK_ID, FrameError, FrameRequest, Patience, Show, Stage, StageOptions,
};
use pointstage_plugin_api::columns;
use pointstage_scene::{Block, Camera, Geometry, Marks, Object, Origins, Scene};
use std::sync::Arc;

fn no_plugins(use_device: bool) -> StageOptions {
    let plugins = DiscoverOptions {
        folders: Vec::new(),
        state_folder: None,
        ..DiscoverOptions::default()
    };
    StageOptions {
        use_device,
        plugins,
        ..StageOptions::default()
    }
}

/// A square sheet of surfels at z = 0 that faces the eye.
fn sheet() -> Object {
    let centres = (0..400).map(|index| {
        [
            (index % 20) as f32 * 0.1 - 0.95,
            (index / 20) as f32 * 0.1 - 0.95,
            0.0,
            0.08,
        ]
    });
    let position_radius: Arc<[[f32; 4]]> = centres.collect();
    let normal = Some(
        position_radius
            .iter()
            .map(|_| columns::encode_normal(Vec3::Z))
            .collect(),
    );
    let block = Block {
        position_radius,
        normal,
        colour: None,
        axes: None,
        named: Vec::new(),
    };
    Object::new(
        "sheet",
        DVec3::ZERO,
        Geometry::new(vec![block], None, Origins::default()),
    )
}

fn request(renderer: &str) -> FrameRequest {
    let mut scene = Scene::new();
    scene.add(sheet());
    let camera = Camera {
        eye: DVec3::new(0.0, 0.0, 4.0),
        ..Camera::default()
    };
    FrameRequest {
        read_back: vec!["id".into()],
        ..FrameRequest::still(Arc::new(scene), camera, [64, 48], renderer)
    }
}

#[test]
fn without_a_device_the_fallback_draws() {
    let mut stage = Stage::new(no_plugins(false)).unwrap();
    let result = stage.frame(&request(FALLBACK_ID)).unwrap();
    let middle = (24 * 64 + 32) * 4;
    assert_eq!(
        result.picture.rgba[middle + 3],
        255,
        "the sheet covers the middle"
    );
    assert_eq!(result.picture.rgba[3], 0, "the corner is background");
    let pointstage_engine::stage::Plane::Uint(ids) = &result.planes["id"] else {
        panic!("ids are numbers")
    };
    let found = result
        .ids
        .resolve(ids[24 * 64 + 32])
        .expect("a surfel in the middle");
    assert!(found.surfel < 400);
    assert_eq!(result.stats.surfels_in_scene, 400);
}

#[test]
fn an_unknown_renderer_is_an_error_that_names_it_or_a_notice() {
    let mut stage = Stage::new(no_plugins(false)).unwrap();
    let error = stage.frame(&request("no-such")).unwrap_err();
    assert!(
        matches!(error, FrameError::UnknownPlugin(_)) && error.to_string().contains("no-such"),
        "{error}"
    );
    let patient = FrameRequest {
        patience: Patience::DrawMeanwhile,
        ..request("no-such")
    };
    let result = stage.frame(&patient).unwrap();
    assert_eq!(result.drawn_by, FALLBACK_ID);
    assert!(
        result
            .notices
            .iter()
            .any(|notice| notice.text.contains("no-such")),
        "{:?}",
        result.notices
    );
}

#[test]
fn pictures_without_pixels_or_beyond_the_limit_are_refused() {
    let mut stage = Stage::new(no_plugins(false)).unwrap();
    for size_px in [[0, 10], [10, 0], [70_000, 10]] {
        let error = stage
            .frame(&FrameRequest {
                size_px,
                ..request(FALLBACK_ID)
            })
            .unwrap_err();
        assert!(matches!(error, FrameError::Size { .. }), "{error}");
    }
}

#[test]
fn the_session_goes_on_after_the_device_is_lost() {
    let mut stage = Stage::new(no_plugins(true)).unwrap();
    let Some(device) = stage.device().cloned() else {
        println!("skipped: no graphics adapter: {:?}", stage.no_device());
        return;
    };
    let before = stage.frame(&request(FALLBACK_ID)).unwrap();
    device.destroy();
    let after = stage.frame(&request(FALLBACK_ID)).unwrap();
    assert_eq!(before.picture, after.picture);
    assert!(
        after
            .notices
            .iter()
            .any(|notice| notice.text.contains("lost")),
        "{:?}",
        after.notices
    );
    let generation = stage.device().expect("a new device").generation;
    assert_ne!(generation, device.generation);
}

#[test]
fn marked_surfels_are_tinted_where_that_is_asked_for() {
    let mut stage = Stage::new(no_plugins(false)).unwrap();
    let clean = request(FALLBACK_ID);
    let mut scene = Scene::clone(&clean.scene);
    let id = scene.objects()[0].id;
    // The left half of the sheet.
    let marks = Marks::from_fn(400, |surfel| surfel % 20 < 10);
    scene.set_marks(id, Some(Arc::new(marks)));
    let marked = FrameRequest {
        scene: Arc::new(scene),
        ..clean.clone()
    };
    let plain = stage.frame(&clean).unwrap();
    let not_shown = stage.frame(&marked).unwrap();
    assert_eq!(not_shown.picture, plain.picture, "pictures are clean");
    let asked = FrameRequest {
        shows_marks: true,
        read_back: Vec::new(),
        ..marked.clone()
    };
    let shown = stage.frame(&asked).unwrap();
    assert!(shown.planes.is_empty(), "ids were not asked for");
    let pixels = shown
        .picture
        .rgba
        .chunks(4)
        .zip(plain.picture.rgba.chunks(4));
    let mut counts = [0, 0];
    for (index, (shown, plain)) in pixels.enumerate() {
        let is_left = index % 64 < 32;
        if plain[3] == 0 || index % 64 == 31 || index % 64 == 32 {
            continue;
        }
        assert_eq!(shown != plain, is_left, "pixel {index}");
        counts[usize::from(is_left)] += 1;
    }
    assert!(counts.iter().all(|count| *count > 100), "{counts:?}");
    let normals = FrameRequest {
        show: Show::Target("normal".into()),
        ..asked
    };
    let plain = FrameRequest {
        shows_marks: false,
        ..normals.clone()
    };
    let [normals, plain] = [normals, plain].map(|asked| stage.frame(&asked).unwrap().picture);
    assert_eq!(normals, plain, "the colours of a target are values");
}
