//! From camera, lights and objects (f64, world) to the uniforms that shaders read (f32, view space).

use super::request::FrameRequest;
use glam::{DMat3, DMat4, DVec4, Vec3};
use pointstage_plugin_api::abi::{DrawFlags, DrawUniform, FrameUniform, LightUniform};
use pointstage_scene::{Camera, LightKind, Lights, Object, Projection, Provenance};

/// Linear grey of surfels without a colour.
const MID_GREY: [f32; 4] = [0.5, 0.5, 0.5, 1.0];

/// Counters of a frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FrameNumbers {
    /// Frames of this view so far.
    pub frame_index: u32,
    /// Samples of the present picture so far.
    pub sample_index: u32,
}

/// The frame's uniform.
pub(super) fn frame_uniform(request: &FrameRequest, numbers: FrameNumbers) -> FrameUniform {
    let FrameRequest {
        camera,
        lights,
        radius_scale,
        interaction,
        seed,
        ..
    } = request;
    let size = |size_px: [u32; 2]| size_px.map(|length| length.max(1) as f32);
    let image_size_px = size(request.image_size_px());
    let clip_from_view = request.clip_from_view();
    let view_from_world = camera.view_from_world();
    let (light_count, light_uniforms) = light_uniforms(lights, &view_from_world);
    FrameUniform {
        clip_from_view: columns(&clip_from_view),
        view_from_clip: columns(&clip_from_view.inverse()),
        view_from_world: columns(&view_from_world),
        image_size_px,
        tile_origin_px: request.tile_origin_px().map(|corner| corner as f32),
        tile_size_px: size(request.size_px),
        pixels_per_unit: pixels_per_unit(camera, f64::from(image_size_px[1])),
        near: camera.near as f32,
        far: match camera.projection {
            Projection::Perspective { .. } => 0.0,
            Projection::Orthographic { .. } => camera.far as f32,
        },
        is_orthographic: matches!(camera.projection, Projection::Orthographic { .. }).into(),
        radius_scale: *radius_scale,
        light_count,
        frame_index: numbers.frame_index,
        sample_index: numbers.sample_index,
        seed: *seed,
        interaction: interaction.0,
        ambient: extended(lights.ambient),
        lights: light_uniforms,
    }
}

/// The uniform of an object, as if all of it were drawn at once.
pub(super) fn object_uniform(object: &Object, camera: &Camera) -> DrawUniform {
    let view_from_object = camera.view_from_world() * DMat4::from(object.world_from_local());
    let linear = DMat3::from_mat4(view_from_object);
    let scale = linear
        .x_axis
        .length()
        .max(linear.y_axis.length())
        .max(linear.z_axis.length());
    let mut normals = columns(&DMat4::from_mat3(linear.inverse().transpose()));
    normals[3][3] = object.radius_scale;
    let two_sided = object.geometry.origins.normals == Provenance::Estimated;
    let flag = |on: bool, flag: DrawFlags| if on { flag.0 } else { 0 };
    DrawUniform {
        view_from_object: columns(&view_from_object),
        object_from_view: columns(&view_from_object.inverse()),
        view_from_object_normal: normals,
        material: [
            object.material.ka,
            object.material.kd,
            object.material.ks,
            object.material.shininess,
        ],
        radius_factor: scale as f32 * object.radius_scale,
        count: object.geometry.surfel_count.min(u32::MAX as usize) as u32,
        flags: flag(two_sided, DrawFlags::TWO_SIDED) | flag(object.selected, DrawFlags::SELECTED),
        default_colour: MID_GREY,
        ..DrawUniform::default()
    }
}

/// Pixels that one scene unit covers at distance 1 (perspective) or everywhere (orthographic).
fn pixels_per_unit(camera: &Camera, height_px: f64) -> f32 {
    (match camera.projection {
        Projection::Perspective { fov_y_rad } => height_px / (2.0 * (0.5 * fov_y_rad).tan()),
        Projection::Orthographic { height } => height_px / height,
    }) as f32
}

fn light_uniforms(lights: &Lights, view_from_world: &DMat4) -> (u32, [LightUniform; 4]) {
    let mut uniforms = [LightUniform::default(); 4];
    let enabled = lights.enabled();
    for (uniform, light) in uniforms.iter_mut().zip(&enabled) {
        let position_view = match light.kind_view(view_from_world) {
            LightKind::Directional { towards } => towards.extend(0.0),
            LightKind::Point { position } => position.extend(1.0),
        };
        *uniform = LightUniform {
            position_view: position_view.as_vec4().to_array(),
            colour: extended(light.colour),
        };
    }
    (enabled.len().min(uniforms.len()) as u32, uniforms)
}

/// Column-major, f32.
pub(super) fn columns(matrix: &DMat4) -> [[f32; 4]; 4] {
    matrix
        .to_cols_array_2d()
        .map(|column| DVec4::from_array(column).as_vec4().to_array())
}

fn extended(colour: Vec3) -> [f32; 4] {
    colour.extend(0.0).to_array()
}
