//! The settings of a frame.

use pointstage_plugin_api::{Result, Settings};
use pointstage_visibility::Path;

/// What is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Method {
    /// Every triangle.
    Classic,
    /// Every vertex, as a splat.
    Points,
    /// Splats and triangles of a cut.
    Pop,
}

/// How the user wants a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Wanted {
    pub(crate) method: Method,
    /// Greatest width of a splat; px.
    pub(crate) threshold_px: f32,
    pub(crate) is_disk: bool,
    pub(crate) is_gouraud: bool,
    pub(crate) has_pop_colours: bool,
    pub(crate) cull_backs: bool,
    pub(crate) is_coherent: bool,
    pub(crate) path: Path,
}

/// The values of the schema.
///
/// # Errors
/// If the host has no value for a setting.
pub(crate) fn wanted_of(settings: Settings<'_>) -> Result<Wanted> {
    Ok(Wanted {
        method: match settings.choice("method")? {
            "classic" => Method::Classic,
            "points" => Method::Points,
            _ => Method::Pop,
        },
        threshold_px: settings.float("threshold")?,
        is_disk: settings.choice("splat")? == "disk",
        is_gouraud: settings.choice("shading")? == "gouraud",
        has_pop_colours: settings.bool("pop_colours")?,
        cull_backs: settings.bool("cull_backs")?,
        is_coherent: settings.bool("coherence")?,
        path: Path::from_id(settings.choice("path")?),
    })
}
