//! Making GPU resources.

use super::recorder::Recorder;
use super::resources::{
    AsHandle, BindGroup, BindGroupLayout, Buffer, ComputePipeline, RenderPipeline, Sampler, Shader,
    Texture, TextureView, Ticket,
};
use crate::abi::{
    self, BindingKind, BufferUsage, Compare, DeviceRecord, Format, Handle, SampleType, ShaderStages,
};
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

/// One binding of a layout, by kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binding {
    /// `var<uniform>`.
    Uniform,
    /// `var<uniform>` with an offset given at each use.
    UniformDynamic,
    /// `var<storage, read>`.
    StorageRead,
    /// `var<storage, read_write>`.
    Storage,
    /// `texture_2d<f32>`, filterable.
    Texture,
    /// `texture_2d<f32>` read by `textureLoad` only.
    TextureUnfilterable,
    /// `texture_depth_2d`.
    TextureDepth,
    /// `texture_2d<u32>`.
    TextureUint,
    /// `texture_storage_2d<format, write>`.
    StorageWrite(Format),
    /// `sampler`, filtering.
    Sampler,
    /// `sampler_comparison`.
    SamplerComparison,
}

/// A binding number, the stages that see it, and its kind.
pub type Layout = (u32, ShaderStages, Binding);

/// A texture to be made.
#[derive(Clone, Copy, Debug)]
pub struct TextureOptions<'a> {
    /// For messages and graphics debuggers.
    pub label: &'a str,
    /// Texels.
    pub size: [u32; 2],
    /// Layers; 1 for a plain texture.
    pub layers: u32,
    /// Mip levels; 1 for none.
    pub mip_level_count: u32,
    /// Format of the texels.
    pub format: Format,
    /// What it is used for.
    pub usage: abi::TextureUsage,
}

/// How a fragment meets what is there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Blend {
    /// Colour channels.
    pub colour: abi::BlendComponentRecord,
    /// The alpha channel.
    pub alpha: abi::BlendComponentRecord,
}

impl Blend {
    /// Source + destination, in all channels.
    pub const ADD: Self = Self::both(
        abi::BlendFactor::ONE,
        abi::BlendFactor::ONE,
        abi::BlendOperation::ADD,
    );
    /// Source over destination, premultiplied.
    pub const OVER: Self = Self::both(
        abi::BlendFactor::ONE,
        abi::BlendFactor::ONE_MINUS_SRC_ALPHA,
        abi::BlendOperation::ADD,
    );
    /// The greater of both, in all channels.
    pub const MAX: Self = Self::both(
        abi::BlendFactor::ONE,
        abi::BlendFactor::ONE,
        abi::BlendOperation::MAX,
    );

    /// The same for colour and alpha.
    pub const fn both(
        source: abi::BlendFactor,
        destination: abi::BlendFactor,
        operation: abi::BlendOperation,
    ) -> Self {
        let component = abi::BlendComponentRecord {
            source,
            destination,
            operation,
        };
        Self {
            colour: component,
            alpha: component,
        }
    }
}

/// One colour target of a render pipeline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColourTarget {
    /// The texture's format.
    pub format: Format,
    /// None: the fragment replaces.
    pub blend: Option<Blend>,
}

/// The depth test of a render pipeline. The host's depth is reversed: greater is nearer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthTest {
    /// The depth texture's format.
    pub format: Format,
    /// Whether the fragment's depth is written.
    pub writes: bool,
    /// When the fragment passes.
    pub compare: Compare,
}

impl DepthTest {
    /// Nearer wins and is written, in the host's `depth` target.
    pub const NEARER: Self = Self {
        format: Format::DEPTH32_FLOAT,
        writes: true,
        compare: Compare::GREATER,
    };
}

/// One vertex buffer of a render pipeline: stride, attributes (format, offset, location), per instance or not.
#[derive(Clone, Copy, Debug)]
pub struct VertexBuffer<'a> {
    /// Bytes from one vertex (or instance) to the next.
    pub stride: u64,
    /// Whether it advances per instance.
    pub step: abi::StepMode,
    /// The attributes.
    pub attributes: &'a [abi::VertexAttributeRecord],
}

