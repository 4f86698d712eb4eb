//! What `pop` draws: the mesh itself where it is large, splats without holes where it is small, the same by every path.

mod agreement;
mod hybrid;
mod odd_meshes;

use std::sync::Arc;

use glam::{DAffine3, DQuat, DVec3};
use pointstage_engine::stage::{FrameResult, SettingValue, Stage};
use pointstage_scene::{Camera, Scene};
use pointstage_tests::models::{dented_mesh, meshed};
use pointstage_tests::shots::{Setting, draw, request, scene_of};

/// Where the eye stands in most of these pictures.
const EYE: DVec3 = DVec3::new(0.5, 0.7, 3.0);

fn threshold(px: f64) -> Setting {
    ("threshold", SettingValue::Float(px))
}

const fn on(id: &'static str, value: bool) -> Setting {
    (id, SettingValue::Bool(value))
}

/// A dented ball of 2 · 80 · 160 triangles, some 2 px wide from [`EYE`].
fn ball() -> Arc<Scene> {
    let (vertices, triangles) = dented_mesh(80, 160);
    scene_of(meshed("ball", &vertices, &triangles))
}

/// A fine ball, and in front of it a coarse one, squeezed and mirrored.
fn two_balls() -> Arc<Scene> {
    let mut scene = Scene::new();
    let (vertices, triangles) = dented_mesh(160, 320);
    scene.add(meshed("fine", &vertices, &triangles));
    let (vertices, triangles) = dented_mesh(12, 20);
    let mut coarse = meshed("coarse", &vertices, &triangles);
    coarse.world_from_object = DAffine3::from_scale_rotation_translation(
        DVec3::new(-0.3, 0.2, 0.35),
        DQuat::from_rotation_y(0.7),
        DVec3::new(0.4, 0.3, 2.0),
    );
    scene.add(coarse);
    Arc::new(scene)
}

fn drawn(
    stage: &mut Stage,
    scene: &Arc<Scene>,
    camera: Camera,
    settings: &[Setting],
) -> FrameResult {
    draw(stage, &request(scene, camera, "pop", settings))
}

fn reported(result: &FrameResult, key: &str) -> f64 {
    let found = result.stats.reported.get(key).copied();
    found.unwrap_or_else(|| panic!("{key} is reported"))
}
