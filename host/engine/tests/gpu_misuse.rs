//! What a plugin may get wrong with the GPU service: each is an error value that says what to do, and nothing panics.

mod gpu_support;

use abi_stable::std_types::RSlice;
use gpu_support::{
    NOTHING, QUOTA, Rig, begin, err, ok, stage, storage_binding, texture_descriptor,
};
use pointstage_plugin_api::abi::commands::*;
use pointstage_plugin_api::abi::*;

#[test]
fn a_stale_handle_is_refused() {
    let Some(rig) = Rig::new(&[]) else { return };
    let buffer = rig.storage(&[0]);
    rig.gpu.destroy(buffer);
    rig.gpu.destroy(buffer);
    let error = err(rig.gpu.write_buffer(buffer, 0, RSlice::from(&[0; 4][..])));
    assert_eq!(error.code, ErrorCode::BAD_HANDLE);
    assert!(error.message.contains("stale"), "{}", error.message);
    let layout = rig.layout(&[storage_binding(0)]);
    let error = err(rig.try_group(layout, &[buffer]));
    assert_eq!(error.code, ErrorCode::BAD_HANDLE);
}

#[test]
fn a_handle_of_another_kind_is_refused() {
    let Some(rig) = Rig::new(&[]) else { return };
    let layout = rig.layout(&[storage_binding(0)]);
    let shader = rig.shader(NOTHING);
    let error = err(rig.try_group(layout, &[shader]));
    assert_eq!(error.code, ErrorCode::BAD_HANDLE);
    assert!(
        error.message.contains("expected a buffer") && error.message.contains("is a shader"),
        "{}",
        error.message
    );
    assert!(error.message.contains("bind group 'test group': binding 0"));
}

#[test]
fn a_handle_of_another_plugin_is_refused() {
    let Some(rig) = Rig::new(&[]) else { return };
    let other = rig.service.owner("other plugin", &[], QUOTA);
    let others = rig.service.object(other);
    let buffer = rig.storage(&[7]);
    let error = err(others.write_buffer(buffer, 0, RSlice::from(&[0; 4][..])));
    assert_eq!(error.code, ErrorCode::BAD_HANDLE);
    assert!(
        error.message.contains("another plugin"),
        "{}",
        error.message
    );
    others.destroy(buffer);
    assert_eq!(
        rig.read_u32(buffer, 1),
        [7],
        "the other plugin changed nothing"
    );
}

#[test]
fn a_write_past_the_end_is_refused() {
    let Some(rig) = Rig::new(&[]) else { return };
    let buffer = rig.storage(&[0; 4]);
    for (offset, length) in [(12, 8), (16, 4), (u64::MAX - 3, 8)] {
        let data = vec![0; length];
        let error = err(rig.gpu.write_buffer(buffer, offset, data.as_slice().into()));
        assert_eq!(error.code, ErrorCode::VALIDATION);
        assert!(
            error.message.contains("buffer of 16 bytes"),
            "{}",
            error.message
        );
    }
    let error = err(rig.gpu.write_buffer(buffer, 0, RSlice::from(&[0; 3][..])));
    assert!(
        error.message.contains("multiples of 4"),
        "{}",
        error.message
    );
}

#[test]
fn a_write_to_a_hosts_buffer_is_refused() {
    let Some(rig) = Rig::new(&[]) else { return };
    let column = rig
        .service
        .device()
        .device
        .create_buffer(&wgpu::BufferDescriptor {
            label: Some("column"),
            size: 64,
            usage: wgpu::BufferUsages::all()
                - wgpu::BufferUsages::MAP_READ
                - wgpu::BufferUsages::MAP_WRITE
                - wgpu::BufferUsages::BLAS_INPUT
                - wgpu::BufferUsages::TLAS_INPUT,
            mapped_at_creation: false,
        });
    let column = rig.service.import_buffer(column);
    let error = err(rig.gpu.write_buffer(column, 0, RSlice::from(&[0; 4][..])));
    assert!(error.message.contains("read-only"), "{}", error.message);
    let layout = rig.layout(&[storage_binding(0)]);
    let error = err(rig.try_group(layout, &[column]));
    assert!(error.message.contains("read-only"), "{}", error.message);
    let message = rig.refused(vec![
        ClearBuffer {
            buffer: column,
            offset: 0,
            size: 0,
        }
        .into(),
    ]);
    assert!(message.contains("read-only"), "{message}");
    let layout = rig.layout(&[BindingLayoutRecord {
        kind: BindingKind::STORAGE_BUFFER_READ,
        ..storage_binding(0)
    }]);
    rig.group(layout, &[column]);
    rig.gpu.destroy(column);
    rig.group(layout, &[column]);
    rig.service.release(column);
    err(rig.try_group(layout, &[column]));
}

