//! Random targets for tests: on the CPU, and the same on a device.

use half::f16;
use pointstage_plugin_api::abi::Format;

use super::cpu_targets::{CpuTargets, PlaneValues};
use super::targets::HOST_TARGETS;
use super::{Fit, GpuTarget, TargetSet, TargetSpec};
use crate::device::GpuDevice;

/// A small generator with a fixed seed: xorshift (Marsaglia 2003).
struct Random(u32);

impl Random {
    fn bits(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0
    }

    fn unit(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / (1 << 24) as f32
    }

    /// Mostly plain values, now and then one that is zero, above 1, negative or not finite.
    fn float(&mut self) -> f32 {
        match self.bits() % 16 {
            0 => 0.0,
            1 => 1.0,
            2 => 1.0 + 4.0 * self.unit(),
            3 => -self.unit(),
            4 => [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e-7][self.bits() as usize % 4],
            _ => self.unit(),
        }
    }
}

/// All the host's targets and some declared ones, more than one clearing pass takes; but for formats that the device
/// cannot draw into.
pub(super) fn specs(gpu: &GpuDevice) -> Vec<TargetSpec> {
    let declared = [
        ("curvature", Format::R32_FLOAT, [-0.5, 0.0, 0.0, 0.0]),
        ("error", Format::R16_FLOAT, [0.1, 0.0, 0.0, 0.0]),
        ("mask", Format::R8_UNORM, [0.2, 0.0, 0.0, 0.0]),
        ("albedo", Format::RGBA16_FLOAT, [0.25, 0.5, 0.75, 1.0]),
        ("part", Format::R16_UINT, [7.0, 0.0, 0.0, 0.0]),
    ];
    let declared = declared
        .map(|(key, format, clear)| TargetSpec::declared(key, format, clear, "for tests").unwrap());
    let drawable = |spec: &TargetSpec| {
        let one = core::slice::from_ref(spec);
        let fit = TargetSet::default().fit(gpu, [1, 1], one);
        if let Err(error) = &fit {
            eprintln!("skipped: {error}");
        }
        fit.is_ok()
    };
    let all = HOST_TARGETS.iter().cloned().chain(declared);
    all.filter(drawable).collect()
}

/// Planes with random values that the targets' formats hold exactly.
pub(super) fn random_planes(gpu: &GpuDevice, size_px: [u32; 2], seed: u32) -> CpuTargets {
    let mut random = Random(seed);
    let mut planes = CpuTargets::new(size_px, &specs(gpu));
    for plane in planes.planes_mut() {
        let format = plane.spec.format;
        match &mut plane.values {
            PlaneValues::Float(values) => values.iter_mut().for_each(|value| {
                // A third of the pixels stays untouched.
                if random.unit() < 0.67 {
                    *value = match format {
                        Format::DEPTH32_FLOAT => random.unit(),
                        Format::R8_UNORM => (random.bits() % 256) as f32 / 255.0,
                        Format::R32_FLOAT => random.float(),
                        _ => f16::from_f32(random.float()).to_f32(),
                    };
                } else if format == Format::R16_FLOAT {
                    *value = f16::from_f32(*value).to_f32();
                }
            }),
            PlaneValues::Uint(values) => values.iter_mut().for_each(|value| {
                if random.unit() < 0.67 {
                    *value = match format {
                        Format::R8_UINT => random.bits() % 6,
                        Format::R16_UINT => random.bits() % 300,
                        _ => random.bits(),
                    };
                }
            }),
        }
    }
    planes
}

/// The texels of a plane in the texture's format.
fn texels(format: Format, values: &PlaneValues) -> Vec<u8> {
    match values {
        PlaneValues::Float(values) => match format {
            Format::R8_UNORM => values
                .iter()
                .map(|value| (value * 255.0).round() as u8)
                .collect(),
            Format::R32_FLOAT | Format::DEPTH32_FLOAT => bytemuck::cast_slice(values).to_vec(),
            _ => values
                .iter()
                .flat_map(|value| f16::from_f32(*value).to_le_bytes())
                .collect(),
        },
        PlaneValues::Uint(values) => match format {
            Format::R8_UINT => values.iter().map(|value| *value as u8).collect(),
            Format::R16_UINT => values
                .iter()
                .flat_map(|value| (*value as u16).to_le_bytes())
                .collect(),
            _ => bytemuck::cast_slice(values).to_vec(),
        },
    }
}

fn write_texture(gpu: &GpuDevice, texture: &wgpu::Texture, texels: &[u8]) {
    gpu.queue.write_texture(
        texture.as_image_copy(),
        texels,
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(texels.len() as u32 / texture.height()),
            rows_per_image: None,
        },
        texture.size(),
    );
}

/// Depth textures cannot be written to; this draws one from floats.
fn draw_depth(gpu: &GpuDevice, target: &GpuTarget, texels: &[u8]) {
    let size = target.texture.size();
    let source = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("depths"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    write_texture(gpu, &source, texels);
    let module = gpu
        .device
        .create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("draw depth"),
            source: wgpu::ShaderSource::Wgsl(
                "@group(0) @binding(0) var depths: texture_2d<f32>;
             @vertex fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
                 return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
             }
             @fragment fn depth(@builtin(position) p: vec4f) -> @builtin(frag_depth) f32 {
                 return textureLoad(depths, vec2u(p.xy), 0).x;
             }"
                .into(),
            ),
        });
    let layout = gpu
        .device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::FRAGMENT,
                ty: wgpu::BindingType::Texture {
                    sample_type: wgpu::TextureSampleType::Float { filterable: false },
                    view_dimension: wgpu::TextureViewDimension::D2,
                    multisampled: false,
                },
                count: None,
            }],
        });
    let pipeline_layout = gpu
        .device
        .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
    let pipeline = gpu
        .device
        .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("draw depth"),
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("corner"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: wgpu::TextureFormat::Depth32Float,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Always),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("depth"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[],
            }),
            multiview_mask: None,
            cache: None,
        });
    let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &layout,
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::TextureView(
                &source.create_view(&wgpu::TextureViewDescriptor::default()),
            ),
        }],
    });
    let mut encoder = gpu
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("draw depth"),
        color_attachments: &[],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &target.view,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(0.0),
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        }),
        ..Default::default()
    });
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.draw(0..3, 0..1);
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
}

/// The same values on the device.
pub(super) fn upload(gpu: &GpuDevice, planes: &CpuTargets) -> TargetSet {
    let mut targets = TargetSet::default();
    let fit = targets.fit(gpu, planes.size_px(), &specs(gpu)).unwrap();
    assert_eq!(fit, Fit::Changed);
    for plane in planes.planes() {
        let target = targets.get(&plane.spec.key).unwrap();
        let texels = texels(plane.spec.format, &plane.values);
        if plane.spec.format == Format::DEPTH32_FLOAT {
            draw_depth(gpu, target, &texels);
        } else {
            write_texture(gpu, &target.texture, &texels);
        }
    }
    targets
}
