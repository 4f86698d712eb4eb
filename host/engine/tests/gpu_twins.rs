//! Functions of the shader library on the device against their CPU twins, on random input.

mod gpu_support;

use glam::{DVec3, Vec3, Vec4};
use gpu_support::{Rig, ok, storage_binding};
use pointstage_plugin_api::abi::commands::*;
use pointstage_plugin_api::abi::{
    BindingKind, BindingLayoutRecord, BufferUsage, DrawUniform, FrameUniform, Handle, LightUniform,
    ShaderStages,
};
use pointstage_plugin_api::clip::ClipLines;
use pointstage_plugin_api::columns;
use pointstage_plugin_api::twin::{clip, depth, lighting};
use pointstage_plugin_api::wgsl::{Module, link};
use pointstage_scene::{Camera, Projection};

/// Invocations of a run: a multiple of the workgroup.
const COUNT: usize = 1024;

/// Inputs in -1..1, from a fixed seed (splitmix64).
fn random() -> Vec<[f32; 4]> {
    let mut state = 1_u64;
    let mut next = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (bits >> 40) as f32 / (1_u32 << 23) as f32 - 1.0
    };
    (0..COUNT)
        .map(|_| [next(), next(), next(), next()])
        .collect()
}

fn uniform_buffer(rig: &Rig, content: &[u8]) -> Handle {
    let usage = BufferUsage::UNIFORM | BufferUsage::COPY_DST;
    let buffer = rig.buffer(content.len() as u64, usage);
    ok(rig.gpu.write_buffer(buffer, 0, content.into()));
    buffer
}

/// What `expression` of `value`, a vec4f, is for each input. It imports what `imports` says.
fn on_device(
    rig: &Rig,
    imports: &str,
    expression: &str,
    frame: &FrameUniform,
    draw: &DrawUniform,
    inputs: &[[f32; 4]],
) -> Vec<[f32; 4]> {
    let source = format!(
        "{imports}
         @group(1) @binding(0) var<storage, read_write> values: array<vec4f>;
         @compute @workgroup_size(64)
         fn main(@builtin(global_invocation_id) id: vec3u) {{
             let value = values[id.x];
             values[id.x] = {expression};
         }}"
    );
    let wgsl = link(Module::new("test::main", &source), &[], &[]).expect("the test's shader links");
    let uniform = |binding| BindingLayoutRecord {
        binding,
        visibility: ShaderStages::COMPUTE,
        kind: BindingKind::UNIFORM_BUFFER,
        ..Default::default()
    };
    let layouts = [
        rig.layout(&[uniform(0), uniform(1)]),
        rig.layout(&[storage_binding(0)]),
    ];
    let uniforms = [
        uniform_buffer(rig, bytemuck::bytes_of(frame)),
        uniform_buffer(rig, bytemuck::bytes_of(draw)),
    ];
    let values = rig.storage(bytemuck::cast_slice(inputs));
    let groups = [
        rig.group(layouts[0], &uniforms),
        rig.group(layouts[1], &[values]),
    ];
    let pipeline = rig.compute(rig.shader(&wgsl), &layouts);
    let label = "twins".into();
    let bind = |index: u32| SetBindGroup {
        index,
        group: groups[index as usize],
        offsets: vec![],
    };
    rig.run(vec![
        BeginComputePass { label }.into(),
        SetPipeline { pipeline }.into(),
        bind(0).into(),
        bind(1).into(),
        Dispatch {
            groups: [(inputs.len() / 64) as u32, 1, 1],
        }
        .into(),
        EndComputePass {}.into(),
    ]);
    let words = rig.read_u32(values, inputs.len() as u64 * 4);
    bytemuck::pod_collect_to_vec(&words)
}

