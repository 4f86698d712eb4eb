//! Making GPU resources.

use super::options::{
    ComputePipelineOptions, Layout, RenderPipelineOptions, TextureOptions, constants, depth_record,
    handles, layout_record, target_record,
};
use super::recorder::Recorder;
use super::resources::{
    AsHandle, BindGroup, BindGroupLayout, Buffer, ComputePipeline, RenderPipeline, Sampler, Shader,
    Texture, TextureView, Ticket,
};
use crate::abi::{self, BufferUsage, DeviceRecord, Handle};
use crate::error::{Result, from_border};
use abi_stable::std_types::{RSlice, RStr};
use bytemuck::NoUninit;
use std::sync::Arc;
use std::time::Duration;

/// The GPU service. Cheap to clone; any thread.
#[derive(Clone)]
pub struct Gpu {
    object: Arc<abi::GpuRef>,
}

impl Gpu {
    pub(crate) fn new(object: abi::GpuRef) -> Self {
        Self {
            object: Arc::new(object),
        }
    }

    /// Name, backend and kind of the device.
    pub fn device(&self) -> DeviceRecord {
        self.object.device()
    }

    /// Whether the device runs on the CPU, where compute rasterises faster than the raster pipeline.
    pub fn is_software(&self) -> bool {
        self.device().is_software != 0
    }

    /// A limit by its wgpu name, such as `max_storage_buffer_binding_size`.
    pub fn limit(&self, name: &str) -> Option<u64> {
        self.object.limit(RStr::from_str(name)).into_option()
    }

    /// Whether an optional feature was granted: the manifest asks for it and the device has it.
    pub fn has_feature(&self, name: &str) -> bool {
        self.object.feature(RStr::from_str(name)) != 0
    }

    /// Layout of group 0, which every frame brings: frame and draw.
    pub fn frame_layout(&self) -> Result<BindGroupLayout> {
        from_border(self.object.standard_layout(0)).map(BindGroupLayout::lent)
    }

    /// Layout of group 1, which every draw brings: the columns.
    pub fn columns_layout(&self) -> Result<BindGroupLayout> {
        from_border(self.object.standard_layout(1)).map(BindGroupLayout::lent)
    }

    /// A buffer of zeros; `size` in bytes, rounded up to a multiple of 4.
    pub fn buffer(&self, label: &str, size: u64, usage: BufferUsage) -> Result<Buffer> {
        let size = size.next_multiple_of(4);
        let descriptor = abi::BufferDescriptor {
            label: RStr::from_str(label),
            size,
            usage,
        };
        from_border(self.object.create_buffer(&descriptor)).map(|handle| Buffer::own(handle, self))
    }

    /// A buffer with content.
    pub fn buffer_with<T: NoUninit>(
        &self,
        label: &str,
        usage: BufferUsage,
        content: &[T],
    ) -> Result<Buffer> {
        let bytes: &[u8] = bytemuck::cast_slice(content);
        let buffer = self.buffer(
            label,
            bytes.len().max(4) as u64,
            usage | BufferUsage::COPY_DST,
        )?;
        self.write(&buffer, 0, content)?;
        Ok(buffer)
    }

    /// Writes to a buffer before anything submitted or recorded later runs. `offset` in bytes.
    pub fn write<T: NoUninit>(&self, buffer: &Buffer, offset: u64, content: &[T]) -> Result<()> {
        let bytes = RSlice::from_slice(bytemuck::cast_slice(content));
        from_border(self.object.write_buffer(buffer.handle(), offset, bytes))
    }

    /// A 2D texture of zeros.
    pub fn texture(&self, options: &TextureOptions<'_>) -> Result<Texture> {
        let [width, height] = options.size;
        let descriptor = abi::TextureDescriptor {
            label: RStr::from_str(options.label),
            size: [width, height, options.layers.max(1)],
            mip_level_count: options.mip_level_count.max(1),
            sample_count: 1,
            dimension: abi::Dimension::D2,
            format: options.format,
            usage: options.usage,
        };
        self.texture_from(&descriptor)
    }

    /// A texture of any dimension.
    pub fn texture_from(&self, descriptor: &abi::TextureDescriptor<'_>) -> Result<Texture> {
        from_border(self.object.create_texture(descriptor)).map(|handle| Texture::own(handle, self))
    }

    /// Writes texels to a texture.
    pub fn write_texture(&self, target: &abi::TextureWriteRecord, bytes: &[u8]) -> Result<()> {
        from_border(self.object.write_texture(target, RSlice::from_slice(bytes)))
    }

    /// A view of one mip level of a texture.
    pub fn mip_view(&self, label: &str, texture: &Texture, level: u32) -> Result<TextureView> {
        self.view(&abi::TextureViewDescriptor {
            label: RStr::from_str(label),
            texture: texture.handle(),
            dimension: abi::Dimension(0),
            base_mip_level: level,
            mip_level_count: 1,
            base_layer: 0,
            layer_count: 0,
        })
    }

    /// Any view of a texture.
    pub fn view(&self, descriptor: &abi::TextureViewDescriptor<'_>) -> Result<TextureView> {
        from_border(self.object.create_texture_view(descriptor))
            .map(|handle| TextureView::own(handle, self))
    }

    /// A sampler.
    pub fn sampler(&self, descriptor: &abi::SamplerDescriptor<'_>) -> Result<Sampler> {
        from_border(self.object.create_sampler(descriptor)).map(|handle| Sampler::own(handle, self))
    }

