#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod blending;
mod cpu;
mod passes;
mod settings;

use crate::blending::BlendedView;
use crate::passes::Passes;
use crate::settings::request_of;
use pointstage_plugin_api::prelude::*;

/// The renderer, prepared. Of the scene it holds clip lines only.
pub struct Hqss {
    passes: Passes,
}

/// The renderer in one viewport.
pub struct HqssView {
    blended: BlendedView,
}

impl Renderer for Hqss {
    type View = HqssView;

    fn prepare(
        host: &Host,
        scene: Scene<'_>,
        _previous: Option<(&Self, Changes<'_>)>,
        _settings: Settings<'_>,
        _progress: &Progress<'_>,
    ) -> Result<Self> {
        Ok(Self {
            passes: Passes::new(host.gpu()?, scene)?,
        })
    }

    fn view(&self, host: &Host) -> Result<Self::View> {
        Ok(HqssView {
            blended: BlendedView::new(host, &self.passes)?,
        })
    }
}

impl View<Hqss> for HqssView {
    fn render(&mut self, prepared: &Hqss, frame: &mut Frame<'_>) -> Result<Outcome> {
        let request = request_of(frame.settings())?;
        self.blended.render(&prepared.passes, frame, &request)
    }
}

pointstage_plugin_api::export! { "plugin.json", renderers: [Hqss] }

#[cfg(test)]
mod shader_tests;