/// A frame as a camera 2 units high and wide at distance 1 has it, with a near light and a far one.
fn frame(projection: Projection) -> FrameUniform {
    let camera = Camera {
        projection,
        near: 0.1,
        far: 50.0,
        ..Camera::default()
    };
    let clip_from_view = camera.clip_from_view(1.0);
    let mut frame = FrameUniform {
        clip_from_view: clip_from_view.as_mat4().to_cols_array_2d(),
        view_from_clip: clip_from_view.inverse().as_mat4().to_cols_array_2d(),
        is_orthographic: matches!(projection, Projection::Orthographic { .. }).into(),
        light_count: 2,
        ambient: [0.5, 0.25, 1.0, 0.0],
        ..FrameUniform::default()
    };
    frame.lights[0] = LightUniform {
        position_view: [0.36, 0.48, 0.8, 0.0],
        colour: [1.0, 0.5, 0.25, 0.0],
    };
    frame.lights[1] = LightUniform {
        position_view: [2.0, -3.0, 1.5, 1.0],
        colour: [0.25, 0.5, 2.0, 0.0],
    };
    frame
}

fn projections() -> [Projection; 2] {
    let fov_y_rad = std::f64::consts::FRAC_PI_2;
    [
        Projection::Perspective { fov_y_rad },
        Projection::Orthographic { height: 2.0 },
    ]
}

/// Compares what the device found with what the twin says, within `tolerance` of 1 or of the value if that is greater.
fn assert_close<const N: usize>(
    found: &[[f32; 4]],
    inputs: &[[f32; 4]],
    tolerance: f64,
    twin: impl Fn([f32; 4]) -> [f64; N],
) {
    for (found, input) in found.iter().zip(inputs) {
        let expected = twin(*input);
        for (found, expected) in found.iter().zip(expected) {
            let error = (f64::from(*found) - expected).abs();
            assert!(
                error <= tolerance * expected.abs().max(1.0),
                "of {input:?}: {found} on the device, {expected} by the twin"
            );
        }
    }
}

// pow is exp2 of a product with log2, and a driver may take either to some 1e-5.
const POW: f64 = 1e-3;

#[test]
fn colours_are_those_of_the_twin() {
    let Some(rig) = Rig::new(&[]) else { return };
    let (frame, draw) = (FrameUniform::default(), DrawUniform::default());
    let inputs: Vec<_> = random().iter().map(|value| value.map(f32::abs)).collect();
    let run = |imports, expression| on_device(&rig, imports, expression, &frame, &draw, &inputs);
    let found = run(
        "import lib::colour::linear_from_srgb;",
        "vec4f(linear_from_srgb(value.rgb), 0.0)",
    );
    assert_close(&found, &inputs, POW, |[r, g, b, _]| {
        [r, g, b].map(|channel| columns::linear_from_srgb(channel).into())
    });
    let found = run(
        "import lib::colour::srgb_from_linear;",
        "vec4f(srgb_from_linear(value.rgb), 0.0)",
    );
    assert_close(&found, &inputs, POW, |[r, g, b, _]| {
        [r, g, b].map(|channel| columns::srgb_from_linear(channel).into())
    });
    let found = run(
        "import lib::colour::{decode_colour_linear, encode_colour};",
        "decode_colour_linear(encode_colour(value))",
    );
    // A step of 8 bits where the rounding of an exact half differs.
    assert_close(&found, &inputs, 0.01, |value| {
        let packed = columns::encode_colour(Vec4::from(value));
        columns::decode_colour_linear(packed)
            .to_array()
            .map(f64::from)
    });
}

#[test]
fn normals_are_those_of_the_twin() {
    let Some(rig) = Rig::new(&[]) else { return };
    let (frame, draw) = (FrameUniform::default(), DrawUniform::default());
    let inputs = random();
    let found = on_device(
        &rig,
        "import lib::octahedral::{decode_normal, encode_normal};",
        "vec4f(decode_normal(encode_normal(value.xyz)), 0.0)",
        &frame,
        &draw,
        &inputs,
    );
    // A step of 16 bits is 3e-5 of a radian, and rounding may take the next one.
    assert_close(&found, &inputs, 1e-4, |[x, y, z, _]| {
        let packed = columns::encode_normal(Vec3::new(x, y, z).normalize());
        columns::decode_normal(packed).to_array().map(f64::from)
    });
}

