//! What GPU resources are made of, and the same as records of the border.

use super::resources::{BindGroupLayout, Shader};
use crate::abi::{self, BindingKind, Compare, Format, Handle, SampleType, ShaderStages};
use abi_stable::std_types::RStr;

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

/// Values of `override`s in the border's words.
pub(super) fn constants<'a>(pairs: &[(&'a str, f64)]) -> Vec<abi::ConstantRecord<'a>> {
    pairs
        .iter()
        .map(|&(name, value)| abi::ConstantRecord {
            name: RStr::from_str(name),
            value,
        })
        .collect()
}

/// Handles of layouts, in their order.
pub(super) fn handles(layouts: &[&BindGroupLayout]) -> Vec<Handle> {
    layouts.iter().map(|layout| layout.handle()).collect()
}

/// A binding of a layout in the border's words.
pub(super) fn layout_record((binding, visibility, kind): Layout) -> abi::BindingLayoutRecord {
    let of_kind = |kind| abi::BindingLayoutRecord {
        binding,
        visibility,
        kind,
        ..Default::default()
    };
    let texture = |sample_type| abi::BindingLayoutRecord {
        sample_type,
        ..of_kind(BindingKind::TEXTURE)
    };
    match kind {
        Binding::Uniform => of_kind(BindingKind::UNIFORM_BUFFER),
        Binding::UniformDynamic => abi::BindingLayoutRecord {
            dynamic_offset: 1,
            ..of_kind(BindingKind::UNIFORM_BUFFER)
        },
        Binding::StorageRead => of_kind(BindingKind::STORAGE_BUFFER_READ),
        Binding::Storage => of_kind(BindingKind::STORAGE_BUFFER),
        Binding::Texture => texture(SampleType::FLOAT),
        Binding::TextureUnfilterable => texture(SampleType::FLOAT_UNFILTERABLE),
        Binding::TextureDepth => texture(SampleType::DEPTH),
        Binding::TextureUint => texture(SampleType::UINT),
        Binding::StorageWrite(format) => abi::BindingLayoutRecord {
            format,
            access: abi::StorageAccess::WRITE,
            ..of_kind(BindingKind::STORAGE_TEXTURE)
        },
        Binding::Sampler => of_kind(BindingKind::SAMPLER),
        Binding::SamplerComparison => of_kind(BindingKind::SAMPLER_COMPARISON),
    }
}

/// A colour target, or a gap, in the border's words.
pub(super) fn target_record(target: Option<ColourTarget>) -> abi::ColourTargetRecord {
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

/// A depth test in the border's words.
pub(super) fn depth_record(test: DepthTest) -> abi::DepthRecord {
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
