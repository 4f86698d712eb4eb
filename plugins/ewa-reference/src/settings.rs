//! The settings, read once a frame.

use pointstage_plugin_api::{Result, Settings};

use crate::footprint::Kernel;

/// How samples of a pixel are averaged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SampleFilter {
    /// All samples of the pixel alike.
    Box,
    /// A Gaussian over the pixel's surroundings.
    Gaussian,
}

/// What the colours show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shows {
    /// Lit colours.
    Result,
    /// Unlit colours.
    Colours,
    /// Normals, as colours.
    Normals,
}

/// How the user wants a frame.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Wanted {
    pub(crate) kernel: Kernel,
    /// Samples along each side of a pixel.
    pub(crate) samples: u32,
    pub(crate) sample_filter: SampleFilter,
    /// Draw triangles of objects that have some.
    pub(crate) triangles: bool,
    pub(crate) cull_backs: bool,
    pub(crate) two_sided: bool,
    pub(crate) shows: Shows,
    /// Splats are lit one by one, before they blend; never if what is shown is not lit.
    pub(crate) lights_splats: bool,
}

impl Wanted {
    /// The values of the schema.
    ///
    /// # Errors
    /// If the host has no value for a setting.
    pub(crate) fn new(settings: Settings<'_>) -> Result<Self> {
        let number = |id| settings.float(id).map(f64::from);
        let has_filter = settings.bool("filter")?;
        let filter_radius = number("filter_radius")?;
        Ok(Self {
            kernel: Kernel {
                scale: number("splat_scale")?,
                sigma: number("sigma")?,
                cutoff: number("cutoff")?,
                push: number("epsilon")?,
                filter_radius: has_filter.then_some(filter_radius),
            },
            samples: settings.int("samples")?.clamp(1, 16) as u32,
            sample_filter: match settings.choice("sample_filter")? {
                "gaussian" => SampleFilter::Gaussian,
                _ => SampleFilter::Box,
            },
            triangles: settings.choice("surface")? == "triangles",
            cull_backs: settings.bool("cull_backs")?,
            two_sided: settings.bool("two_sided")?,
            shows: match settings.choice("shows")? {
                "colours" => Shows::Colours,
                "normals" => Shows::Normals,
                _ => Shows::Result,
            },
            lights_splats: settings.choice("shading")? == "splats"
                && settings.choice("shows")? == "result",
        })
    }
}
