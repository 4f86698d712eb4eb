//! Where renderers must agree: the paths of `points` with one another, `surfel` with a ray cast on the CPU, and both with
//! each other in silhouette and depth.

use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use glam::{DAffine3, DQuat, DVec2, DVec3, Vec3, Vec4};
use pointstage_engine::plugins::{DiscoverOptions, Examination};
use pointstage_engine::stage::{
    FrameRequest, FrameResult, Plane, SettingValue, Stage, StageOptions,
};
use pointstage_plugin_api::abi::FrameUniform;
use pointstage_plugin_api::columns::{TangentAxes, encode_colour, encode_normal};
use pointstage_plugin_api::twin::camera::Camera as TwinCamera;
use pointstage_plugin_api::twin::ellipse::{Axes, project_ellipse};
use pointstage_scene::{Block, Camera, Geometry, Object, Origins, Projection, Provenance, Scene};
use pointstage_tests::data::skip;
use pointstage_tests::program::plugin_library;

const SIZE_PX: [u32; 2] = [320, 240];
const FOV_Y_RAD: f64 = 0.8;
const NEAR: f64 = 0.1;

/// The stage that all tests of this file share, with both renderers; none where there is no device.
fn stage() -> Option<MutexGuard<'static, Stage>> {
    static STAGE: OnceLock<Mutex<Stage>> = OnceLock::new();
    let stage = STAGE.get_or_init(|| {
        let built = |name| plugin_library(name).expect("the plugins are built");
        let plugins = DiscoverOptions {
            files: ["points", "surfel"].map(built).to_vec(),
            folders: Vec::new(),
            examination: Examination::ManifestOnly,
            state_folder: None,
        };
        let options = StageOptions {
            plugins,
            ..StageOptions::default()
        };
        Mutex::new(Stage::new(options).expect("the stage opens"))
    });
    let stage = stage.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(why) = stage.no_device() {
        skip(why);
        return None;
    }
    Some(stage)
}

/// Random numbers from a fixed seed (splitmix64).
struct Random(u64);

impl Random {
    /// Uniform in -1..1.
    fn signed(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^= bits >> 31;
        (bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }
}

/// A surfel of a test scene.
struct Surfel {
    centre: Vec3,
    radius: f32,
    normal: Vec3,
    axes: Option<TangentAxes>,
}

fn object(name: &str, surfels: &[Surfel]) -> Object {
    let place = |surfel: &Surfel| surfel.centre.extend(surfel.radius).to_array();
    let colour = |surfel: &Surfel| encode_colour(Vec4::from((surfel.normal.abs(), 1.0)));
    let axes: Option<Vec<_>> = surfels
        .iter()
        .map(|surfel| surfel.axes.map(|axes| axes.0))
        .collect();
    let block = Block {
        position_radius: surfels.iter().map(place).collect(),
        normal: Some(surfels.iter().map(|s| encode_normal(s.normal)).collect()),
        colour: Some(surfels.iter().map(colour).collect()),
        axes: axes.map(Into::into),
        named: Vec::new(),
    };
    let given = Provenance::FromFile;
    let origins = Origins {
        normals: given,
        radii: given,
        colours: given,
        axes: given,
    };
    Object::new(name, DVec3::ZERO, Geometry::new(vec![block], None, origins))
}

/// Surfels on a unit sphere with dents, each of about `radius`.
fn ball(count: usize, radius: f32, seed: u64) -> Vec<Surfel> {
    let mut random = Random(seed);
    let surfel = |_| {
        let normal = random.vector().normalize();
        let dent = 1.0 + 0.1 * (7.0 * normal.x).sin() * (5.0 * normal.y).cos();
        Surfel {
            centre: (normal * dent).as_vec3(),
            radius: radius * (1.0 + 0.5 * random.signed() as f32),
            normal: normal.as_vec3(),
            axes: None,
        }
    };
    (0..count).map(surfel).collect()
}

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

fn camera(eye: DVec3) -> Camera {
    Camera {
        eye,
        pivot: DVec3::ZERO,
        up: DVec3::Y,
        projection: Projection::Perspective {
            fov_y_rad: FOV_Y_RAD,
        },
        near: NEAR,
        ..Camera::default()
    }
}

/// A request with targets to read back and settings.
fn request(
    scene: &Arc<Scene>,
    eye: DVec3,
    renderer: &str,
    settings: &[(&str, SettingValue)],
) -> FrameRequest {
    let mut request = FrameRequest::still(Arc::clone(scene), camera(eye), SIZE_PX, renderer);
    request.read_back = ["colour", "depth", "normal", "id", "kind"]
        .map(String::from)
        .to_vec();
    request.settings = settings
        .iter()
        .map(|(id, value)| ((*id).to_owned(), value.clone()))
        .collect();
    request
}

fn choice(id: &str) -> SettingValue {
    SettingValue::Choice(id.to_owned())
}

fn draw(stage: &mut Stage, request: &FrameRequest) -> FrameResult {
    stage
        .frame(request)
        .unwrap_or_else(|error| panic!("{}: {error}", request.renderer))
}

fn uints(result: &FrameResult, key: &str) -> Vec<u32> {
    match result.planes.get(key) {
        Some(Plane::Uint(values)) => values.to_vec(),
        other => panic!("'{key}' should be whole numbers, found {other:?}"),
    }
}

fn floats(result: &FrameResult, key: &str) -> Vec<f32> {
    match result.planes.get(key) {
        Some(Plane::Float { values, .. }) => values.to_vec(),
        other => panic!("'{key}' should be floats, found {other:?}"),
    }
}

/// Peak signal to noise of two 8-bit pictures; dB.
fn psnr(first: &FrameResult, second: &FrameResult) -> f64 {
    let pairs = first.picture.rgba.iter().zip(second.picture.rgba.iter());
    let squares: f64 = pairs
        .map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2))
        .sum();
    let mean = squares / first.picture.rgba.len() as f64;
    10.0 * (255.0_f64.powi(2) / mean).log10()
}

