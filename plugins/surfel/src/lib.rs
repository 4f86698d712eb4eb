#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod cpu_disks;

use crate::cpu_disks::Disks;
use bytemuck::{Pod, Zeroable};
use pointstage_plugin_api::prelude::*;
use pointstage_visibility::{Extent, Footprint, Path, Prepared, Request, Varying, VisibilityView};

/// The disk's footprint, `shaders/surfel/disk.wesl`.
pub const DISK: Footprint = Footprint {
    name: "surfel",
    source: include_str!("../../../shaders/surfel/disk.wesl"),
    varying: Varying::Linear,
    uniform_size: size_of::<DiskUniform>() as u64,
};

/// `DiskUniform` of `shaders/surfel/disk.wesl`.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct DiskUniform {
    scale: f32,
}

/// The renderer, prepared.
pub struct Surfel {
    visibility: Prepared,
}

/// The renderer in one viewport.
pub struct SurfelView {
    visibility: VisibilityView,
}

impl Renderer for Surfel {
    type View = SurfelView;

    fn prepare(
        host: &Host,
        scene: Scene<'_>,
        _previous: Option<(&Self, Changes<'_>)>,
        _settings: Settings<'_>,
        _progress: &Progress<'_>,
    ) -> Result<Self> {
        Ok(Self {
            visibility: Prepared::new(host.gpu()?, DISK)?.clipped_by(scene)?,
        })
    }

    fn view(&self, host: &Host) -> Result<Self::View> {
        Ok(SurfelView {
            visibility: VisibilityView::new(host, &self.visibility)?,
        })
    }
}

impl View<Surfel> for SurfelView {
    fn render(&mut self, prepared: &Surfel, frame: &mut Frame<'_>) -> Result<Outcome> {
        let settings = frame.settings();
        let uniform = DiskUniform {
            scale: settings.float("splat_scale")?,
        };
        let disks = Disks {
            scale: uniform.scale,
            culls_backs: settings.bool("cull_backs")?,
        };
        let request = Request {
            path: Path::from_id(settings.choice("path")?),
            features: if disks.culls_backs {
                &["cull_backs"]
            } else {
                &[]
            },
            extent: Extent::Any,
            bytes_per_pixel: 0,
            uniform: bytemuck::bytes_of(&uniform),
            cpu: Some(&disks),
        };
        self.visibility
            .render(&prepared.visibility, frame, &request)
    }
}

pointstage_plugin_api::export! { "plugin.json", renderers: [Surfel] }

#[cfg(test)]
mod shader_tests;