/// A render pipeline to be made. Most fields have a default: `..RenderPipelineOptions::new(label, &shader)`.
#[derive(Clone, Copy)]
pub struct RenderPipelineOptions<'a> {
    /// For messages, timings and graphics debuggers.
    pub label: &'a str,
    /// Bind group layouts in group order.
    pub layouts: &'a [&'a BindGroupLayout],
    /// Bytes of immediate data.
    pub immediate_size: u32,
    /// The module of both stages.
    pub shader: &'a Shader,
    /// Entry point of the vertex stage.
    pub vertex: &'a str,
    /// Entry point of the fragment stage; none writes depth only.
    pub fragment: Option<&'a str>,
    /// Values of `override`s.
    pub constants: &'a [(&'a str, f64)],
    /// Vertex buffers; none for vertex pulling.
    pub vertex_buffers: &'a [VertexBuffer<'a>],
    /// How vertices make primitives.
    pub topology: abi::Topology,
    /// Which faces are dropped.
    pub cull: abi::CullMode,
    /// The depth test, if any.
    pub depth: Option<DepthTest>,
    /// The colour targets; a gap is `None`.
    pub targets: &'a [Option<ColourTarget>],
}

impl<'a> RenderPipelineOptions<'a> {
    /// Triangles without culling, depth or targets; entry points `vertex` and `fragment`.
    pub fn new(label: &'a str, shader: &'a Shader) -> Self {
        Self {
            label,
            layouts: &[],
            immediate_size: 0,
            shader,
            vertex: "vertex",
            fragment: Some("fragment"),
            constants: &[],
            vertex_buffers: &[],
            topology: abi::Topology::TRIANGLE_LIST,
            cull: abi::CullMode(0),
            depth: None,
            targets: &[],
        }
    }
}

/// A compute pipeline to be made.
#[derive(Clone, Copy)]
pub struct ComputePipelineOptions<'a> {
    /// For messages, timings and graphics debuggers.
    pub label: &'a str,
    /// Bind group layouts in group order.
    pub layouts: &'a [&'a BindGroupLayout],
    /// Bytes of immediate data.
    pub immediate_size: u32,
    /// The module.
    pub shader: &'a Shader,
    /// Its entry point.
    pub entry_point: &'a str,
    /// Values of `override`s.
    pub constants: &'a [(&'a str, f64)],
}

fn constants<'a>(pairs: &[(&'a str, f64)]) -> Vec<abi::ConstantRecord<'a>> {
    pairs
        .iter()
        .map(|&(name, value)| abi::ConstantRecord {
            name: RStr::from_str(name),
            value,
        })
        .collect()
}

fn handles(layouts: &[&BindGroupLayout]) -> Vec<Handle> {
    layouts.iter().map(|layout| layout.handle()).collect()
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

fn layout_record((binding, visibility, kind): Layout) -> abi::BindingLayoutRecord {
    let record = abi::BindingLayoutRecord {
        binding,
        visibility,
        ..Default::default()
    };
    let texture = |sample_type| abi::BindingLayoutRecord {
        kind: BindingKind::TEXTURE,
        sample_type,
        ..record
    };
    match kind {
        Binding::Uniform => abi::BindingLayoutRecord {
            kind: BindingKind::UNIFORM_BUFFER,
            ..record
        },
        Binding::UniformDynamic => abi::BindingLayoutRecord {
            kind: BindingKind::UNIFORM_BUFFER,
            dynamic_offset: 1,
            ..record
        },
        Binding::StorageRead => abi::BindingLayoutRecord {
            kind: BindingKind::STORAGE_BUFFER_READ,
            ..record
        },
        Binding::Storage => abi::BindingLayoutRecord {
            kind: BindingKind::STORAGE_BUFFER,
            ..record
        },
        Binding::Texture => texture(SampleType::FLOAT),
        Binding::TextureUnfilterable => texture(SampleType::FLOAT_UNFILTERABLE),
        Binding::TextureDepth => texture(SampleType::DEPTH),
        Binding::TextureUint => texture(SampleType::UINT),
        Binding::StorageWrite(format) => abi::BindingLayoutRecord {
            kind: BindingKind::STORAGE_TEXTURE,
            format,
            access: abi::StorageAccess::WRITE,
            ..record
        },
        Binding::Sampler => abi::BindingLayoutRecord {
            kind: BindingKind::SAMPLER,
            ..record
        },
        Binding::SamplerComparison => abi::BindingLayoutRecord {
            kind: BindingKind::SAMPLER_COMPARISON,
            ..record
        },
    }
}

fn target_record(target: Option<ColourTarget>) -> abi::ColourTargetRecord {
    let Some(ColourTarget { format, blend }) = target else {
        return abi::ColourTargetRecord::default();
    };
    let Blend { colour, alpha } = blend.unwrap_or_default();
    abi::ColourTargetRecord {
        format,
        blends: blend.is_some().into(),
        colour,
        alpha,
        write_mask: 0b1111,
    }
}

fn depth_record(test: DepthTest) -> abi::DepthRecord {
    let DepthTest {
        format,
        writes,
        compare,
    } = test;
    abi::DepthRecord {
        format,
        writes: writes.into(),
        compare,
        ..Default::default()
    }
}
