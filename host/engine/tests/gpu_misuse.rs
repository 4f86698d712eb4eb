//! What a plugin may get wrong with the GPU service: each is an error value that says what to do, and nothing panics.

mod gpu_support;

use abi_stable::std_types::{RErr, ROk, RSlice};
use gpu_support::{QUOTA, Rig, err, list, ok, stage, storage_binding, texture_descriptor};
use pointstage_engine::gpu::Timings;
use pointstage_plugin_api::abi::commands::*;
use pointstage_plugin_api::abi::*;

const NOTHING: &str = "@compute @workgroup_size(1) fn main() {}";

fn begin() -> Command {
    BeginComputePass {
        label: "test pass".into(),
    }
    .into()
}

fn dispatch() -> Command {
    Dispatch { groups: [1, 1, 1] }.into()
}

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
fn a_command_in_the_wrong_place_is_refused_with_its_index() {
    let Some(rig) = Rig::new(&[]) else { return };
    let draw: Command = Draw {
        vertex_count: 3,
        instance_count: 1,
        first_vertex: 0,
        first_instance: 0,
    }
    .into();
    let end: Command = EndComputePass {}.into();
    let pipeline = rig.compute(rig.shader(NOTHING), &[]);
    let set: Command = SetPipeline { pipeline }.into();
    let pop: Command = PopDebugGroup {}.into();
    let push: Command = PushDebugGroup {
        label: "group".into(),
    }
    .into();
    for (commands, expected) in [
        (
            vec![draw.clone()],
            "command 0 (Draw): no render pass is open",
        ),
        (
            vec![begin(), draw],
            "command 1 (Draw): no render pass is open",
        ),
        (
            vec![dispatch()],
            "command 0 (Dispatch): no compute pass is open",
        ),
        (
            vec![begin(), dispatch()],
            "command 1 (Dispatch): no pipeline is set",
        ),
        (
            vec![set.clone()],
            "command 0 (SetPipeline): no pass is open",
        ),
        (
            vec![end.clone()],
            "command 0 (EndComputePass): no compute pass is open",
        ),
        (
            vec![begin(), begin()],
            "command 1 (BeginComputePass): the pass 'test pass' is open",
        ),
        (
            vec![begin(), set],
            "the list ends inside the pass 'test pass'",
        ),
        (
            vec![begin(), pop, end.clone()],
            "command 1 (PopDebugGroup): no debug group is open",
        ),
        (
            vec![begin(), push.clone(), end],
            "command 2 (EndComputePass): 1 debug groups",
        ),
        (vec![push], "the end of the commands: 1 debug groups"),
    ] {
        let message = rig.refused(commands);
        assert!(
            message.contains(expected),
            "expected '{expected}', found '{message}'"
        );
    }
}

#[test]
fn what_only_wgpu_finds_names_its_command_too() {
    let Some(rig) = Rig::new(&[]) else { return };
    let layout = rig.layout(&[storage_binding(0)]);
    let shader = rig.shader(
        "@group(0) @binding(0) var<storage, read_write> values: array<u32>;
        @compute @workgroup_size(1) fn main() { values[0] = 1u; }",
    );
    let pipeline = rig.compute(shader, &[layout]);
    let values = rig.storage(&[5]);
    let group = rig.group(layout, &[values]);
    let set: Command = SetPipeline { pipeline }.into();
    let clear = ClearBuffer {
        buffer: values,
        offset: 0,
        size: 4,
    };
    let bind = SetBindGroup {
        index: 0,
        group,
        offsets: vec![],
    };
    let end: Command = EndComputePass {}.into();
    let message = rig.refused(vec![
        clear.into(),
        begin(),
        set.clone(),
        bind.into(),
        dispatch(),
        end.clone(),
        begin(),
        set,
        // No bind group in this pass.
        dispatch(),
        end,
    ]);
    assert!(message.starts_with("command 8 (Dispatch): "), "{message}");
    assert_eq!(rig.read_u32(values, 1), [5], "nothing of it was submitted");
    assert!(rig.service.device().take_errors().is_empty());
}

#[test]
fn an_operation_of_a_newer_border_is_refused_with_its_index() {
    let Some(rig) = Rig::new(&[]) else { return };
    let mut commands = list(vec![begin(), EndComputePass {}.into()]);
    commands.commands.push(CommandRecord {
        operation: 9999,
        start: 0,
        length: 0,
    });
    let error = rig
        .service
        .replay(rig.owner, &commands, Timings::Off)
        .expect_err("no such operation");
    assert_eq!(error.code(), ErrorCode::UNSUPPORTED);
    assert!(
        error.to_string().contains("command 2: operation 9999"),
        "{error}"
    );
    commands.commands[2].operation = 17;
    let error = rig
        .service
        .replay(rig.owner, &commands, Timings::Off)
        .expect_err("no payload");
    assert_eq!(error.code(), ErrorCode::VALIDATION);
    assert!(error.to_string().contains("command 2"), "{error}");
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

#[test]
fn damaged_lists_never_panic() {
    let Some(rig) = Rig::new(&[]) else { return };
    let pipeline = rig.compute(rig.shader(NOTHING), &[]);
    let good = list(vec![
        begin(),
        SetPipeline { pipeline }.into(),
        dispatch(),
        EndComputePass {}.into(),
        ReadBack {
            buffer: rig.storage(&[1]),
            offset: 0,
            size: 4,
            ticket: ok(rig.gpu.create_ticket()),
        }
        .into(),
    ]);
    // Every byte of the payload and every operation number, changed one at a time.
    let mut damaged: Vec<CommandListRecord> = Vec::new();
    for index in 0..good.payload.len() {
        for change in [1, 0x80, 0xff] {
            let mut list = good.clone();
            list.payload[index] ^= change;
            damaged.push(list);
        }
    }
    for index in 0..good.commands.len() {
        for operation in 0..30 {
            let mut list = good.clone();
            list.commands[index].operation = operation;
            damaged.push(list);
        }
    }
    for list in damaged {
        match rig.gpu.submit(&list) {
            ROk(()) => {}
            RErr(error) => assert_ne!(error.code, ErrorCode::PANICKED, "{}", error.message),
        }
    }
    assert!(rig.service.device().take_errors().is_empty());
}
