//! What the first-party renderers draw of scenes in memory, target by target: one stage, one size, two paths.

use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use glam::DVec3;
use pointstage_engine::stage::{FrameRequest, FrameResult, Plane, SettingValue, Stage, Tile};
use pointstage_scene::{Camera, Job, LoadOptions, Object, Projection, Scene, load};

use crate::data::skip;
use crate::stages;

/// Width and height of these pictures, px.
pub const SIZE_PX: [u32; 2] = [320, 240];
/// Distance of the near plane, scene units.
pub const NEAR: f64 = 0.1;
/// The paths of a renderer, and the numbers by which it reports them.
pub const PATHS: [(&str, f64); 2] = [("raster", 0.0), ("compute", 1.0)];
/// Those of renderers that the CPU draws, too.
pub const PATHS_WITH_CPU: [(&str, f64); 3] = [("raster", 0.0), ("compute", 1.0), ("cpu", 2.0)];

/// A setting's id and value.
pub type Setting = (&'static str, SettingValue);

/// The stage that all tests of a file share, with all renderers; none where there is no device.
///
/// # Panics
/// When the plugins were not built.
pub fn stage() -> Option<MutexGuard<'static, Stage>> {
    static STAGE: OnceLock<Mutex<Stage>> = OnceLock::new();
    let open = || {
        Mutex::new(
            stages::stage(&["points", "surfel", "hqss", "pop", "ewa_reference"]).expect("a stage"),
        )
    };
    let stage = STAGE.get_or_init(open);
    let stage = stage.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(why) = stage.no_device() {
        skip(why);
        return None;
    }
    Some(stage)
}

/// A camera at `eye` that looks at the origin.
pub fn perspective(eye: DVec3) -> Camera {
    Camera {
        eye,
        pivot: DVec3::ZERO,
        up: DVec3::Y,
        projection: Projection::Perspective { fov_y_rad: 0.8 },
        near: NEAR,
        ..Camera::default()
    }
}

/// The same with parallel rays; `height` of the picture in scene units.
pub fn orthographic(eye: DVec3, height: f64) -> Camera {
    Camera {
        projection: Projection::Orthographic { height },
        far: 20.0,
        ..perspective(eye)
    }
}

/// A request with colour, depth, normal, id and kind read back.
pub fn request(
    scene: &Arc<Scene>,
    camera: Camera,
    renderer: &str,
    settings: &[Setting],
) -> FrameRequest {
    let mut request = FrameRequest::still(Arc::clone(scene), camera, SIZE_PX, renderer);
    request.read_back = ["colour", "depth", "normal", "id", "kind"]
        .map(String::from)
        .to_vec();
    request.settings = settings
        .iter()
        .map(|(id, value)| ((*id).to_owned(), value.clone()))
        .collect();
    request
}

/// A scene of one object.
pub fn scene_of(object: Object) -> Arc<Scene> {
    let mut scene = Scene::new();
    scene.add(object);
    Arc::new(scene)
}

/// The object of a model file.
///
/// # Panics
/// When it does not load.
pub fn loaded(path: &Path) -> Object {
    load(path, &LoadOptions::default(), &Job::new())
        .expect("it loads")
        .object
}

/// The value of a choice.
pub fn choice(id: &str) -> SettingValue {
    SettingValue::Choice(id.to_owned())
}

/// Draws, until the picture refines no more.
///
/// # Panics
/// When the frame fails.
pub fn draw(stage: &mut Stage, request: &FrameRequest) -> FrameResult {
    loop {
        let result = stage
            .frame(request)
            .unwrap_or_else(|error| panic!("{}: {error}", request.renderer));
        if result.progress >= 1.0 {
            return result;
        }
    }
}

/// Draws by both paths: raster, compute.
///
/// # Panics
/// When a frame fails, or the renderer takes another path.
pub fn both_paths(stage: &mut Stage, request: &FrameRequest) -> [FrameResult; 2] {
    PATHS.map(|path| draw_by(stage, request, path))
}

/// Draws by all paths: raster, compute, CPU.
///
/// # Panics
/// When a frame fails, or the renderer takes another path.
pub fn all_paths(stage: &mut Stage, request: &FrameRequest) -> [FrameResult; 3] {
    PATHS_WITH_CPU.map(|path| draw_by(stage, request, path))
}

/// Draws by a path.
fn draw_by(stage: &mut Stage, request: &FrameRequest, (path, number): (&str, f64)) -> FrameResult {
    let mut request = request.clone();
    request.settings.insert("path".to_owned(), choice(path));
    let result = draw(stage, &request);
    let taken = result.stats.reported.get("path");
    assert_eq!(taken, Some(&number), "0 is raster, 1 compute, 2 the CPU");
    result
}

/// Draws a request of `hqss` by all of its paths, and what its settings mean to `ewa-reference`.
///
/// # Panics
/// When a frame fails, or the renderer takes another path.
pub fn blended(stage: &mut Stage, request: &FrameRequest) -> [FrameResult; 4] {
    let [raster, compute, cpu] = all_paths(stage, request);
    let reference = FrameRequest {
        renderer: "ewa-reference".to_owned(),
        ..request.clone()
    };
    [raster, compute, cpu, draw(stage, &reference)]
}

/// The same picture drawn in tiles of at most `tile_px`, and put together again: its colours, straight RGBA.
///
/// # Panics
/// When a tile fails, or comes in another size than asked for.
pub fn in_tiles(stage: &mut Stage, request: &FrameRequest, tile_px: [u32; 2]) -> Vec<u8> {
    let [width, height] = request.size_px;
    let mut whole = vec![0; width as usize * height as usize * 4];
    for y in (0..height).step_by(tile_px[1] as usize) {
        for x in (0..width).step_by(tile_px[0] as usize) {
            let size_px = [tile_px[0].min(width - x), tile_px[1].min(height - y)];
            let tile = FrameRequest {
                size_px,
                tile: Some(Tile {
                    origin_px: [x, y],
                    image_size_px: request.size_px,
                }),
                ..request.clone()
            };
            let drawn = draw(stage, &tile).picture;
            assert_eq!(drawn.size_px, size_px);
            let rows = drawn.rgba.chunks_exact(size_px[0] as usize * 4);
            for (row, pixels) in rows.enumerate() {
                let start = ((y as usize + row) * width as usize + x as usize) * 4;
                whole[start..start + pixels.len()].copy_from_slice(pixels);
            }
        }
    }
    whole
}

/// A target of whole numbers.
///
/// # Panics
/// When there is no such target.
pub fn uints(result: &FrameResult, key: &str) -> Vec<u32> {
    match result.planes.get(key) {
        Some(Plane::Uint(values)) => values.to_vec(),
        other => panic!("'{key}' should be whole numbers, found {other:?}"),
    }
}

/// A target of floats.
///
/// # Panics
/// When there is no such target.
pub fn floats(result: &FrameResult, key: &str) -> Vec<f32> {
    match result.planes.get(key) {
        Some(Plane::Float { values, .. }) => values.to_vec(),
        other => panic!("'{key}' should be floats, found {other:?}"),
    }
}

/// Peak signal to noise of two 8-bit pictures; dB, infinite for equal ones.
pub fn psnr(first: &FrameResult, second: &FrameResult) -> f64 {
    let pairs = first.picture.rgba.iter().zip(second.picture.rgba.iter());
    let squares: f64 = pairs
        .map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2))
        .sum();
    let mean = squares / first.picture.rgba.len() as f64;
    10.0 * (255.0_f64.powi(2) / mean).log10()
}
