//! The border's open numbers as wgpu's enumerations. What this host does not know is an error, never a guess.

use crate::device::GpuError;
use pointstage_plugin_api::abi;
use wgpu::TextureFormat as F;

/// A number that this host does not know.
fn unknown(what: &str, number: u32) -> GpuError {
    GpuError::Unsupported(format!(
        "{what} {number} is not known to this host; update the host, or choose another"
    ))
}

/// Declares conversions: open number, wgpu type, name for messages, and the pairs. `default` stands for 0.
macro_rules! conversions {
    ($($(#[$meta:meta])* $name:ident: $abi:ident -> $wgpu:ty, $what:literal $(, default $default:ident)? {
        $($from:ident => $to:expr),* $(,)?
    })*) => {
        $($(#[$meta])* pub(super) fn $name(value: abi::$abi) -> Result<$wgpu, GpuError> {
            $(let value = if value == abi::$abi(0) { abi::$abi::$default } else { value };)?
            Ok(match value {
                $(abi::$abi::$from => $to,)*
                abi::$abi(number) => return Err(unknown($what, number)),
            })
        })*
    };
}

conversions! {
    /// Texel format.
    format: Format -> F, "texture format" {
        R8_UNORM => F::R8Unorm, RG8_UNORM => F::Rg8Unorm, RGBA8_UNORM => F::Rgba8Unorm,
        RGBA8_UNORM_SRGB => F::Rgba8UnormSrgb, BGRA8_UNORM => F::Bgra8Unorm,
        R16_FLOAT => F::R16Float, RG16_FLOAT => F::Rg16Float, RGBA16_FLOAT => F::Rgba16Float,
        R32_FLOAT => F::R32Float, RG32_FLOAT => F::Rg32Float, RGBA32_FLOAT => F::Rgba32Float,
        R8_UINT => F::R8Uint, R16_UINT => F::R16Uint, R32_UINT => F::R32Uint, RG32_UINT => F::Rg32Uint,
        RGBA32_UINT => F::Rgba32Uint, R32_SINT => F::R32Sint, DEPTH32_FLOAT => F::Depth32Float,
        RGB10A2_UNORM => F::Rgb10a2Unorm, RG11B10_FLOAT => F::Rg11b10Ufloat,
    }
    /// Dimension of a texture.
    texture_dimension: Dimension -> wgpu::TextureDimension, "texture dimension", default D2 {
        D1 => wgpu::TextureDimension::D1, D2 => wgpu::TextureDimension::D2, D3 => wgpu::TextureDimension::D3,
    }
    /// Dimension of a view.
    view_dimension: Dimension -> wgpu::TextureViewDimension, "view dimension", default D2 {
        D1 => wgpu::TextureViewDimension::D1, D2 => wgpu::TextureViewDimension::D2,
        D2_ARRAY => wgpu::TextureViewDimension::D2Array, CUBE => wgpu::TextureViewDimension::Cube,
        CUBE_ARRAY => wgpu::TextureViewDimension::CubeArray, D3 => wgpu::TextureViewDimension::D3,
    }
    /// How a shader reads a texture.
    sample_type: SampleType -> wgpu::TextureSampleType, "sample type", default FLOAT {
        FLOAT => wgpu::TextureSampleType::Float { filterable: true },
        FLOAT_UNFILTERABLE => wgpu::TextureSampleType::Float { filterable: false },
        DEPTH => wgpu::TextureSampleType::Depth, SINT => wgpu::TextureSampleType::Sint,
        UINT => wgpu::TextureSampleType::Uint,
    }
    /// How a shader uses a storage texture.
    storage_access: StorageAccess -> wgpu::StorageTextureAccess, "storage access", default WRITE {
        WRITE => wgpu::StorageTextureAccess::WriteOnly, READ => wgpu::StorageTextureAccess::ReadOnly,
        READ_WRITE => wgpu::StorageTextureAccess::ReadWrite, ATOMIC => wgpu::StorageTextureAccess::Atomic,
    }
    /// Format of a vertex attribute.
    vertex_format: VertexFormat -> wgpu::VertexFormat, "vertex format" {
        FLOAT32 => wgpu::VertexFormat::Float32, FLOAT32X2 => wgpu::VertexFormat::Float32x2,
        FLOAT32X3 => wgpu::VertexFormat::Float32x3, FLOAT32X4 => wgpu::VertexFormat::Float32x4,
        UINT32 => wgpu::VertexFormat::Uint32, UINT32X2 => wgpu::VertexFormat::Uint32x2,
        UINT32X3 => wgpu::VertexFormat::Uint32x3, UINT32X4 => wgpu::VertexFormat::Uint32x4,
        SINT32 => wgpu::VertexFormat::Sint32, UNORM8X4 => wgpu::VertexFormat::Unorm8x4,
        SNORM8X4 => wgpu::VertexFormat::Snorm8x4, UNORM16X2 => wgpu::VertexFormat::Unorm16x2,
        SNORM16X2 => wgpu::VertexFormat::Snorm16x2, SNORM16X4 => wgpu::VertexFormat::Snorm16x4,
        FLOAT16X2 => wgpu::VertexFormat::Float16x2, FLOAT16X4 => wgpu::VertexFormat::Float16x4,
        UINT8X4 => wgpu::VertexFormat::Uint8x4, UINT16X2 => wgpu::VertexFormat::Uint16x2,
    }
    /// Per vertex or per instance.
    step_mode: StepMode -> wgpu::VertexStepMode, "step mode", default VERTEX {
        VERTEX => wgpu::VertexStepMode::Vertex, INSTANCE => wgpu::VertexStepMode::Instance,
    }
    /// How vertices make primitives.
    topology: Topology -> wgpu::PrimitiveTopology, "topology", default TRIANGLE_LIST {
        POINT_LIST => wgpu::PrimitiveTopology::PointList, LINE_LIST => wgpu::PrimitiveTopology::LineList,
        LINE_STRIP => wgpu::PrimitiveTopology::LineStrip, TRIANGLE_LIST => wgpu::PrimitiveTopology::TriangleList,
        TRIANGLE_STRIP => wgpu::PrimitiveTopology::TriangleStrip,
    }
    /// Which winding faces the eye.
    front_face: FrontFace -> wgpu::FrontFace, "front face", default COUNTER_CLOCKWISE {
        COUNTER_CLOCKWISE => wgpu::FrontFace::Ccw, CLOCKWISE => wgpu::FrontFace::Cw,
    }
    /// Comparison.
    compare: Compare -> wgpu::CompareFunction, "comparison", default ALWAYS {
        NEVER => wgpu::CompareFunction::Never, LESS => wgpu::CompareFunction::Less,
        EQUAL => wgpu::CompareFunction::Equal, LESS_EQUAL => wgpu::CompareFunction::LessEqual,
        GREATER => wgpu::CompareFunction::Greater, NOT_EQUAL => wgpu::CompareFunction::NotEqual,
        GREATER_EQUAL => wgpu::CompareFunction::GreaterEqual, ALWAYS => wgpu::CompareFunction::Always,
    }
    /// Factor of a blend.
    blend_factor: BlendFactor -> wgpu::BlendFactor, "blend factor" {
        ZERO => wgpu::BlendFactor::Zero, ONE => wgpu::BlendFactor::One, SRC => wgpu::BlendFactor::Src,
        ONE_MINUS_SRC => wgpu::BlendFactor::OneMinusSrc, SRC_ALPHA => wgpu::BlendFactor::SrcAlpha,
        ONE_MINUS_SRC_ALPHA => wgpu::BlendFactor::OneMinusSrcAlpha, DST => wgpu::BlendFactor::Dst,
        ONE_MINUS_DST => wgpu::BlendFactor::OneMinusDst, DST_ALPHA => wgpu::BlendFactor::DstAlpha,
        ONE_MINUS_DST_ALPHA => wgpu::BlendFactor::OneMinusDstAlpha, CONSTANT => wgpu::BlendFactor::Constant,
        ONE_MINUS_CONSTANT => wgpu::BlendFactor::OneMinusConstant,
    }
    /// Operation of a blend.
    blend_operation: BlendOperation -> wgpu::BlendOperation, "blend operation", default ADD {
        ADD => wgpu::BlendOperation::Add, SUBTRACT => wgpu::BlendOperation::Subtract,
        REVERSE_SUBTRACT => wgpu::BlendOperation::ReverseSubtract, MIN => wgpu::BlendOperation::Min,
        MAX => wgpu::BlendOperation::Max,
    }
    /// Filter within a mip level.
    filter: Filter -> wgpu::FilterMode, "filter", default NEAREST {
        NEAREST => wgpu::FilterMode::Nearest, LINEAR => wgpu::FilterMode::Linear,
    }
    /// Filter between mip levels.
    mip_filter: Filter -> wgpu::MipmapFilterMode, "filter", default NEAREST {
        NEAREST => wgpu::MipmapFilterMode::Nearest, LINEAR => wgpu::MipmapFilterMode::Linear,
    }
    /// What lies outside the texture.
    address_mode: AddressMode -> wgpu::AddressMode, "address mode", default CLAMP_TO_EDGE {
        CLAMP_TO_EDGE => wgpu::AddressMode::ClampToEdge, REPEAT => wgpu::AddressMode::Repeat,
        MIRROR_REPEAT => wgpu::AddressMode::MirrorRepeat,
    }
}

