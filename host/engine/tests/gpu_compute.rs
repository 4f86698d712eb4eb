//! Compute through the GPU service: dispatches, copies, read-backs, features and times.

mod gpu_support;

use abi_stable::std_types::RNone;
use gpu_support::{PATIENCE, Rig, err, list, ok, storage_binding};
use pointstage_engine::gpu::{PassTimes, Timings};
use pointstage_plugin_api::abi::commands::*;
use pointstage_plugin_api::abi::{
    BindingKind, BindingLayoutRecord, BufferUsage, ErrorCode, Format, Handle, ShaderStages,
    StorageAccess, TextureUsage,
};

/// Adds one to each of 64 values.
const ADD_ONE: &str = "
@group(0) @binding(0) var<storage, read_write> values: array<u32>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    values[id.x] += 1u;
}
";

struct AddOne {
    pipeline: Handle,
    group: Handle,
    values: Handle,
}

impl AddOne {
    fn new(rig: &Rig) -> Self {
        let layout = rig.layout(&[storage_binding(0)]);
        let values = rig.storage(&(0..64).collect::<Vec<u32>>());
        Self {
            pipeline: rig.compute(rig.shader(ADD_ONE), &[layout]),
            group: rig.group(layout, &[values]),
            values,
        }
    }

    /// A pass that adds one, by `dispatch`.
    fn pass(&self, dispatch: impl Into<Command>) -> Vec<Command> {
        vec![
            BeginComputePass {
                label: "add one".into(),
            }
            .into(),
            SetPipeline {
                pipeline: self.pipeline,
            }
            .into(),
            SetBindGroup {
                index: 0,
                group: self.group,
                offsets: vec![],
            }
            .into(),
            dispatch.into(),
            EndComputePass {}.into(),
        ]
    }
}

#[test]
fn a_dispatch_writes_what_a_read_back_returns() {
    let Some(rig) = Rig::new(&[]) else { return };
    let add = AddOne::new(&rig);
    rig.run(add.pass(Dispatch { groups: [1, 1, 1] }));
    let expected: Vec<u32> = (1..65).collect();
    assert_eq!(rig.read_u32(add.values, 64), expected);
}

#[test]
fn an_indirect_dispatch_takes_its_size_from_a_buffer() {
    let Some(rig) = Rig::new(&[]) else { return };
    let add = AddOne::new(&rig);
    let arguments = rig.storage(&[9, 9, 1, 1, 1]);
    rig.run(add.pass(DispatchIndirect {
        buffer: arguments,
        offset: 8,
    }));
    assert_eq!(rig.read_u32(add.values, 64)[63], 64);
    let message = rig.refused(add.pass(DispatchIndirect {
        buffer: arguments,
        offset: 12,
    }));
    assert!(
        message.starts_with("command 3 (DispatchIndirect): "),
        "{message}"
    );
    assert!(message.contains("20 bytes"), "{message}");
}

#[test]
fn a_ticket_is_empty_until_its_commands_ran_and_gives_its_bytes_once() {
    let Some(rig) = Rig::new(&[]) else { return };
    let buffer = rig.storage(&[1, 2, 3, 4]);
    let ticket = ok(rig.gpu.create_ticket());
    assert_eq!(ok(rig.gpu.poll_ticket(ticket)), RNone);
    let read = ReadBack {
        buffer,
        offset: 4,
        size: 8,
        ticket,
    };
    rig.run(vec![read.clone().into()]);
    assert_eq!(rig.poll(ticket), bytemuck::cast_slice::<u32, u8>(&[2, 3]));
    let again = err(rig.gpu.poll_ticket(ticket));
    assert!(again.message.contains("taken"), "{}", again.message);
    let message = rig.refused(vec![read.into()]);
    assert!(message.contains("ticket"), "{message}");
}

#[test]
fn copies_and_clears_reach_the_bytes_they_name() {
    let Some(rig) = Rig::new(&[]) else { return };
    let source = rig.storage(&[1, 2, 3, 4]);
    let target = rig.storage(&[9; 6]);
    rig.run(vec![
        CopyBufferToBuffer {
            source,
            source_offset: 4,
            target,
            target_offset: 8,
            size: 8,
        }
        .into(),
        ClearBuffer {
            buffer: target,
            offset: 20,
            size: 0,
        }
        .into(),
    ]);
    assert_eq!(rig.read_u32(target, 6), [9, 9, 2, 3, 9, 0]);
}