    /// A shader module in plain WGSL; [`crate::wgsl`] links the shared library into it first.
    ///
    /// # Errors
    /// The compiler's message, with line, column and source line.
    pub fn shader(&self, label: &str, wgsl: &str) -> Result<Shader> {
        let descriptor = abi::ShaderDescriptor {
            label: RStr::from_str(label),
            wgsl: RStr::from_str(wgsl),
        };
        from_border(self.object.create_shader(&descriptor)).map(|handle| Shader::own(handle, self))
    }

    /// A bind group layout.
    pub fn bind_group_layout(&self, label: &str, entries: &[Layout]) -> Result<BindGroupLayout> {
        let entries: Vec<_> = entries.iter().map(|&entry| layout_record(entry)).collect();
        let entries = RSlice::from_slice(&entries);
        let descriptor = abi::BindGroupLayoutDescriptor {
            label: RStr::from_str(label),
            entries,
        };
        from_border(self.object.create_bind_group_layout(&descriptor))
            .map(|handle| BindGroupLayout::own(handle, self))
    }

    /// A bind group of whole buffers, textures, views and samplers, by binding number.
    pub fn bind_group(
        &self,
        label: &str,
        layout: &BindGroupLayout,
        entries: &[(u32, &dyn AsHandle)],
    ) -> Result<BindGroup> {
        let entries: Vec<_> = entries
            .iter()
            .map(|&(binding, resource)| abi::BindingRecord {
                binding,
                resource: resource.as_handle(),
                ..Default::default()
            })
            .collect();
        let descriptor = abi::BindGroupDescriptor {
            label: RStr::from_str(label),
            layout: layout.handle(),
            entries: RSlice::from_slice(&entries),
        };
        self.bind_group_from(&descriptor)
    }

    /// A bind group with ranges of buffers.
    pub fn bind_group_from(&self, descriptor: &abi::BindGroupDescriptor<'_>) -> Result<BindGroup> {
        from_border(self.object.create_bind_group(descriptor))
            .map(|handle| BindGroup::own(handle, self))
    }

    /// A render pipeline.
    pub fn render_pipeline(&self, options: &RenderPipelineOptions<'_>) -> Result<RenderPipeline> {
        let layouts = handles(options.layouts);
        let constants = constants(options.constants);
        let stage = |entry_point| abi::StageRecord {
            shader: options.shader.handle(),
            entry_point: RStr::from_str(entry_point),
            constants: RSlice::from_slice(&constants),
        };
        let vertex_buffers: Vec<_> = options
            .vertex_buffers
            .iter()
            .map(|buffer| abi::VertexBufferRecord {
                stride: buffer.stride,
                step: buffer.step,
                attributes: RSlice::from_slice(buffer.attributes),
            })
            .collect();
        let targets: Vec<_> = options
            .targets
            .iter()
            .map(|target| target_record(*target))
            .collect();
        let no_stage = abi::StageRecord {
            shader: Handle::NONE,
            entry_point: RStr::from_str(""),
            constants: RSlice::EMPTY,
        };
        let descriptor = abi::RenderPipelineDescriptor {
            label: RStr::from_str(options.label),
            layouts: RSlice::from_slice(&layouts),
            immediate_size: options.immediate_size,
            vertex: stage(options.vertex),
            fragment: options.fragment.map_or(no_stage, stage),
            vertex_buffers: RSlice::from_slice(&vertex_buffers),
            topology: options.topology,
            front_face: abi::FrontFace(0),
            cull: options.cull,
            depth: options.depth.map(depth_record).unwrap_or_default(),
            targets: RSlice::from_slice(&targets),
            sample_count: 1,
        };
        from_border(self.object.create_render_pipeline(&descriptor))
            .map(|handle| RenderPipeline::own(handle, self))
    }

    /// A compute pipeline.
    pub fn compute_pipeline(
        &self,
        options: &ComputePipelineOptions<'_>,
    ) -> Result<ComputePipeline> {
        let layouts = handles(options.layouts);
        let constants = constants(options.constants);
        let descriptor = abi::ComputePipelineDescriptor {
            label: RStr::from_str(options.label),
            layouts: RSlice::from_slice(&layouts),
            immediate_size: options.immediate_size,
            stage: abi::StageRecord {
                shader: options.shader.handle(),
                entry_point: RStr::from_str(options.entry_point),
                constants: RSlice::from_slice(&constants),
            },
        };
        from_border(self.object.create_compute_pipeline(&descriptor))
            .map(|handle| ComputePipeline::own(handle, self))
    }

    /// Runs recorded commands now. Only in `prepare`; a frame's commands go to [`crate::Frame::submit`].
    pub fn submit(&self, commands: Recorder) -> Result<()> {
        from_border(self.object.submit(&commands.into_record()))
    }

    /// A ticket for one [`Recorder::read_back`].
    pub fn ticket(&self) -> Result<Ticket> {
        from_border(self.object.create_ticket()).map(|handle| Ticket::own(handle, self))
    }

    pub(super) fn poll(&self, ticket: &Ticket) -> Result<Option<Vec<u8>>> {
        let bytes = from_border(self.object.poll_ticket(ticket.handle()))?;
        Ok(bytes.into_option().map(Into::into))
    }

    /// Waits for a ticket. Only in `prepare`, never while a frame is drawn.
    pub fn wait(&self, ticket: &Ticket, progress: &crate::Progress<'_>) -> Result<Vec<u8>> {
        loop {
            if let Some(bytes) = self.poll(ticket)? {
                return Ok(bytes);
            }
            progress.check()?;
            std::thread::sleep(Duration::from_micros(200));
        }
    }

    pub(super) fn destroy(&self, handle: Handle) {
        self.object.destroy(handle);
    }
}
