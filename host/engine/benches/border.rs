//! What the border costs: a frame of 100 commands, recorded by a plugin, decoded, checked and replayed, against the same
//! commands issued directly into wgpu. Medians, interleaved in one run.
//!
//! `cargo bench -p pointstage-engine --bench border`

use abi_stable::std_types::{RResult, RSlice};
use pointstage_engine::device::{DeviceOptions, GpuDevice};
use pointstage_engine::gpu::{GpuService, Owner, Timings};
use pointstage_plugin_api::abi::commands::{
    BeginRenderPass, ColourAttachment, CommandListRecord, Draw, EndRenderPass, SetBindGroup,
    SetPipeline, SetScissor, SetViewport,
};
use pointstage_plugin_api::abi::{
    BindGroupDescriptor, BindGroupLayoutDescriptor, BindingKind, BindingLayoutRecord,
    BindingRecord, BufferDescriptor, BufferUsage, ColourTargetRecord, CullMode, DepthRecord,
    Dimension, ErrorRecord, Format, FrontFace, Handle, RenderPipelineDescriptor, ShaderDescriptor,
    ShaderStages, StageRecord, TextureDescriptor, TextureUsage, Topology,
};
use std::error::Error;
use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Frames of each kind, after as many tenths to warm up.
const ROUNDS: usize = 1000;
/// (pipeline, group, draw) triples in the one pass; with 4 other commands they make 100.
const DRAWS: usize = 32;
const COMMANDS: usize = DRAWS * 3 + 4;
const SIZE: u32 = 64;
const PATIENCE: Duration = Duration::from_secs(30);

const SHADER: &str = "
@group(0) @binding(0) var<storage, read> positions: array<vec4f>;
@vertex fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f { return positions[i % 4u]; }
@fragment fn fragment() -> @location(0) vec4f { return vec4f(1.0); }
";

/// The same resources twice: as handles and as wgpu's own.
struct Frame {
    service: Arc<GpuService>,
    owner: Owner,
    pipeline: Handle,
    group: Handle,
    target: Handle,
    direct_pipeline: wgpu::RenderPipeline,
    direct_group: wgpu::BindGroup,
    direct_view: wgpu::TextureView,
}

fn made<T>(result: RResult<T, ErrorRecord>) -> Result<T, Box<dyn Error>> {
    result
        .into_result()
        .map_err(|error| error.message.into_string().into())
}

impl Frame {
    fn new(device: &Arc<GpuDevice>) -> Result<Self, Box<dyn Error>> {
        let service = GpuService::new(Arc::clone(device));
        let owner = service.owner("bench", &[], 1 << 20);
        let gpu = service.object(owner);
        let layout = made(
            gpu.create_bind_group_layout(&BindGroupLayoutDescriptor {
                label: "bench".into(),
                entries: [BindingLayoutRecord {
                    binding: 0,
                    visibility: ShaderStages::VERTEX,
                    kind: BindingKind::STORAGE_BUFFER_READ,
                    ..Default::default()
                }]
                .as_slice()
                .into(),
            }),
        )?;
        let buffer = made(gpu.create_buffer(&BufferDescriptor {
            label: "bench".into(),
            size: 64,
            usage: BufferUsage::STORAGE,
        }))?;
        let group = made(
            gpu.create_bind_group(&BindGroupDescriptor {
                label: "bench".into(),
                layout,
                entries: [BindingRecord {
                    binding: 0,
                    resource: buffer,
                    ..Default::default()
                }]
                .as_slice()
                .into(),
            }),
        )?;
        let shader = made(gpu.create_shader(&ShaderDescriptor {
            label: "bench".into(),
            wgsl: SHADER.into(),
        }))?;
        let stage = |entry_point: &'static str| StageRecord {
            shader,
            entry_point: entry_point.into(),
            constants: RSlice::EMPTY,
        };
        let pipeline = made(
            gpu.create_render_pipeline(&RenderPipelineDescriptor {
                label: "bench".into(),
                layouts: [layout].as_slice().into(),
                immediate_size: 0,
                vertex: stage("vertex"),
                fragment: stage("fragment"),
                vertex_buffers: RSlice::EMPTY,
                topology: Topology::TRIANGLE_LIST,
                front_face: FrontFace(0),
                cull: CullMode(0),
                depth: DepthRecord::default(),
                targets: [ColourTargetRecord {
                    format: Format::RGBA8_UNORM,
                    write_mask: 15,
                    ..Default::default()
                }]
                .as_slice()
                .into(),
                sample_count: 1,
            }),
        )?;
        let target = made(gpu.create_texture(&TextureDescriptor {
            label: "bench".into(),
            size: [SIZE, SIZE, 1],
            mip_level_count: 1,
            sample_count: 1,
            dimension: Dimension::D2,
            format: Format::RGBA8_UNORM,
            usage: TextureUsage::RENDER_ATTACHMENT,
        }))?;
        let (direct_pipeline, direct_group, direct_view) = direct(&device.device);
        Ok(Self {
            service,
            owner,
            pipeline,
            group,
            target,
            direct_pipeline,
            direct_group,
            direct_view,
        })
    }

    /// What a plugin records.
    fn record(&self) -> CommandListRecord {
        let mut list = CommandListRecord::default();
        list.push(BeginRenderPass {
            label: "bench".into(),
            colours: vec![Some(ColourAttachment {
                target: self.target,
                resolve: Handle::NONE,
                clear: Some([0.0; 4]),
                store: true,
            })],
            depth: None,
        });
        list.push(SetViewport {
            origin: [0.0; 2],
            size: [SIZE as f32; 2],
            depth: [0.0, 1.0],
        });
        list.push(SetScissor {
            origin: [0; 2],
            size: [SIZE; 2],
        });
        for _ in 0..DRAWS {
            list.push(SetPipeline {
                pipeline: self.pipeline,
            });
            list.push(SetBindGroup {
                index: 0,
                group: self.group,
                offsets: vec![],
            });
            list.push(Draw {
                vertex_count: 3,
                instance_count: 1,
                first_vertex: 0,
                first_instance: 0,
            });
        }
        list.push(EndRenderPass {});
        list
    }

    /// The same commands, directly.
    fn encode(&self) -> wgpu::CommandBuffer {
        let device = &self.service.device().device;
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("bench"),
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("bench"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.direct_view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        pass.set_viewport(0.0, 0.0, SIZE as f32, SIZE as f32, 0.0, 1.0);
        pass.set_scissor_rect(0, 0, SIZE, SIZE);
        for _ in 0..DRAWS {
            pass.set_pipeline(&self.direct_pipeline);
            pass.set_bind_group(0, &self.direct_group, &[]);
            pass.draw(0..3, 0..1);
        }
        drop(pass);
        encoder.finish()
    }
}

