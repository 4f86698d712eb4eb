//! Optional features by name: which exist, which a shader needs, and what to say when one was not granted.

use crate::device::{GpuDevice, GpuError};
use std::str::FromStr as _;
use wgpu::naga::valid::Capabilities as Caps;
use wgpu::{DownlevelFlags, Features, TextureFormat, TextureFormatFeatures};

/// The feature of this kebab-case name, with or without wgpu's prefix ('shader-int64', 'wgpu-shader-int64').
pub(crate) fn by_name(name: &str) -> Option<Features> {
    Features::from_str(name)
        .or_else(|()| Features::from_str(&format!("wgpu-{name}")))
        .ok()
}

/// The name as manifests have it: kebab-case, without wgpu's prefix.
fn name(feature: Features) -> &'static str {
    let name = feature.as_str().unwrap_or("unknown");
    name.strip_prefix("wgpu-").unwrap_or(name)
}

/// Refuses what needs a feature that the manifest does not ask for, or that the device lacks.
pub(super) fn require(
    gpu: &GpuDevice,
    granted: Features,
    feature: Features,
    what: &str,
) -> Result<(), GpuError> {
    if granted.contains(feature) {
        return Ok(());
    }
    Err(GpuError::Unsupported(refusal(gpu, feature, what)))
}

/// '`what` needs the feature …', and what to do about it.
pub(super) fn refusal(gpu: &GpuDevice, feature: Features, what: &str) -> String {
    let name = name(feature);
    if gpu.features.contains(feature) {
        format!("{what} needs the feature '{name}'; ask for it in needs.features of the manifest")
    } else {
        format!(
            "{what} needs the feature '{name}', which the device '{}' lacks; do without it there",
            gpu.info.name
        )
    }
}

/// What textures of a format may be used for by someone with these features.
pub(super) fn of_format(
    gpu: &GpuDevice,
    granted: Features,
    format: TextureFormat,
) -> TextureFormatFeatures {
    let mut features = format.guaranteed_format_features(granted);
    if granted.contains(Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES) {
        let of_adapter = gpu.format_features(format);
        features.allowed_usages |= of_adapter.allowed_usages;
        features.flags |= of_adapter.flags;
    }
    features
}

/// Refuses a use of a format, and names the feature that would allow it, if any does on this device.
pub(super) fn require_of_format(
    gpu: &GpuDevice,
    granted: Features,
    format: TextureFormat,
    what: &str,
    allows: impl Fn(TextureFormatFeatures) -> bool,
) -> Result<(), GpuError> {
    if allows(of_format(gpu, granted, format)) {
        return Ok(());
    }
    let candidates = [
        Features::FLOAT32_BLENDABLE,
        Features::FLOAT32_FILTERABLE,
        Features::RG11B10UFLOAT_RENDERABLE,
        Features::BGRA8UNORM_STORAGE,
        Features::TEXTURE_ATOMIC,
        Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES,
    ];
    let missing = candidates
        .into_iter()
        .filter(|feature| gpu.features.contains(*feature))
        .find(|feature| allows(of_format(gpu, granted | *feature, format)));
    Err(match missing {
        Some(feature) => GpuError::Unsupported(refusal(gpu, feature, what)),
        None => GpuError::Unsupported(format!(
            "{what}: the device '{}' cannot do that with the format {format:?}; choose another format",
            gpu.info.name
        )),
    })
}

/// What shaders may use, by feature; each capability is named once. The same relation as in wgpu.
const CAPABILITIES: [(Caps, Features); 19] = [
    (Caps::IMMEDIATES, Features::IMMEDIATES),
    (Caps::FLOAT64, Features::SHADER_F64),
    (Caps::SHADER_FLOAT16, Features::SHADER_F16),
    (Caps::SHADER_INT16, Features::SHADER_I16),
    (Caps::PRIMITIVE_INDEX, Features::PRIMITIVE_INDEX),
    (Caps::CLIP_DISTANCES, Features::CLIP_DISTANCES),
    (Caps::EARLY_DEPTH_TEST, Features::SHADER_EARLY_DEPTH_TEST),
    (Caps::SHADER_INT64, Features::SHADER_INT64),
    (
        Caps::SHADER_INT64_ATOMIC_MIN_MAX,
        Features::SHADER_INT64_ATOMIC_MIN_MAX,
    ),
    (
        Caps::SHADER_INT64_ATOMIC_MIN_MAX,
        Features::SHADER_INT64_ATOMIC_ALL_OPS,
    ),
    (
        Caps::SHADER_INT64_ATOMIC_ALL_OPS,
        Features::SHADER_INT64_ATOMIC_ALL_OPS,
    ),
    (Caps::SHADER_FLOAT32_ATOMIC, Features::SHADER_FLOAT32_ATOMIC),
    (Caps::TEXTURE_ATOMIC, Features::TEXTURE_ATOMIC),
    (Caps::TEXTURE_INT64_ATOMIC, Features::TEXTURE_INT64_ATOMIC),
    (Caps::SUBGROUP, Features::SUBGROUP),
    (Caps::SUBGROUP, Features::SUBGROUP_VERTEX),
    (Caps::SUBGROUP_BARRIER, Features::SUBGROUP_BARRIER),
    (Caps::SUBGROUP_VERTEX_STAGE, Features::SUBGROUP_VERTEX),
    (
        Caps::STORAGE_TEXTURE_16BIT_NORM_FORMATS,
        Features::TEXTURE_FORMAT_16BIT_NORM,
    ),
];

/// What a shader of someone with these features may use.
pub(super) fn capabilities(gpu: &GpuDevice, granted: Features) -> Caps {
    let mut caps = Caps::empty();
    for (capability, feature) in CAPABILITIES {
        if granted.contains(feature) {
            caps |= capability;
        }
    }
    let downlevel = gpu.downlevel_flags();
    for (capability, flag) in [
        (
            Caps::SHADER_FLOAT16_IN_FLOAT32,
            DownlevelFlags::SHADER_F16_IN_F32,
        ),
        (
            Caps::MULTISAMPLED_SHADING,
            DownlevelFlags::MULTISAMPLED_SHADING,
        ),
        (
            Caps::CUBE_ARRAY_TEXTURES,
            DownlevelFlags::CUBE_ARRAY_TEXTURES,
        ),
    ] {
        caps.set(capability, downlevel.contains(flag));
    }
    caps
}

/// The features behind the capabilities, one for each.
pub(super) fn of_capabilities() -> impl Iterator<Item = (Caps, Features)> {
    CAPABILITIES.into_iter()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn features_have_their_names_with_and_without_prefix() {
        let feature = Some(Features::SHADER_INT64_ATOMIC_MIN_MAX);
        assert_eq!(by_name("shader-int64-atomic-min-max"), feature);
        assert_eq!(by_name("wgpu-shader-int64-atomic-min-max"), feature);
        assert_eq!(
            by_name("float32-blendable"),
            Some(Features::FLOAT32_BLENDABLE)
        );
        assert_eq!(by_name("warp-drive"), None);
        assert_eq!(
            name(Features::SHADER_INT64_ATOMIC_MIN_MAX),
            "shader-int64-atomic-min-max"
        );
    }

    #[test]
    fn every_known_feature_has_a_name() {
        for feature in GpuDevice::KNOWN_FEATURES.iter() {
            assert_eq!(by_name(name(feature)), Some(feature));
        }
    }
}
