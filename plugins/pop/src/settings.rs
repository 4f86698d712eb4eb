//! The settings of a frame.

use pointstage_plugin_api::{Result, Settings};
use pointstage_pop_tree::cut::Keep;
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

/// Whether parts that are turned away are left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Culling {
    /// Where no back can be seen.
    Auto,
    /// Always.
    On,
    /// Never.
    Off,
}

/// Where the tree is walked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Walk {
    /// By the kind of device.
    Auto,
    /// On the CPU.
    Cpu,
    /// On the device.
    Device,
}

/// Where the compute path draws splats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Splats {
    /// By the kind of device and their number.
    WhereFaster,
    /// On the CPU.
    OnCpu,
    /// On the device.
    OnDevice,
}

/// What a splat looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shape {
    /// A square of one depth and one colour.
    Square,
    /// A disk of one colour.
    Disk,
    /// A disk that blends with others and with triangles.
    Blended,
}

/// How the user wants a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Wanted {
    pub(crate) method: Method,
    /// Greatest width of a splat; px.
    pub(crate) threshold_px: f32,
    pub(crate) shape: Shape,
    pub(crate) is_gouraud: bool,
    pub(crate) has_pop_colours: bool,
    pub(crate) culling: Culling,
    pub(crate) keep: Keep,
    pub(crate) walk: Walk,
    pub(crate) path: Path,
    pub(crate) splats: Splats,
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
        shape: match settings.choice("splat")? {
            "square" => Shape::Square,
            "blended" => Shape::Blended,
            _ => Shape::Disk,
        },
        is_gouraud: settings.choice("shading")? == "gouraud",
        has_pop_colours: settings.bool("pop_colours")?,
        culling: match settings.choice("cull_backs")? {
            "on" => Culling::On,
            "off" => Culling::Off,
            _ => Culling::Auto,
        },
        keep: match settings.choice("coherence")? {
            "on" => Keep::Always,
            "off" => Keep::Never,
            _ => Keep::WhereItPays,
        },
        walk: match settings.choice("selection")? {
            "cpu" => Walk::Cpu,
            "gpu" => Walk::Device,
            _ => Walk::Auto,
        },
        path: match settings.choice("path")? {
            "cpu" => Path::Compute,
            other => Path::from_id(other),
        },
        splats: match settings.choice("path")? {
            "auto" => Splats::WhereFaster,
            "cpu" => Splats::OnCpu,
            _ => Splats::OnDevice,
        },
    })
}

impl Wanted {
    /// Whether splats are round.
    pub(crate) fn is_disk(&self) -> bool {
        self.shape != Shape::Square
    }

    /// Whether splats blend; no splat is drawn of a whole mesh.
    pub(crate) fn is_blended(&self) -> bool {
        self.shape == Shape::Blended && self.method != Method::Classic
    }
}
