//! What the GPU service's tests share: a device, an owner, and short ways to make resources.

#![allow(
    dead_code,
    unreachable_pub,
    reason = "each test file uses its own part of this module"
)]

use abi_stable::std_types::{RErr, RNone, ROk, RResult, RSlice, RSome, RStr};
use pointstage_engine::device::{Backend, DeviceOptions, GpuDevice, GpuError};
use pointstage_engine::gpu::{GpuService, Owner, Replay, Timings};
use pointstage_plugin_api::abi::commands::{
    BeginComputePass, Command, CommandListRecord, CopyTextureToBuffer, Dispatch, ReadBack,
};
use pointstage_plugin_api::abi::*;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

/// Longer than any test's work takes, even on a busy machine without a GPU.
pub const PATIENCE: Duration = Duration::from_mins(1);

/// Plenty for every test that is not about quotas; bytes.
pub const QUOTA: u64 = 1 << 30;

/// A shader that does nothing.
pub const NOTHING: &str = "@compute @workgroup_size(1) fn main() {}";

/// Of the targets that tests draw into, px.
pub const SIZE: [u32; 2] = [64, 4];

/// A service, an owner in it, and the border object that its plugin would have.
pub struct Rig {
    pub service: Arc<GpuService>,
    pub owner: Owner,
    pub gpu: GpuRef,
}

/// The default adapter, or one of the interface that `POINTSTAGE_TEST_BACKEND` names.
fn options() -> DeviceOptions {
    let backend = std::env::var("POINTSTAGE_TEST_BACKEND").ok().map(|name| {
        name.parse::<Backend>()
            .unwrap_or_else(|error| panic!("POINTSTAGE_TEST_BACKEND: {error}"))
    });
    DeviceOptions {
        backend,
        adapter: None,
    }
}

/// The device of all tests of one file; None, with a line that says why, if this machine has none.
fn device() -> Option<Arc<GpuDevice>> {
    static DEVICE: OnceLock<Option<Arc<GpuDevice>>> = OnceLock::new();
    let device = DEVICE.get_or_init(|| GpuDevice::open(&options()).ok());
    if device.is_none() {
        eprintln!("skipped: this machine has no graphics adapter that opens");
    }
    device.clone()
}

impl Rig {
    /// An owner with these features.
    pub fn new(features: &[&str]) -> Option<Self> {
        Some(Self::on(device()?, features, QUOTA))
    }

    /// An owner on a device of its own, which the test may destroy.
    pub fn on_its_own_device() -> Option<Self> {
        let device = GpuDevice::open(&options())
            .inspect_err(|error| eprintln!("skipped: {error}"))
            .ok()?;
        Some(Self::on(device, &[], QUOTA))
    }

    /// An owner with a quota in bytes.
    pub fn with_quota(quota: u64) -> Option<Self> {
        Some(Self::on(device()?, &[], quota))
    }

    fn on(device: Arc<GpuDevice>, features: &[&str], quota: u64) -> Self {
        let service = GpuService::new(device);
        let features: Vec<String> = features.iter().map(ToString::to_string).collect();
        let owner = service.owner("test plugin", &features, quota);
        let gpu = service.object(owner);
        Self {
            service,
            owner,
            gpu,
        }
    }

    /// Whether the device has a feature, so that a test of it can be skipped.
    pub fn device_has(&self, feature: wgpu::Features) -> bool {
        let has = self.service.device().features.contains(feature);
        if !has {
            eprintln!("skipped: the adapter lacks {feature:?}");
        }
        has
    }

    pub fn buffer(&self, size: u64, usage: BufferUsage) -> Handle {
        ok(self.gpu.create_buffer(&BufferDescriptor {
            label: "test buffer".into(),
            size,
            usage,
        }))
    }

    /// A storage buffer that can be written, read back and used for arguments.
    pub fn storage(&self, content: &[u32]) -> Handle {
        let buffer = self.buffer(
            content.len() as u64 * 4,
            BufferUsage::STORAGE
                | BufferUsage::COPY_DST
                | BufferUsage::COPY_SRC
                | BufferUsage::INDIRECT,
        );
        ok(self
            .gpu
            .write_buffer(buffer, 0, bytemuck::cast_slice(content).into()));
        buffer
    }

    pub fn texture(&self, format: Format, size_px: [u32; 2], usage: TextureUsage) -> Handle {
        ok(self
            .gpu
            .create_texture(&texture_descriptor(format, size_px, usage)))
    }

    pub fn shader(&self, wgsl: &str) -> Handle {
        ok(self.try_shader(wgsl))
    }

    pub fn try_shader(&self, wgsl: &str) -> RResult<Handle, ErrorRecord> {
        self.gpu.create_shader(&ShaderDescriptor {
            label: "test shader".into(),
            wgsl: wgsl.into(),
        })
    }

    pub fn layout(&self, entries: &[BindingLayoutRecord]) -> Handle {
        ok(self
            .gpu
            .create_bind_group_layout(&BindGroupLayoutDescriptor {
                label: "test layout".into(),
                entries: entries.into(),
            }))
    }

    /// A group of whole resources at bindings 0, 1, ….
    pub fn group(&self, layout: Handle, resources: &[Handle]) -> Handle {
        ok(self.try_group(layout, resources))
    }

