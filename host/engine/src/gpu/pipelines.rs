//! Making render and compute pipelines. Layouts are explicit: bind groups then fit every pipeline that names the layout.

use super::handles::{ComputePipelineEntry, RenderPipelineEntry, Table};
use super::service::{Caller, GpuService};
use super::{convert, features};
use crate::device::GpuError;
use pointstage_plugin_api::abi::{
    BlendComponentRecord, ColourTargetRecord, ComputePipelineDescriptor, DepthRecord, Format,
    Handle, RenderPipelineDescriptor, StageRecord, VertexBufferRecord,
};
use wgpu::naga::ShaderStage;
use wgpu::{Features, TextureFormatFeatureFlags};

/// A stage whose handle, entry point and constants were checked.
struct Stage<'d> {
    module: wgpu::ShaderModule,
    entry_point: &'d str,
    constants: Vec<(&'d str, f64)>,
}

impl<'d> Stage<'d> {
    fn check(
        table: &Table,
        caller: &Caller,
        record: &StageRecord<'d>,
        stage: ShaderStage,
    ) -> Result<Self, GpuError> {
        let entry_point = record.entry_point.as_str();
        let at_stage = |error: GpuError| error.at(format_args!("{stage:?} stage"));
        let shader = table
            .shader(caller.owner, record.shader)
            .map_err(at_stage)?;
        let at_shader = |error: GpuError| error.at(format_args!("shader '{}'", shader.label));
        let interface = &shader.interface;
        interface
            .check_entry_point(entry_point, stage)
            .map_err(at_shader)?;
        let mut constants = Vec::with_capacity(record.constants.len());
        for constant in record.constants {
            let name = constant.name.as_str();
            interface.check_constant(name).map_err(at_shader)?;
            constants.push((name, constant.value));
        }
        Ok(Self {
            module: shader.module.clone(),
            entry_point,
            constants,
        })
    }

    fn options(&self) -> wgpu::PipelineCompilationOptions<'_> {
        wgpu::PipelineCompilationOptions {
            constants: &self.constants,
            ..Default::default()
        }
    }
}

impl GpuService {
    pub(super) fn create_compute_pipeline(
        &self,
        caller: &Caller,
        descriptor: &ComputePipelineDescriptor<'_>,
    ) -> Result<Handle, GpuError> {
        // The table is not held while the driver compiles, which may take long.
        let (layouts, stage) = {
            let table = self.read();
            (
                self.layouts(&table, caller, &descriptor.layouts)?,
                Stage::check(&table, caller, &descriptor.stage, ShaderStage::Compute)?,
            )
        };
        self.check_immediates(caller, descriptor.immediate_size)?;
        let label = descriptor.label.as_str();
        let pipeline = self.gpu.scoped(|| {
            let layout = self.pipeline_layout(label, &layouts, descriptor.immediate_size);
            self.gpu
                .device
                .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: Some(label),
                    layout: Some(&layout),
                    module: &stage.module,
                    entry_point: Some(stage.entry_point),
                    compilation_options: stage.options(),
                    cache: None,
                })
        })?;
        self.insert(
            caller,
            ComputePipelineEntry {
                pipeline,
                immediate_size: descriptor.immediate_size,
            },
        )
    }

    pub(super) fn create_render_pipeline(
        &self,
        caller: &Caller,
        descriptor: &RenderPipelineDescriptor<'_>,
    ) -> Result<Handle, GpuError> {
        let (layouts, vertex, fragment) = {
            let table = self.read();
            let fragment = &descriptor.fragment;
            (
                self.layouts(&table, caller, &descriptor.layouts)?,
                Stage::check(&table, caller, &descriptor.vertex, ShaderStage::Vertex)?,
                if fragment.shader.is_some() {
                    let stage = Stage::check(&table, caller, fragment, ShaderStage::Fragment)?;
                    Some(stage)
                } else {
                    None
                },
            )
        };
        self.check_immediates(caller, descriptor.immediate_size)?;
        if fragment.is_none() && !descriptor.targets.is_empty() {
            return Err(GpuError::validation(
                "colour targets without a fragment stage; name one, or leave the targets out",
            ));
        }
        let most = self.gpu.limits.max_color_attachments as usize;
        if descriptor.targets.len() > most {
            return Err(GpuError::validation(format!(
                "{} colour targets; the device has at most {most}",
                descriptor.targets.len()
            )));
        }
        let mut targets = Vec::with_capacity(descriptor.targets.len());
        for (index, target) in descriptor.targets.iter().enumerate() {
            let target = self
                .colour_target(caller, target)
                .map_err(|error| error.at(format_args!("colour target {index}")))?;
            targets.push(Some(target));
        }
        let attributes = vertex_attributes(&descriptor.vertex_buffers)?;
        let buffers = vertex_buffers(&descriptor.vertex_buffers, &attributes)?;
        let depth_stencil = depth_state(&descriptor.depth)?;
        let primitive = wgpu::PrimitiveState {
            topology: convert::topology(descriptor.topology)?,
            front_face: convert::front_face(descriptor.front_face)?,
            cull_mode: convert::cull(descriptor.cull)?,
            ..Default::default()
        };
        let label = descriptor.label.as_str();
        let pipeline = self.gpu.scoped(|| {
            let layout = self.pipeline_layout(label, &layouts, descriptor.immediate_size);
            self.gpu
                .device
                .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                    label: Some(label),
                    layout: Some(&layout),
                    vertex: wgpu::VertexState {
                        module: &vertex.module,
                        entry_point: Some(vertex.entry_point),
                        compilation_options: vertex.options(),
                        buffers: &buffers,
                    },
                    primitive,
                    depth_stencil,
                    multisample: wgpu::MultisampleState {
                        count: descriptor.sample_count.max(1),
                        ..Default::default()
                    },
                    fragment: fragment.as_ref().map(|stage| wgpu::FragmentState {
                        module: &stage.module,
                        entry_point: Some(stage.entry_point),
                        compilation_options: stage.options(),
                        targets: &targets,
                    }),
                    multiview_mask: None,
                    cache: None,
                })
        })?;
        self.insert(
            caller,
            RenderPipelineEntry {
                pipeline,
                immediate_size: descriptor.immediate_size,
            },
        )
    }

    fn layouts(
        &self,
        table: &Table,
        caller: &Caller,
        handles: &[Handle],
    ) -> Result<Vec<wgpu::BindGroupLayout>, GpuError> {
        let most = self.gpu.limits.max_bind_groups as usize;
        if handles.len() > most {
            return Err(GpuError::validation(format!(
                "{} bind group layouts; the device has at most {most}",
                handles.len()
            )));
        }
        handles
            .iter()
            .enumerate()
            .map(
                |(group, handle)| match table.layout(caller.owner, *handle) {
                    Ok(entry) => Ok(entry.layout.clone()),
                    Err(error) => Err(error.at(format_args!("layout of group {group}"))),
                },
            )
            .collect()
    }

    fn pipeline_layout(
        &self,
        label: &str,
        layouts: &[wgpu::BindGroupLayout],
        immediate_size: u32,
    ) -> wgpu::PipelineLayout {
        let layouts: Vec<_> = layouts.iter().map(Some).collect();
        self.gpu
            .device
            .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(label),
                bind_group_layouts: &layouts,
                immediate_size,
            })
    }

    fn check_immediates(&self, caller: &Caller, size: u32) -> Result<(), GpuError> {
        if size == 0 {
            return Ok(());
        }
        let granted = caller.state.granted;
        features::require(&self.gpu, granted, Features::IMMEDIATES, "immediate data")?;
        let most = self.gpu.limits.max_immediate_size;
        if size > most || !size.is_multiple_of(4) {
            return Err(GpuError::validation(format!(
                "{size} bytes of immediate data; expected a multiple of 4 up to {most}"
            )));
        }
        Ok(())
    }

    fn colour_target(
        &self,
        caller: &Caller,
        target: &ColourTargetRecord,
    ) -> Result<wgpu::ColorTargetState, GpuError> {
        let format = convert::format(target.format)?;
        let granted = caller.state.granted;
        features::require_of_format(
            &self.gpu,
            granted,
            format,
            &format!("rendering to {:?}", target.format),
            |features| {
                features
                    .allowed_usages
                    .contains(wgpu::TextureUsages::RENDER_ATTACHMENT)
            },
        )?;
        let blend = if target.blends == 0 {
            None
        } else {
            features::require_of_format(
                &self.gpu,
                granted,
                format,
                &format!("blending into {:?}", target.format),
                |features| {
                    features
                        .flags
                        .contains(TextureFormatFeatureFlags::BLENDABLE)
                },
            )?;
            Some(wgpu::BlendState {
                color: blend_component(&target.colour)?,
                alpha: blend_component(&target.alpha)?,
            })
        };
        let Some(write_mask) = wgpu::ColorWrites::from_bits(target.write_mask) else {
            return Err(GpuError::validation(format!(
                "write mask {:#x}; expected bits 1, 2, 4, 8",
                target.write_mask
            )));
        };
        Ok(wgpu::ColorTargetState {
            format,
            blend,
            write_mask,
        })
    }
}

