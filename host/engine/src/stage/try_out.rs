//! The second half of first contact: one frame by a plugin on the real adapter, in a child process.

use super::{FrameRequest, Stage, StageError, StageOptions};
use glam::{DVec3, Vec3, Vec4};
use pointstage_plugin_api::columns;
use pointstage_scene::{Block, Camera, Geometry, Object, Origins, Scene};
use std::sync::Arc;

/// How a try-out ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TryOut {
    /// It drew a frame.
    Drew,
    /// It refused or failed, and said why.
    Failed(String),
}

/// Draws one small frame of a made-up scene with a renderer, or with the selection of a structure. `None` is the control
/// run: the device and the host alone.
///
/// # Errors
/// The stage cannot be opened: no fault of the plugin's.
pub fn try_out(options: StageOptions, plugin: Option<&str>) -> Result<TryOut, StageError> {
    let mut stage = Stage::new(options)?;
    let camera = Camera {
        eye: DVec3::new(0.0, 0.0, 4.0),
        ..Camera::default()
    };
    let is_structure = plugin.is_some_and(|id| stage.registry().find_structure(id).is_ok());
    let (structure, renderer) = if is_structure {
        (plugin, None)
    } else {
        (None, plugin)
    };
    let renderer = renderer.unwrap_or(super::FALLBACK_ID);
    let request = FrameRequest {
        structure: structure.map(str::to_owned),
        ..FrameRequest::still(Arc::new(sample_scene()), camera, [64, 64], renderer)
    };
    Ok(match stage.frame(&request) {
        Ok(_) => TryOut::Drew,
        Err(error) => TryOut::Failed(error.to_string()),
    })
}

/// A small sphere with every standard column, so that hardly any need is unmet.
fn sample_scene() -> Scene {
    const COUNT: usize = 400;
    // A Fibonacci lattice: even spacing without a table.
    let golden_angle = std::f32::consts::PI * (3.0 - 5.0_f32.sqrt());
    let normals: Vec<Vec3> = (0..COUNT)
        .map(|index| {
            let y = 1.0 - 2.0 * (index as f32 + 0.5) / COUNT as f32;
            let (sin, cos) = (index as f32 * golden_angle).sin_cos();
            let across = (1.0 - y * y).sqrt();
            Vec3::new(across * cos, y, across * sin)
        })
        .collect();
    let axes = |normal: &Vec3| {
        let u = normal.any_orthonormal_vector();
        let v = normal.cross(u);
        [
            u.x * 0.1,
            u.y * 0.1,
            u.z * 0.1,
            0.0,
            v.x * 0.1,
            v.y * 0.1,
            v.z * 0.1,
            0.0,
        ]
    };
    let block = Block {
        position_radius: normals
            .iter()
            .map(|normal| normal.extend(0.1).to_array())
            .collect(),
        normal: Some(
            normals
                .iter()
                .map(|normal| columns::encode_normal(*normal))
                .collect(),
        ),
        colour: Some(
            normals
                .iter()
                .map(|n| columns::encode_colour(Vec4::from((n.abs(), 1.0))))
                .collect(),
        ),
        axes: Some(normals.iter().map(axes).collect()),
        named: Vec::new(),
    };
    let triangles = Arc::from(vec![[0, 1, 2], [3, 4, 5]]);
    let mut scene = Scene::new();
    scene.add(Object::new(
        "sample",
        DVec3::ZERO,
        Geometry::new(vec![block], Some(triangles), Origins::FROM_FILE),
    ));
    scene
}
