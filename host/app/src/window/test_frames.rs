//! Pictures for tests, drawn without a device.

use std::sync::Arc;

use glam::DVec3;
use pointstage_engine::plugins::DiscoverOptions;
use pointstage_engine::stage::{FALLBACK_ID, FrameRequest, FrameResult, Stage, StageOptions};
use pointstage_plugin_api::columns::{encode_colour, encode_normal};
use pointstage_scene::{Block, Camera, Geometry, Object, Origins, Provenance, Scene};

/// Four wide surfels in the plane z = 0, facing +z, and a picture of them with these targets read back.
pub(crate) fn frame_of_square(read_back: &[&str]) -> (Arc<Scene>, FrameResult) {
    let corners = [[-0.25, -0.25], [0.25, -0.25], [-0.25, 0.25], [0.25, 0.25]];
    let block = Block {
        position_radius: corners.map(|[x, y]| [x, y, 0.0, 0.4]).into(),
        normal: Some([encode_normal(glam::Vec3::Z); 4].into()),
        colour: Some([encode_colour(glam::Vec4::new(1.0, 0.5, 0.0, 1.0)); 4].into()),
        axes: None,
        named: Vec::new(),
    };
    let origins = Origins {
        normals: Provenance::FromFile,
        radii: Provenance::FromFile,
        ..Origins::default()
    };
    let mut scene = Scene::new();
    scene.add(Object::new(
        "square",
        DVec3::ZERO,
        Geometry::new(vec![block], None, origins),
    ));
    let scene = Arc::new(scene);
    let options = StageOptions {
        use_device: false,
        plugins: DiscoverOptions::default(),
        ..StageOptions::default()
    };
    let mut stage = Stage::new(options).expect("a stage without a device");
    let request = FrameRequest {
        read_back: read_back.iter().map(|key| (*key).to_owned()).collect(),
        ..FrameRequest::still(scene.clone(), Camera::default(), [60, 40], FALLBACK_ID)
    };
    let shown = stage.frame(&request).expect("the fallback draws");
    (scene, shown)
}