#[test]
fn bad_wgsl_is_shown_with_its_line_and_column() {
    let Some(rig) = Rig::new(&[]) else { return };
    let parse = err(rig.try_shader("fn a() {}\nfn b() {\n    let x = nonsense;\n}"));
    assert_eq!(parse.code, ErrorCode::VALIDATION);
    assert!(
        parse
            .message
            .contains("shader 'test shader', line 3, column 13: `let x = nonsense;`"),
        "{}",
        parse.message
    );
    assert!(parse.detail.contains("nonsense"), "{}", parse.detail);
    // Parses, but is not valid: a fragment shader returns nothing that has a location.
    let invalid = err(rig.try_shader("\n@fragment fn main() -> vec4f {\n    return vec4f();\n}"));
    assert!(
        invalid.message.contains("line 2, column"),
        "{}",
        invalid.message
    );
}

#[test]
fn an_entry_point_that_is_not_there_is_refused_with_those_that_are() {
    let Some(rig) = Rig::new(&[]) else { return };
    let error = err(rig.gpu.create_compute_pipeline(&ComputePipelineDescriptor {
        label: "typo".into(),
        layouts: RSlice::EMPTY,
        immediate_size: 0,
        stage: stage(rig.shader(NOTHING), "mian"),
    }));
    assert!(
        error.message.contains("compute pipeline 'typo'")
            && error.message.contains("'main' (Compute)"),
        "{}",
        error.message
    );
}

#[test]
fn a_constant_that_the_shader_lacks_is_refused() {
    let Some(rig) = Rig::new(&[]) else { return };
    let shader = rig
        .shader("override scale: f32 = 1.0; @compute @workgroup_size(1) fn main() { _ = scale; }");
    let pipeline = |name: &str| {
        let constants = [ConstantRecord {
            name: name.into(),
            value: 2.0,
        }];
        rig.gpu.create_compute_pipeline(&ComputePipelineDescriptor {
            label: "constants".into(),
            layouts: RSlice::EMPTY,
            immediate_size: 0,
            stage: StageRecord {
                constants: constants.as_slice().into(),
                ..stage(shader, "main")
            },
        })
    };
    ok(pipeline("scale"));
    let error = err(pipeline("scal"));
    assert!(error.message.contains("it has: scale"), "{}", error.message);
}

#[test]
fn an_unknown_format_number_is_named() {
    let Some(rig) = Rig::new(&[]) else { return };
    let descriptor = texture_descriptor(Format(4711), [4, 4], TextureUsage::COPY_DST);
    let error = err(rig.gpu.create_texture(&descriptor));
    assert_eq!(error.code, ErrorCode::UNSUPPORTED);
    assert!(
        error.message.contains("texture format 4711"),
        "{}",
        error.message
    );
}

