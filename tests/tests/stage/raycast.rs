//! What `points` and `surfel` draw, against rays cast on the CPU by the twins of the shader library: both projections,
//! both paths.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use pointstage_engine::stage::{FrameResult, SettingValue, Stage};
use pointstage_plugin_api::twin::ellipse::{Axes, project_ellipse};
use pointstage_scene::{Camera, Scene};
use pointstage_tests::models::{self, Surfel, twin_camera};
use pointstage_tests::shots::{
    PATHS_WITH_CPU, SIZE_PX, Setting, all_paths, both_paths, floats, orthographic, perspective,
    request, stage, uints,
};

const EYE: DVec3 = DVec3::new(0.0, 0.0, 5.0);

/// What a pixel shows: depth, and the surfel's number from 1; 0 where nothing is.
type Seen = (f64, u32);

/// Of two surfels at one pixel the nearer stays, of equally near ones the later.
fn offer(nearest: &mut Seen, depth: f64, number: u32) {
    if depth >= nearest.0 {
        *nearest = (depth, number);
    }
}

/// What rays through the pixels' centres see of the surfels' disks.
fn cast_disks(surfels: &[Surfel], camera: &Camera) -> Vec<Seen> {
    let [width, height] = SIZE_PX;
    let twin = twin_camera(camera, SIZE_PX);
    let view_from_world = camera.view_from_world();
    let mut nearest = vec![(0.0, 0); (width * height) as usize];
    for (number, surfel) in (1..).zip(surfels) {
        let axes = surfel.axes.expect("the surfels of this test have axes");
        let axes = Axes {
            u: view_from_world.transform_vector3(axes.u().as_dvec3()),
            v: view_from_world.transform_vector3(axes.v().as_dvec3()),
        };
        let centre = view_from_world.transform_point3(surfel.centre.as_dvec3());
        let Some(image) = project_ellipse(&twin, centre, axes) else {
            continue;
        };
        for (place, nearest) in (0..).zip(&mut nearest) {
            let pixel = DVec2::new(f64::from(place % width), f64::from(place / width)) + 0.5;
            if let Some(depth) = image.hit(pixel) {
                offer(nearest, depth, number);
            }
        }
    }
    nearest
}

/// What is seen of square sprites of `size_px`, round the projected centres.
fn cast_sprites(surfels: &[Surfel], camera: &Camera, size_px: f64) -> Vec<Seen> {
    let [width, height] = SIZE_PX;
    let twin = twin_camera(camera, SIZE_PX);
    let view_from_world = camera.view_from_world();
    let mut nearest = vec![(0.0, 0); (width * height) as usize];
    for (number, surfel) in (1..).zip(surfels) {
        let centre = view_from_world.transform_point3(surfel.centre.as_dvec3());
        let clip = twin.clip_from_view(centre);
        if clip.z <= 0.0 || clip.z > clip.w {
            continue;
        }
        // Pixels whose centres p satisfy c - s/2 <= p < c + s/2.
        let pixel = twin.pixel_from_clip(clip);
        let first = (pixel - 0.5 * size_px - 0.5).ceil().max(DVec2::ZERO);
        let end = (pixel + 0.5 * size_px - 0.5).ceil();
        for y in first.y as u32..(end.y.max(0.0) as u32).min(height) {
            for x in first.x as u32..(end.x.max(0.0) as u32).min(width) {
                let place = (y * width + x) as usize;
                offer(&mut nearest[place], clip.z / clip.w, number);
            }
        }
    }
    nearest
}

/// Holds a picture against what was cast: ids but for one in a thousand, where single precision decides otherwise at the
/// edge of a pixel or a disk; depths where the ids are equal.
fn assert_shows(result: &FrameResult, expected: &[Seen], what: &str) {
    let (ids, depths) = (uints(result, "id"), floats(result, "depth"));
    // The only block's first id is 1.
    let pairs = ids.iter().zip(expected);
    let wrong = pairs.filter(|(id, (_, number))| *id != number).count();
    let count = ids.len();
    assert!(
        wrong * 1_000 <= count,
        "{what}: {wrong} of {count} pixels show another surfel"
    );
    for ((id, depth), (by_ray, number)) in ids.iter().zip(&depths).zip(expected) {
        if id == number && *number != 0 {
            let error = (f64::from(*depth) / by_ray - 1.0).abs();
            assert!(
                error < 1e-4,
                "{what}: surfel {number} at depth {depth}, by ray {by_ray}"
            );
        }
    }
}

/// Draws the surfels by all paths of the renderer and holds the pictures against what was cast.
fn assert_renderer_shows(
    stage: &mut Stage,
    renderer: &str,
    settings: &[Setting],
    surfels: &[Surfel],
    camera: Camera,
    expected: &[Seen],
) {
    let covered = expected.iter().filter(|(_, number)| *number != 0).count();
    assert!(
        covered > expected.len() / 10,
        "{covered} pixels are covered"
    );
    let mut scene = Scene::new();
    scene.add(models::object("surfels", surfels));
    let request = request(&Arc::new(scene), camera, renderer, settings);
    let results = if renderer == "points" {
        both_paths(stage, &request).to_vec()
    } else {
        all_paths(stage, &request).to_vec()
    };
    for (result, (path, _)) in results.iter().zip(PATHS_WITH_CPU) {
        let what = format!("{renderer}, {path}, {:?}", camera.projection);
        assert_shows(result, expected, &what);
    }
}

#[test]
fn surfel_draws_what_a_ray_cast_sees() {
    let Some(mut stage) = stage() else { return };
    let surfels = models::disks(300, EYE);
    let settings = [("cull_backs", SettingValue::Bool(false))];
    for camera in [perspective(EYE), orthographic(EYE, 4.0)] {
        let expected = cast_disks(&surfels, &camera);
        assert_renderer_shows(&mut stage, "surfel", &settings, &surfels, camera, &expected);
    }
}

#[test]
fn points_draws_sprites_round_projected_centres() {
    let Some(mut stage) = stage() else { return };
    let surfels = models::ball(40_000, 0.02, 5);
    for camera in [perspective(DVec3::Z * 3.0), orthographic(EYE, 2.5)] {
        for size_px in [1.0, 3.0] {
            let settings = [("size", SettingValue::Float(size_px))];
            let expected = cast_sprites(&surfels, &camera, size_px);
            assert_renderer_shows(&mut stage, "points", &settings, &surfels, camera, &expected);
        }
    }
}