/// Which faces are dropped; 0 drops none.
pub(super) fn cull(value: abi::CullMode) -> Result<Option<wgpu::Face>, GpuError> {
    match value {
        abi::CullMode(0) => Ok(None),
        abi::CullMode::FRONT => Ok(Some(wgpu::Face::Front)),
        abi::CullMode::BACK => Ok(Some(wgpu::Face::Back)),
        abi::CullMode(number) => Err(unknown("cull mode", number)),
    }
}

/// Bits that are set but not among `known`, as an error.
fn check_bits(what: &str, bits: u32, known: u32) -> Result<(), GpuError> {
    match bits & !known {
        0 => Ok(()),
        extra => Err(unknown(what, extra)),
    }
}

/// What a buffer may be used for: the border's word and wgpu's.
const BUFFER_USAGES: [(abi::BufferUsage, wgpu::BufferUsages); 7] = [
    (abi::BufferUsage::VERTEX, wgpu::BufferUsages::VERTEX),
    (abi::BufferUsage::INDEX, wgpu::BufferUsages::INDEX),
    (abi::BufferUsage::UNIFORM, wgpu::BufferUsages::UNIFORM),
    (abi::BufferUsage::STORAGE, wgpu::BufferUsages::STORAGE),
    (abi::BufferUsage::INDIRECT, wgpu::BufferUsages::INDIRECT),
    (abi::BufferUsage::COPY_SRC, wgpu::BufferUsages::COPY_SRC),
    (abi::BufferUsage::COPY_DST, wgpu::BufferUsages::COPY_DST),
];