    pub fn try_group(&self, layout: Handle, resources: &[Handle]) -> RResult<Handle, ErrorRecord> {
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| BindingRecord {
                binding,
                resource: *resource,
                ..Default::default()
            })
            .collect();
        self.gpu.create_bind_group(&BindGroupDescriptor {
            label: "test group".into(),
            layout,
            entries: entries.as_slice().into(),
        })
    }

    pub fn compute(&self, shader: Handle, layouts: &[Handle]) -> Handle {
        ok(self
            .gpu
            .create_compute_pipeline(&ComputePipelineDescriptor {
                label: "test pipeline".into(),
                layouts: layouts.into(),
                immediate_size: 0,
                stage: stage(shader, "main"),
            }))
    }

    /// Runs commands and waits for them.
    pub fn run(&self, commands: Vec<Command>) -> Replay {
        let replay = self
            .try_run(commands)
            .unwrap_or_else(|error| panic!("{error}\n{}", error.detail()));
        replay.wait(PATIENCE).expect("the device works on");
        replay
    }

    pub fn try_run(&self, commands: Vec<Command>) -> Result<Replay, GpuError> {
        self.service
            .replay(self.owner, &list(commands), Timings::Off)
    }

    /// The message of commands that must be refused.
    pub fn refused(&self, commands: Vec<Command>) -> String {
        match self.try_run(commands) {
            Ok(_) => panic!("the commands were accepted"),
            Err(error) => error.to_string(),
        }
    }

    /// Reads a buffer of the plugin back, as a plugin would.
    pub fn read(&self, buffer: Handle, size: u64) -> Vec<u8> {
        let ticket = ok(self.gpu.create_ticket());
        self.run(vec![
            ReadBack {
                buffer,
                offset: 0,
                size,
                ticket,
            }
            .into(),
        ]);
        let bytes = self.poll(ticket);
        self.gpu.destroy(ticket);
        bytes
    }

    /// The bytes of a ticket whose commands were waited for.
    pub fn poll(&self, ticket: Handle) -> Vec<u8> {
        match ok(self.gpu.poll_ticket(ticket)) {
            RSome(bytes) => bytes.into_vec(),
            RNone => panic!("the commands are done, but their bytes are not there"),
        }
    }

    pub fn read_u32(&self, buffer: Handle, count: u64) -> Vec<u32> {
        bytemuck::pod_collect_to_vec(&self.read(buffer, count * 4))
    }
}

pub fn list(commands: Vec<Command>) -> CommandListRecord {
    let mut list = CommandListRecord::default();
    for command in commands {
        list.push(command);
    }
    list
}

pub fn texture_descriptor(
    format: Format,
    [width, height]: [u32; 2],
    usage: TextureUsage,
) -> TextureDescriptor<'static> {
    TextureDescriptor {
        label: "test texture".into(),
        size: [width, height, 1],
        mip_level_count: 1,
        sample_count: 1,
        dimension: Dimension::D2,
        format,
        usage,
    }
}

pub fn stage(shader: Handle, entry_point: &str) -> StageRecord<'_> {
    StageRecord {
        shader,
        entry_point: RStr::from(entry_point),
        constants: RSlice::EMPTY,
    }
}

/// A storage buffer that compute shaders write.
pub fn storage_binding(binding: u32) -> BindingLayoutRecord {
    BindingLayoutRecord {
        binding,
        visibility: ShaderStages::COMPUTE,
        kind: BindingKind::STORAGE_BUFFER,
        ..Default::default()
    }
}

#[track_caller]
pub fn ok<T>(result: RResult<T, ErrorRecord>) -> T {
    match result {
        ROk(value) => value,
        RErr(error) => panic!("{:?}: {}\n{}", error.code, error.message, error.detail),
    }
}

/// The error of what must be refused.
#[track_caller]
pub fn err<T>(result: RResult<T, ErrorRecord>) -> ErrorRecord {
    match result {
        ROk(_) => panic!("accepted, but expected to be refused"),
        RErr(error) => error,
    }
}

/// Begins a compute pass.
pub fn begin() -> Command {
    BeginComputePass {
        label: "test pass".into(),
    }
    .into()
}

/// Runs one workgroup.
pub fn dispatch() -> Command {
    Dispatch { groups: [1, 1, 1] }.into()
}

/// Reads the first row of a texture of [`SIZE`] with so many bytes a texel.
pub fn first_row(rig: &Rig, texture: Handle, bytes: u32) -> Vec<u8> {
    let row = (SIZE[0] * bytes).next_multiple_of(256);
    let size = u64::from(row * SIZE[1]);
    let rows = rig.buffer(size, BufferUsage::COPY_SRC | BufferUsage::COPY_DST);
    rig.run(vec![
        CopyTextureToBuffer {
            source: texture,
            mip_level: 0,
            origin: [0; 3],
            // All rows: WebGPU copies depth only as a whole.
            size: [SIZE[0], SIZE[1], 1],
            target: rows,
            offset: 0,
            bytes_per_row: row,
        }
        .into(),
    ]);
    rig.read(rows, u64::from(row))
}

/// The four half floats of a texel.
pub fn halves(bytes: &[u8], texel: usize) -> [f32; 4] {
    let channel = |i: usize| {
        let at = texel * 8 + i * 2;
        half::f16::from_le_bytes([bytes[at], bytes[at + 1]]).to_f32()
    };
    [channel(0), channel(1), channel(2), channel(3)]
}
