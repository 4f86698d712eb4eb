//! Descriptors of the GPU service. They mirror WebGPU's, with open numbers for enumerations and 0 for 'default'.

use super::values::{Handle, open_flags, open_number};
use abi_stable::StableAbi;
use abi_stable::std_types::{RSlice, RStr};

open_number! {
    /// Format of a texture's texels.
    Format(u32) {
        R8_UNORM = 1, RG8_UNORM = 2, RGBA8_UNORM = 3, RGBA8_UNORM_SRGB = 4, BGRA8_UNORM = 5,
        R16_FLOAT = 6, RG16_FLOAT = 7, RGBA16_FLOAT = 8,
        R32_FLOAT = 9, RG32_FLOAT = 10, RGBA32_FLOAT = 11,
        R8_UINT = 12, R16_UINT = 13, R32_UINT = 14, RG32_UINT = 15, RGBA32_UINT = 16, R32_SINT = 17,
        DEPTH32_FLOAT = 18, RGB10A2_UNORM = 19, RG11B10_FLOAT = 20,
    }
}

open_flags! {
    /// What a buffer may be used for.
    BufferUsage {
        VERTEX = 1, INDEX = 2, UNIFORM = 4, STORAGE = 8, INDIRECT = 16, COPY_SRC = 32, COPY_DST = 64,
    }
}

open_flags! {
    /// What a texture may be used for.
    TextureUsage {
        COPY_SRC = 1, COPY_DST = 2, TEXTURE_BINDING = 4, STORAGE_BINDING = 8, RENDER_ATTACHMENT = 16,
    }
}

open_flags! {
    /// Which shader stages see a binding.
    ShaderStages { VERTEX = 1, FRAGMENT = 2, COMPUTE = 4 }
}

open_number! {
    /// Dimension of a texture or of a view of one.
    Dimension(u32) { D1 = 1, D2 = 2, D2_ARRAY = 3, CUBE = 4, CUBE_ARRAY = 5, D3 = 6 }
}

open_number! {
    /// What kind of resource a binding takes.
    BindingKind(u32) {
        UNIFORM_BUFFER = 1, STORAGE_BUFFER_READ = 2, STORAGE_BUFFER = 3,
        SAMPLER = 4, SAMPLER_NON_FILTERING = 5, SAMPLER_COMPARISON = 6,
        TEXTURE = 7, STORAGE_TEXTURE = 8,
    }
}

open_number! {
    /// How a shader reads a texture.
    SampleType(u32) { FLOAT = 1, FLOAT_UNFILTERABLE = 2, DEPTH = 3, SINT = 4, UINT = 5 }
}

open_number! {
    /// How a shader uses a storage texture.
    StorageAccess(u32) { WRITE = 1, READ = 2, READ_WRITE = 3, ATOMIC = 4 }
}

open_number! {
    /// Format of a vertex attribute.
    VertexFormat(u32) {
        FLOAT32 = 1, FLOAT32X2 = 2, FLOAT32X3 = 3, FLOAT32X4 = 4, UINT32 = 5, UINT32X2 = 6, UINT32X3 = 7, UINT32X4 = 8,
        SINT32 = 9, UNORM8X4 = 10, SNORM8X4 = 11, UNORM16X2 = 12, SNORM16X2 = 13, SNORM16X4 = 14,
        FLOAT16X2 = 15, FLOAT16X4 = 16, UINT8X4 = 17, UINT16X2 = 18,
    }
}

open_number! {
    /// Per vertex or per instance.
    StepMode(u32) { VERTEX = 1, INSTANCE = 2 }
}

open_number! {
    /// How vertices make primitives.
    Topology(u32) { POINT_LIST = 1, LINE_LIST = 2, LINE_STRIP = 3, TRIANGLE_LIST = 4, TRIANGLE_STRIP = 5 }
}

open_number! {
    /// Which faces are dropped; 0 drops none.
    CullMode(u32) { FRONT = 1, BACK = 2 }
}

open_number! {
    /// Which winding faces the eye; 0 is counter-clockwise.
    FrontFace(u32) { COUNTER_CLOCKWISE = 1, CLOCKWISE = 2 }
}