fn blend_component(record: &BlendComponentRecord) -> Result<wgpu::BlendComponent, GpuError> {
    Ok(wgpu::BlendComponent {
        src_factor: convert::blend_factor(record.source)?,
        dst_factor: convert::blend_factor(record.destination)?,
        operation: convert::blend_operation(record.operation)?,
    })
}

fn depth_state(record: &DepthRecord) -> Result<Option<wgpu::DepthStencilState>, GpuError> {
    if record.format == Format(0) {
        return Ok(None);
    }
    let format = convert::format(record.format)?;
    if !format.has_depth_aspect() {
        return Err(GpuError::validation(format!(
            "depth test with the format {:?}; expected a depth format",
            record.format
        )));
    }
    Ok(Some(wgpu::DepthStencilState {
        format,
        depth_write_enabled: Some(record.writes != 0),
        depth_compare: Some(convert::compare(record.compare)?),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState {
            constant: record.bias,
            slope_scale: record.bias_slope,
            clamp: record.bias_clamp,
        },
    }))
}

fn vertex_attributes(
    buffers: &[VertexBufferRecord<'_>],
) -> Result<Vec<Vec<wgpu::VertexAttribute>>, GpuError> {
    buffers
        .iter()
        .map(|buffer| {
            buffer
                .attributes
                .iter()
                .map(|attribute| {
                    Ok(wgpu::VertexAttribute {
                        format: convert::vertex_format(attribute.format)?,
                        offset: attribute.offset,
                        shader_location: attribute.location,
                    })
                })
                .collect()
        })
        .collect()
}

fn vertex_buffers<'a>(
    buffers: &[VertexBufferRecord<'_>],
    attributes: &'a [Vec<wgpu::VertexAttribute>],
) -> Result<Vec<Option<wgpu::VertexBufferLayout<'a>>>, GpuError> {
    buffers
        .iter()
        .zip(attributes)
        .map(|(buffer, attributes)| {
            Ok(Some(wgpu::VertexBufferLayout {
                array_stride: buffer.stride,
                step_mode: convert::step_mode(buffer.step)?,
                attributes,
            }))
        })
        .collect()
}