#[test]
fn a_storage_texture_keeps_what_a_shader_stores() {
    let Some(rig) = Rig::new(&[]) else { return };
    let usage = TextureUsage::STORAGE_BINDING | TextureUsage::COPY_SRC;
    let texture = rig.texture(Format::R32_UINT, [64, 2], usage);
    let layout = rig.layout(&[BindingLayoutRecord {
        binding: 0,
        visibility: ShaderStages::COMPUTE,
        kind: BindingKind::STORAGE_TEXTURE,
        format: Format::R32_UINT,
        access: StorageAccess::WRITE,
        ..Default::default()
    }]);
    let shader = rig.shader(
        "@group(0) @binding(0) var image: texture_storage_2d<r32uint, write>;
        @compute @workgroup_size(64)
        fn main(@builtin(global_invocation_id) id: vec3u) {
            textureStore(image, id.xy, vec4u(id.x + 100u * id.y));
        }",
    );
    let pipeline = rig.compute(shader, &[layout]);
    let group = rig.group(layout, &[texture]);
    let rows = rig.buffer(512, BufferUsage::COPY_SRC | BufferUsage::COPY_DST);
    let mut commands = AddOne {
        pipeline,
        group,
        values: Handle::NONE,
    }
    .pass(Dispatch { groups: [1, 2, 1] });
    commands.push(
        CopyTextureToBuffer {
            source: texture,
            mip_level: 0,
            origin: [0; 3],
            size: [64, 2, 1],
            target: rows,
            offset: 0,
            bytes_per_row: 256,
        }
        .into(),
    );
    rig.run(commands);
    let texels = rig.read_u32(rows, 128);
    assert_eq!(texels[63], 63);
    assert_eq!(texels[64 + 5], 105);
}

#[test]
fn passes_are_timed_where_the_device_has_timestamps() {
    let Some(rig) = Rig::new(&[]) else { return };
    let add = AddOne::new(&rig);
    let mut commands = add.pass(Dispatch { groups: [1, 1, 1] });
    commands.extend(add.pass(Dispatch { groups: [1, 1, 1] }));
    for _ in 0..3 {
        // More than once: the queries are used again.
        let mut replay = rig
            .service
            .replay(rig.owner, &list(commands.clone()), Timings::On)
            .expect("the commands are right");
        assert_eq!(replay.passes(), ["add one", "add one"]);
        replay.wait(PATIENCE).expect("the device works on");
        if !rig.device_has(wgpu::Features::TIMESTAMP_QUERY) {
            assert_eq!(replay.times(), PassTimes::Unavailable);
            return;
        }
        let PassTimes::Known(times) = replay.times() else {
            panic!("the device is done, but the times are {:?}", replay.times());
        };
        assert_eq!(times.len(), 2);
        assert!(times.iter().all(|pass| pass.label == "add one"));
        assert!(times.iter().all(|pass| pass.time < PATIENCE), "{times:?}");
        assert!(times.iter().any(|pass| !pass.time.is_zero()), "{times:?}");
    }
}

#[test]
fn a_feature_is_there_only_for_who_asks() {
    const WIDE: &str = "
    @group(0) @binding(0) var<storage, read_write> nearest: array<atomic<u64>>;
    @compute @workgroup_size(64)
    fn main(@builtin(global_invocation_id) id: vec3u) {
        atomicMin(&nearest[0], u64(id.x + 5u) << 32u);
    }";
    let Some(without) = Rig::new(&[]) else { return };
    if !without.device_has(wgpu::Features::SHADER_INT64_ATOMIC_MIN_MAX) {
        return;
    }
    let names = ["shader-int64", "shader-int64-atomic-min-max"];
    let with = Rig::new(&names).expect("there is a device");
    for name in names {
        assert_eq!(without.gpu.feature(name.into()), 0);
        assert_eq!(with.gpu.feature(name.into()), 1);
    }
    let error = err(without.try_shader(WIDE));
    assert_eq!(error.code, ErrorCode::UNSUPPORTED);
    assert!(error.message.contains("'shader-int64"), "{}", error.message);
    assert!(error.message.contains("needs.features of the manifest"));

    let layout = with.layout(&[storage_binding(0)]);
    let nearest = with.storage(&[u32::MAX; 2]);
    let wide = AddOne {
        pipeline: with.compute(with.shader(WIDE), &[layout]),
        group: with.group(layout, &[nearest]),
        values: nearest,
    };
    with.run(wide.pass(Dispatch { groups: [1, 1, 1] }));
    assert_eq!(with.read_u32(nearest, 2), [0, 5]);
}

#[test]
fn a_plugin_can_submit_and_read_back_by_itself() {
    let Some(rig) = Rig::new(&[]) else { return };
    let add = AddOne::new(&rig);
    let ticket = ok(rig.gpu.create_ticket());
    let mut commands = add.pass(Dispatch { groups: [1, 1, 1] });
    commands.push(
        ReadBack {
            buffer: add.values,
            offset: 0,
            size: 256,
            ticket,
        }
        .into(),
    );
    ok(rig.gpu.submit(&list(commands)));
    rig.service
        .wait_idle(PATIENCE)
        .expect("the device works on");
    assert_eq!(bytemuck::cast_slice::<u8, u32>(&rig.poll(ticket))[9], 10);
}