open_number! {
    /// Comparison of depth tests and comparison samplers.
    Compare(u32) {
        NEVER = 1, LESS = 2, EQUAL = 3, LESS_EQUAL = 4, GREATER = 5, NOT_EQUAL = 6, GREATER_EQUAL = 7, ALWAYS = 8,
    }
}

open_number! {
    /// Factor of a blend.
    BlendFactor(u32) {
        ZERO = 1, ONE = 2, SRC = 3, ONE_MINUS_SRC = 4, SRC_ALPHA = 5, ONE_MINUS_SRC_ALPHA = 6, DST = 7,
        ONE_MINUS_DST = 8, DST_ALPHA = 9, ONE_MINUS_DST_ALPHA = 10, CONSTANT = 11, ONE_MINUS_CONSTANT = 12,
    }
}

open_number! {
    /// Operation of a blend.
    BlendOperation(u32) { ADD = 1, SUBTRACT = 2, REVERSE_SUBTRACT = 3, MIN = 4, MAX = 5 }
}

open_number! {
    /// Filter of a sampler; 0 is nearest.
    Filter(u32) { NEAREST = 1, LINEAR = 2 }
}

open_number! {
    /// What a sampler does outside the texture; 0 clamps.
    AddressMode(u32) { CLAMP_TO_EDGE = 1, REPEAT = 2, MIRROR_REPEAT = 3 }
}

/// A buffer to be made; its content is zero.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct BufferDescriptor<'a> {
    pub label: RStr<'a>,
    /// Bytes; a multiple of 4.
    pub size: u64,
    pub usage: BufferUsage,
}

/// A texture to be made; its content is zero.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct TextureDescriptor<'a> {
    pub label: RStr<'a>,
    /// Width, height, and depth or number of layers; texels.
    pub size: [u32; 3],
    pub mip_level_count: u32,
    pub sample_count: u32,
    /// [`Dimension::D1`], [`Dimension::D2`] or [`Dimension::D3`].
    pub dimension: Dimension,
    pub format: Format,
    pub usage: TextureUsage,
}

/// A view of a texture. 0 in a field means 'as the texture has it' or 'all that remain'.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct TextureViewDescriptor<'a> {
    pub label: RStr<'a>,
    pub texture: Handle,
    pub dimension: Dimension,
    pub base_mip_level: u32,
    pub mip_level_count: u32,
    pub base_layer: u32,
    pub layer_count: u32,
}

/// A sampler to be made.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct SamplerDescriptor<'a> {
    pub label: RStr<'a>,
    pub address: [AddressMode; 3],
    pub magnify: Filter,
    pub minify: Filter,
    pub mip: Filter,
    pub lod_min: f32,
    pub lod_max: f32,
    /// 0: no comparison.
    pub compare: Compare,
    /// 0 and 1: none.
    pub anisotropy: u32,
}

/// A shader module in plain WGSL.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct ShaderDescriptor<'a> {
    pub label: RStr<'a>,
    pub wgsl: RStr<'a>,
}

/// One binding of a bind group layout. Fields that the kind does not use are 0.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug, Default)]
pub struct BindingLayoutRecord {
    pub binding: u32,
    pub visibility: ShaderStages,
    pub kind: BindingKind,
    /// Buffers: 1 if an offset is given with each `SetBindGroup`.
    pub dynamic_offset: u32,
    /// Buffers: least size in bytes, 0 to check at draw time.
    pub min_size: u64,
    /// Textures.
    pub sample_type: SampleType,
    /// Textures and storage textures; 0 is [`Dimension::D2`].
    pub dimension: Dimension,
    /// Textures: 1 if multisampled.
    pub multisampled: u32,
    /// Storage textures.
    pub format: Format,
    /// Storage textures.
    pub access: StorageAccess,
}

/// A bind group layout to be made.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct BindGroupLayoutDescriptor<'a> {
    pub label: RStr<'a>,
    pub entries: RSlice<'a, BindingLayoutRecord>,
}

