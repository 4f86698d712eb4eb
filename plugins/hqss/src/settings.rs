//! The settings, as the shaders read them.

use bytemuck::{Pod, Zeroable};
use pointstage_plugin_api::{Result, Settings};
use pointstage_visibility::Path;

/// `SplatUniform` of `shaders/hqss/splat.wesl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct SplatUniform {
    pub(crate) scale: f32,
    pub(crate) cutoff: f32,
    pub(crate) falloff: f32,
    pub(crate) push: f32,
    pub(crate) filter_px: f32,
    pub(crate) two_sided: u32,
    pub(crate) bands: f32,
    pub(crate) outline: f32,
}

/// Feature of the attribute and the shading pass: splats are lit before they blend.
pub(crate) const LIT_SPLATS: &str = "lit_splats";

/// How the user wants a frame.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Wanted {
    pub(crate) uniform: SplatUniform,
    /// Leaves out what shows its back.
    pub(crate) culls_backs: bool,
    /// Whether the low-pass filter is on.
    pub(crate) filters: bool,
    /// Of the footprint's module.
    pub(crate) features: Vec<&'static str>,
    /// Of the shading pass: how the colours are lit, or what they show.
    pub(crate) look: Option<&'static str>,
    pub(crate) path: Path,
}

/// The values of the schema.
///
/// # Errors
/// If the host has no value for a setting.
pub(crate) fn request_of(settings: Settings<'_>) -> Result<Wanted> {
    let sigma = settings.float("sigma")?;
    let mut features = Vec::new();
    let (culls_backs, filters) = (settings.bool("cull_backs")?, settings.bool("filter")?);
    features.extend(culls_backs.then_some("cull_backs"));
    features.extend(filters.then_some("low_pass"));
    Ok(Wanted {
        culls_backs,
        filters,
        uniform: SplatUniform {
            scale: settings.float("splat_scale")?,
            cutoff: settings.float("cutoff")?,
            falloff: falloff(sigma),
            push: settings.float("epsilon")?,
            filter_px: settings.float("filter_radius")?,
            two_sided: settings.bool("two_sided")?.into(),
            bands: settings.int("bands")? as f32,
            outline: settings.float("outline")?,
        },
        features,
        look: look_of(settings.choice("shows")?, settings.choice("shading")?),
        path: Path::from_id(settings.choice("path")?),
    })
}

/// Feature of the shading pass.
fn look_of(shows: &str, shading: &str) -> Option<&'static str> {
    match (shows, shading) {
        ("colours", _) => None,
        ("normals", _) => Some("shows_normals"),
        ("weight", _) => Some("shows_weight"),
        ("depth", _) => Some("shows_depth"),
        (_, "splats") => Some(LIT_SPLATS),
        (_, "flat") => Some("flat_normals"),
        (_, "toon") => Some("toon"),
        _ => Some("phong"),
    }
}

/// The factor f of the Gaussian exp(-f·d²) with this standard deviation.
fn falloff(sigma: f32) -> f32 {
    0.5 / (sigma * sigma)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_usual_gaussian_ends_at_a_weight_of_exp_of_minus_two() {
        let at_the_edge = (-falloff(0.5)).exp();
        assert!((at_the_edge - (-2.0_f32).exp()).abs() < 1e-6);
    }
}