#[test]
fn depths_are_those_of_the_twin() {
    let Some(rig) = Rig::new(&[]) else { return };
    let draw = DrawUniform::default();
    // Distances in the view, 0.5 to 20.
    let inputs: Vec<_> = random()
        .iter()
        .map(|[x, ..]| [10.25 + 9.75 * x, 0.0, 0.0, 0.0])
        .collect();
    for projection in projections() {
        let frame = frame(projection);
        let found = on_device(
            &rig,
            "import lib::depth::{depth_from_eye_distance, eye_distance_from_depth, bits_from_depth, depth_from_bits};",
            "vec4f(depth_from_eye_distance(value.x), \
                   eye_distance_from_depth(depth_from_eye_distance(value.x)), \
                   depth_from_bits(bits_from_depth(value.x)), 0.0)",
            &frame,
            &draw,
            &inputs,
        );
        assert_close(&found, &inputs, 1e-5, |[distance, ..]| {
            let depth = depth::depth_from_eye_distance(&frame, distance.into());
            let back = depth::eye_distance_from_depth(&frame, depth);
            [depth, back, distance.into()]
        });
    }
}

#[test]
fn lighting_is_that_of_the_twin() {
    let Some(rig) = Rig::new(&[]) else { return };
    let draw = DrawUniform {
        material: [0.3, 0.7, 0.4, 12.0],
        ..DrawUniform::default()
    };
    let inputs = random();
    for projection in projections() {
        let frame = frame(projection);
        let found = on_device(
            &rig,
            "import lib::lighting::phong;",
            "vec4f(phong(abs(value.zyx), value.xyz - vec3f(0.0, 0.0, 3.0), normalize(value.ywx)), 0.0)",
            &frame,
            &draw,
            &inputs,
        );
        assert_close(&found, &inputs, POW, |value| {
            let [x, y, z, w] = value.map(f64::from);
            let colour = DVec3::new(z, y, x).abs();
            let position = DVec3::new(x, y, z - 3.0);
            let normal = DVec3::new(y, w, x).normalize();
            lighting::phong(&frame, draw.material, colour, position, normal).to_array()
        });
    }
}

#[test]
fn clip_lines_are_those_of_the_twin() {
    let Some(rig) = Rig::new(&[]) else { return };
    let (frame, draw) = (FrameUniform::default(), DrawUniform::default());
    let inputs = random();
    for is_union in [false, true] {
        let flag = f32::from(u8::from(is_union));
        let expression = format!(
            "vec4f(clamp(clip_distance(scaled_clip_lines(ClipLines(value.xyz, {flag:?}, value.wzx, 0.0), 1.5), \
             vec3f(value.xy, 1.5 + 0.5 * value.z), vec3f(0.3, -0.1, 0.05), vec3f(0.1, 0.2, value.w)), -50.0, 50.0), \
             select(0.0, 1.0, clip_keeps(ClipLines(value.xyz, {flag:?}, value.wzx, 0.0), vec3f(value.yx, 1.0))), 0.0, 0.0)"
        );
        let found = on_device(
            &rig,
            "import lib::clip::{clip_distance, clip_keeps, scaled_clip_lines, ClipLines};",
            &expression,
            &frame,
            &draw,
            &inputs,
        );
        assert_close(&found, &inputs, 1e-3, |[x, y, z, w]| {
            let lines = ClipLines::new([[x, y, z], [w, z, x]], is_union);
            let [x, y, z, w] = [x, y, z, w].map(f64::from);
            let uv1 = [
                DVec3::new(x, y, 1.5 + 0.5 * z),
                DVec3::new(0.3, -0.1, 0.05),
                DVec3::new(0.1, 0.2, w),
            ];
            let distance = clip::clip_distance(&clip::scaled_clip_lines(lines, 1.5), uv1);
            let keeps = clip::clip_keeps(&lines, DVec3::new(y, x, 1.0));
            [distance.clamp(-50.0, 50.0), f64::from(u8::from(keeps))]
        });
    }
}