/// One resource of a bind group: a buffer, texture (its whole view), texture view or sampler.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug, Default)]
pub struct BindingRecord {
    pub binding: u32,
    pub resource: Handle,
    /// Buffers: bytes.
    pub offset: u64,
    /// Buffers: bytes, 0 for all that remain.
    pub size: u64,
}

/// A bind group to be made.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct BindGroupDescriptor<'a> {
    pub label: RStr<'a>,
    pub layout: Handle,
    pub entries: RSlice<'a, BindingRecord>,
}

/// A value for an `override` of a shader, by name.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct ConstantRecord<'a> {
    pub name: RStr<'a>,
    pub value: f64,
}

/// A shader stage of a pipeline. No stage: `shader` is [`Handle::NONE`].
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct StageRecord<'a> {
    pub shader: Handle,
    pub entry_point: RStr<'a>,
    pub constants: RSlice<'a, ConstantRecord<'a>>,
}

/// One attribute of a vertex buffer.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct VertexAttributeRecord {
    pub format: VertexFormat,
    pub offset: u64,
    pub location: u32,
}

/// Layout of one vertex buffer.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct VertexBufferRecord<'a> {
    pub stride: u64,
    pub step: StepMode,
    pub attributes: RSlice<'a, VertexAttributeRecord>,
}

/// `factor · source (op) factor · destination`.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug, Default, PartialEq)]
pub struct BlendComponentRecord {
    pub source: BlendFactor,
    pub destination: BlendFactor,
    pub operation: BlendOperation,
}

/// One colour target of a render pipeline.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug, Default)]
pub struct ColourTargetRecord {
    pub format: Format,
    /// 1: `colour` and `alpha` hold; 0: the fragment replaces.
    pub blends: u32,
    pub colour: BlendComponentRecord,
    pub alpha: BlendComponentRecord,
    /// Bits 1, 2, 4, 8 for red, green, blue, alpha.
    pub write_mask: u32,
}

/// Depth test of a render pipeline. No depth: `format` is 0.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug, Default)]
pub struct DepthRecord {
    pub format: Format,
    pub writes: u32,
    pub compare: Compare,
    pub bias: i32,
    pub bias_slope: f32,
    pub bias_clamp: f32,
}

/// A render pipeline to be made.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct RenderPipelineDescriptor<'a> {
    pub label: RStr<'a>,
    /// Bind group layouts, in group order.
    pub layouts: RSlice<'a, Handle>,
    /// Bytes of immediate data (push constants).
    pub immediate_size: u32,
    pub vertex: StageRecord<'a>,
    pub fragment: StageRecord<'a>,
    pub vertex_buffers: RSlice<'a, VertexBufferRecord<'a>>,
    pub topology: Topology,
    pub front_face: FrontFace,
    pub cull: CullMode,
    pub depth: DepthRecord,
    pub targets: RSlice<'a, ColourTargetRecord>,
    /// 0 and 1: no multisampling.
    pub sample_count: u32,
}

/// A compute pipeline to be made.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct ComputePipelineDescriptor<'a> {
    pub label: RStr<'a>,
    /// Bind group layouts, in group order.
    pub layouts: RSlice<'a, Handle>,
    /// Bytes of immediate data (push constants).
    pub immediate_size: u32,
    pub stage: StageRecord<'a>,
}

/// Where `write_texture` puts its data.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct TextureWriteRecord {
    pub texture: Handle,
    pub mip_level: u32,
    pub origin: [u32; 3],
    pub size: [u32; 3],
    pub bytes_per_row: u32,
    pub rows_per_image: u32,
}

/// What a plugin may know about the device.
#[repr(C)]
#[derive(StableAbi, Clone, Debug)]
pub struct DeviceRecord {
    pub name: abi_stable::std_types::RString,
    /// 'vulkan', 'gl', 'metal', 'dx12'.
    pub backend: abi_stable::std_types::RString,
    /// 1 if the adapter runs on the CPU (Mesa's lavapipe, WARP).
    pub is_software: u32,
    /// Counts the devices of this process; a new one after a loss.
    pub generation: u64,
}
