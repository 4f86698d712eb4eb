#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod settings;

use pointstage_plugin_api::prelude::*;
use pointstage_visibility::{Footprint, Prepared, Request, Varying, VisibilityView};
use settings::{PointSettings, SpriteUniform};

/// The sprite's footprint, `shaders/points/sprite.wesl`.
pub const SPRITE: Footprint = Footprint {
    name: "points",
    source: include_str!("../../../shaders/points/sprite.wesl"),
    varying: Varying::Flat,
    uniform_size: size_of::<SpriteUniform>() as u64,
};

/// The renderer, prepared.
pub struct Points {
    visibility: Prepared,
}

/// The renderer in one viewport.
pub struct PointsView {
    visibility: VisibilityView,
}

impl Renderer for Points {
    type View = PointsView;

    fn prepare(
        host: &Host,
        _scene: Scene<'_>,
        _previous: Option<(&Self, Changes<'_>)>,
        _settings: Settings<'_>,
        _progress: &Progress<'_>,
    ) -> Result<Self> {
        // Pipelines depend on settings that change from frame to frame, so views make them when they are first needed.
        Ok(Self {
            visibility: Prepared::new(host.gpu()?, SPRITE)?,
        })
    }

    fn view(&self, host: &Host) -> Result<Self::View> {
        Ok(PointsView {
            visibility: VisibilityView::new(host, &self.visibility)?,
        })
    }
}

impl View<Points> for PointsView {
    fn render(&mut self, prepared: &Points, frame: &mut Frame<'_>) -> Result<Outcome> {
        let settings = PointSettings::read(frame.settings())?;
        let uniform = SpriteUniform::from(&settings);
        let request = Request {
            path: settings.path,
            features: &settings.features(),
            extent: settings.extent(),
            bytes_per_pixel: 0,
            uniform: bytemuck::bytes_of(&uniform),
            cpu: None,
        };
        self.visibility
            .render(&prepared.visibility, frame, &request)
    }
}

pointstage_plugin_api::export! { "plugin.json", renderers: [Points] }

#[cfg(test)]
mod shader_tests;