#[test]
fn a_format_that_needs_a_feature_names_it() {
    let Some(rig) = Rig::new(&[]) else { return };
    if !rig.device_has(wgpu::Features::FLOAT32_BLENDABLE) {
        return;
    }
    let shader = rig.shader(
        "@vertex fn corner() -> @builtin(position) vec4f { return vec4f(); }
        @fragment fn fill() -> @location(0) vec4f { return vec4f(); }",
    );
    let add = BlendComponentRecord {
        source: BlendFactor::ONE,
        destination: BlendFactor::ONE,
        operation: BlendOperation::ADD,
    };
    let targets = [ColourTargetRecord {
        format: Format::RGBA32_FLOAT,
        blends: 1,
        colour: add,
        alpha: add,
        write_mask: 15,
    }];
    let descriptor = |shader| RenderPipelineDescriptor {
        label: "sums".into(),
        layouts: RSlice::EMPTY,
        immediate_size: 0,
        vertex: stage(shader, "corner"),
        fragment: stage(shader, "fill"),
        vertex_buffers: RSlice::EMPTY,
        topology: Topology::TRIANGLE_LIST,
        front_face: FrontFace(0),
        cull: CullMode(0),
        depth: DepthRecord::default(),
        targets: targets.as_slice().into(),
        sample_count: 1,
    };
    let error = err(rig.gpu.create_render_pipeline(&descriptor(shader)));
    assert_eq!(error.code, ErrorCode::UNSUPPORTED);
    assert!(
        error
            .message
            .contains("'float32-blendable'; ask for it in needs.features of the manifest"),
        "{}",
        error.message
    );
    let with = Rig::new(&["float32-blendable"]).expect("there is a device");
    let shader = with.shader(
        "@vertex fn corner() -> @builtin(position) vec4f { return vec4f(); }
        @fragment fn fill() -> @location(0) vec4f { return vec4f(); }",
    );
    ok(with.gpu.create_render_pipeline(&descriptor(shader)));
}

#[test]
fn the_quota_bounds_what_a_plugin_holds() {
    let Some(rig) = Rig::with_quota(4096) else {
        return;
    };
    let buffer = rig.buffer(4096, BufferUsage::STORAGE);
    let descriptor = texture_descriptor(Format::RGBA8_UNORM, [1, 1], TextureUsage::COPY_DST);
    let error = err(rig.gpu.create_texture(&descriptor));
    assert_eq!(error.code, ErrorCode::OUT_OF_MEMORY);
    assert!(error.message.contains("quota of 4096"), "{}", error.message);
    // A bind group keeps its buffer's memory, so the bytes count on.
    let layout = rig.layout(&[storage_binding(0)]);
    let group = rig.group(layout, &[buffer]);
    rig.gpu.destroy(buffer);
    assert_eq!(rig.service.bytes(rig.owner), 4096);
    rig.gpu.destroy(group);
    assert_eq!(rig.service.bytes(rig.owner), 0);
    ok(rig.gpu.create_texture(&descriptor));
}

#[test]
fn sizes_beyond_the_device_are_refused() {
    let Some(rig) = Rig::new(&[]) else { return };
    for size in [0, 6, u64::MAX - 3] {
        let error = err(rig.gpu.create_buffer(&BufferDescriptor {
            label: "odd".into(),
            size,
            usage: BufferUsage::STORAGE,
        }));
        assert!(error.message.contains("buffer 'odd'"), "{}", error.message);
        assert!(error.message.contains("multiple of 4"), "{}", error.message);
    }
    for size in [[0, 1], [1 << 30, 1]] {
        let descriptor = texture_descriptor(Format::RGBA8_UNORM, size, TextureUsage::COPY_DST);
        let error = err(rig.gpu.create_texture(&descriptor));
        assert!(
            error.message.contains("texels; expected"),
            "{}",
            error.message
        );
    }
    let most = rig.gpu.limit("max_compute_workgroups_per_dimension".into());
    let most = most.into_option().expect("a limit of WebGPU") as u32;
    let pipeline = rig.compute(rig.shader(NOTHING), &[]);
    if most < u32::MAX {
        let message = rig.refused(vec![
            begin(),
            SetPipeline { pipeline }.into(),
            Dispatch {
                groups: [1, most + 1, 1],
            }
            .into(),
            EndComputePass {}.into(),
        ]);
        assert!(message.contains("workgroups"), "{message}");
    }
    assert_eq!(rig.gpu.limit("max_beauty".into()).into_option(), None);
}