fn direct(device: &wgpu::Device) -> (wgpu::RenderPipeline, wgpu::BindGroup, wgpu::TextureView) {
    let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::VERTEX,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Storage { read_only: true },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        }],
    });
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 64,
        usage: wgpu::BufferUsages::STORAGE,
        mapped_at_creation: false,
    });
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &layout,
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: buffer.as_entire_binding(),
        }],
    });
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(SHADER.into()),
    });
    let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(&layout)],
        immediate_size: 0,
    });
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: Some(&pipeline_layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(wgpu::TextureFormat::Rgba8Unorm.into())],
        }),
        multiview_mask: None,
        cache: None,
    });
    let view = device
        .create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d {
                width: SIZE,
                height: SIZE,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        })
        .create_view(&wgpu::TextureViewDescriptor::default());
    (pipeline, group, view)
}

/// The time that a share of the frames stays below; µs.
fn quantile_us(times: &[Duration], share: f64) -> f64 {
    let mut times = times.to_vec();
    times.sort_unstable();
    times[(times.len() as f64 * share) as usize].as_secs_f64() * 1e6
}

fn main() -> Result<(), Box<dyn Error>> {
    let device = match GpuDevice::open(&DeviceOptions::default()) {
        Ok(device) => device,
        Err(error) => {
            println!("skipped: {error}");
            return Ok(());
        }
    };
    println!(
        "{} ({}), {ROUNDS} rounds, times in µs",
        device.info.name,
        device.backend_name()
    );
    let frame = Frame::new(&device)?;
    let list = frame.record();
    assert_eq!(list.commands.len(), COMMANDS);
    let names = [
        "record, as a plugin does",
        "decode alone",
        "direct: encode + finish",
        "replay: decode + check + encode + finish",
        "direct: and submit",
        "replay: and submit",
    ];
    let mut times = names.map(|_| Vec::with_capacity(ROUNDS));
    for round in 0..ROUNDS + ROUNDS / 10 {
        let mut measured = [Duration::ZERO; 6];
        for (kind, time) in measured.iter_mut().enumerate() {
            // The same before each kind: whoever comes after a submission finds colder caches.
            for turn in 0..2 {
                if (turn + round) % 2 == 0 {
                    device.queue.submit([frame.encode()]);
                } else {
                    frame.service.replay(frame.owner, &list, Timings::Off)?;
                }
                device.wait_idle(PATIENCE)?;
            }
            let start = Instant::now();
            match kind {
                0 => drop(black_box(frame.record())),
                1 => assert_eq!(list.decode().flatten().count(), COMMANDS),
                2 => drop(frame.encode()),
                3 => frame.service.check(frame.owner, &list)?,
                4 => drop(device.queue.submit([frame.encode()])),
                _ => drop(frame.service.replay(frame.owner, &list, Timings::Off)?),
            }
            *time = start.elapsed();
            device.wait_idle(PATIENCE)?;
        }
        if round >= ROUNDS / 10 {
            for (times, time) in times.iter_mut().zip(measured) {
                times.push(time);
            }
        }
    }
    println!("{:>10} {:>10}", "median", "10 %");
    let quantiles = times.map(|times| [0.5, 0.1].map(|share| quantile_us(&times, share)));
    for (name, [median, tenth]) in names.iter().zip(quantiles) {
        println!("{median:10.2} {tenth:10.2}  {name}");
    }
    // On a busy machine the driver's threads interrupt this one, so the tenth says more of the cost itself.
    for (what, direct, replay) in [("", 2, 3), (", with submit", 4, 5)] {
        let [median, tenth] = [0, 1].map(|i| quantiles[replay][i] - quantiles[direct][i]);
        println!("{median:10.2} {tenth:10.2}  more than direct{what}, for {COMMANDS} commands");
        let [median, tenth] = [median + quantiles[0][0], tenth + quantiles[0][1]];
        println!("{median:10.2} {tenth:10.2}  the same with the recording");
    }
    Ok(())
}