pub(super) fn buffer_usage(value: abi::BufferUsage) -> Result<wgpu::BufferUsages, GpuError> {
    let pairs = BUFFER_USAGES;
    check_bits(
        "buffer usage",
        value.0,
        pairs.iter().fold(0, |bits, (usage, _)| bits | usage.0),
    )?;
    Ok(pairs
        .into_iter()
        .filter(|(usage, _)| value.contains(*usage))
        .map(|(_, usage)| usage)
        .collect())
}

/// The same backwards, for imported buffers; what the border has no word for is left out.
pub(super) fn buffer_usage_from_wgpu(value: wgpu::BufferUsages) -> abi::BufferUsage {
    BUFFER_USAGES
        .into_iter()
        .filter(|(_, usage)| value.contains(*usage))
        .fold(abi::BufferUsage::NONE, |usages, (usage, _)| usages | usage)
}

pub(super) fn texture_usage(value: abi::TextureUsage) -> Result<wgpu::TextureUsages, GpuError> {
    use abi::TextureUsage as U;
    let pairs = [
        (U::COPY_SRC, wgpu::TextureUsages::COPY_SRC),
        (U::COPY_DST, wgpu::TextureUsages::COPY_DST),
        (U::TEXTURE_BINDING, wgpu::TextureUsages::TEXTURE_BINDING),
        (U::STORAGE_BINDING, wgpu::TextureUsages::STORAGE_BINDING),
        (U::RENDER_ATTACHMENT, wgpu::TextureUsages::RENDER_ATTACHMENT),
    ];
    check_bits(
        "texture usage",
        value.0,
        pairs.iter().fold(0, |bits, (usage, _)| bits | usage.0),
    )?;
    Ok(pairs
        .into_iter()
        .filter(|(usage, _)| value.contains(*usage))
        .map(|(_, usage)| usage)
        .collect())
}

pub(super) fn stages(value: abi::ShaderStages) -> Result<wgpu::ShaderStages, GpuError> {
    use abi::ShaderStages as S;
    check_bits("shader stages", value.0, 7)?;
    let mut stages = wgpu::ShaderStages::NONE;
    stages.set(wgpu::ShaderStages::VERTEX, value.contains(S::VERTEX));
    stages.set(wgpu::ShaderStages::FRAGMENT, value.contains(S::FRAGMENT));
    stages.set(wgpu::ShaderStages::COMPUTE, value.contains(S::COMPUTE));
    Ok(stages)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_that_the_border_names_is_converted() {
        for number in 0..200 {
            let named = abi::Format(number).name().is_some();
            assert_eq!(
                format(abi::Format(number)).is_ok(),
                named,
                "format {number}"
            );
            let named = abi::VertexFormat(number).name().is_some();
            assert_eq!(
                vertex_format(abi::VertexFormat(number)).is_ok(),
                named,
                "vertex format {number}"
            );
            let named = abi::BlendFactor(number).name().is_some();
            assert_eq!(
                blend_factor(abi::BlendFactor(number)).is_ok(),
                named,
                "blend factor {number}"
            );
            // 0 is 'default' for these.
            let named = number == 0 || abi::Compare(number).name().is_some();
            assert_eq!(
                compare(abi::Compare(number)).is_ok(),
                named,
                "compare {number}"
            );
            let named = number == 0 || abi::Topology(number).name().is_some();
            assert_eq!(
                topology(abi::Topology(number)).is_ok(),
                named,
                "topology {number}"
            );
        }
    }

    #[test]
    fn an_unknown_number_is_named() {
        let error = format(abi::Format(999)).expect_err("no such format");
        assert!(error.to_string().contains("texture format 999"), "{error}");
        assert!(buffer_usage(abi::BufferUsage(1 << 20)).is_err());
    }

    #[test]
    fn usages_survive_the_round_trip() {
        for bits in 0..128 {
            let usage = abi::BufferUsage(bits);
            assert_eq!(buffer_usage_from_wgpu(buffer_usage(usage).unwrap()), usage);
        }
    }
}