fn assert_took(result: &FrameResult, path: f64) {
    let taken = result.stats.reported.get("path");
    assert_eq!(taken, Some(&path), "0 is raster, 1 compute");
}

/// The scene by both paths of a renderer: raster, compute.
fn both_paths(
    stage: &mut Stage,
    scene: &Arc<Scene>,
    renderer: &str,
    settings: &[(&str, SettingValue)],
) -> [FrameResult; 2] {
    let eye = DVec3::new(0.0, 0.0, 3.5);
    let [raster, compute] = ["raster", "compute"].map(|path| {
        let settings = [settings, &[("path", choice(path))]].concat();
        draw(stage, &request(scene, eye, renderer, &settings))
    });
    assert_took(&raster, 0.0);
    assert_took(&compute, 1.0);
    [raster, compute]
}

#[test]
fn both_paths_of_points_cover_the_same_pixels() {
    let Some(mut stage) = stage() else { return };
    let scene = two_balls();
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
            let [raster, compute] = both_paths(&mut stage, &scene, "points", &settings);
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
    let [raster, compute] = both_paths(&mut stage, &two_balls(), "surfel", &[]);
    let (raster_kind, compute_kind) = (uints(&raster, "kind"), uints(&compute, "kind"));
    let pairs = raster_kind.iter().zip(&compute_kind);
    let apart = pairs.filter(|(a, b)| a != b).count();
    // Rounding decides at the edges of disks.
    let count = raster_kind.len();
    assert!(apart * 10_000 <= count, "{apart} of {count} pixels differ");
    let db = psnr(&raster, &compute);
    assert!(db >= 45.0, "{db:.1} dB");
}

/// What the twin of the shader library says that each pixel shows: depth, and the surfel's number from 1.
fn cast(surfels: &[Surfel], eye: DVec3) -> Vec<(f64, u32)> {
    let camera = camera(eye);
    let [width, height] = SIZE_PX;
    let frame = FrameUniform {
        tile_size_px: SIZE_PX.map(|size| size as f32),
        ..FrameUniform::default()
    };
    let twin = TwinCamera {
        clip_from_view: camera.clip_from_view(f64::from(width) / f64::from(height)),
        ..TwinCamera::from(&frame)
    };
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
            if let Some(depth) = image.hit(pixel).filter(|depth| *depth >= nearest.0) {
                *nearest = (depth, number);
            }
        }
    }
    nearest
}

/// Elliptical disks all over the view; every third lies round the eye, and many of those cross the near plane.
fn disks(count: usize, eye: DVec3) -> Vec<Surfel> {
    let mut random = Random(3);
    let disk = |index: usize| {
        let normal = random.vector().normalize();
        let (u, v) = normal.any_orthonormal_pair();
        let aspect = 0.6 + 0.4 * random.signed();
        let (centre, size) = if index.is_multiple_of(3) {
            (eye + 0.3 * random.vector(), 0.3 + 0.2 * random.signed())
        } else {
            let spread = DVec3::new(2.0, 1.5, 2.0);
            (random.vector() * spread, 0.2 + 0.15 * random.signed())
        };
        Surfel {
            centre: centre.as_vec3(),
            radius: size as f32,
            normal: normal.as_vec3(),
            axes: Some(TangentAxes::new(
                (u * size).as_vec3(),
                (v * size * aspect).as_vec3(),
            )),
        }
    };
    (0..count).map(disk).collect()
}

#[test]
fn surfel_draws_what_a_ray_cast_sees() {
    let Some(mut stage) = stage() else { return };
    let eye = DVec3::new(0.0, 0.0, 5.0);
    let surfels = disks(300, eye);
    let mut scene = Scene::new();
    scene.add(object("disks", &surfels));
    let scene = Arc::new(scene);
    let expected = cast(&surfels, eye);
    let covered = expected.iter().filter(|(_, number)| *number != 0).count();
    assert!(covered > expected.len() / 4, "{covered} pixels are covered");
    for path in ["raster", "compute"] {
        let settings = [
            ("path", choice(path)),
            ("cull_backs", SettingValue::Bool(false)),
        ];
        let result = draw(&mut stage, &request(&scene, eye, "surfel", &settings));
        let (ids, depths) = (uints(&result, "id"), floats(&result, "depth"));
        // The only block's first id is 1.
        let pairs = ids.iter().zip(&expected);
        let wrong = pairs.filter(|(id, (_, number))| *id != number).count();
        // Single precision decides otherwise where an edge passes a pixel's centre.
        let count = ids.len();
        assert!(
            wrong * 1_000 <= count,
            "{path}: {wrong} of {count} pixels show another surfel"
        );
        for ((id, depth), (by_ray, number)) in ids.iter().zip(&depths).zip(&expected) {
            if id == number && *number != 0 {
                let error = (f64::from(*depth) / by_ray - 1.0).abs();
                assert!(
                    error < 1e-4,
                    "{path}: surfel {number} at depth {depth}, by ray {by_ray}"
                );
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
    let eye = DVec3::new(0.0, 0.0, 3.5);
    let settings = [
        ("size_mode", choice("attenuated")),
        ("shape", choice("round")),
    ];
    let points = draw(&mut stage, &request(&scene, eye, "points", &settings));
    let settings = [("cull_backs", SettingValue::Bool(false))];
    let surfels = draw(&mut stage, &request(&scene, eye, "surfel", &settings));
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
