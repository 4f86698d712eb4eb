#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod blending;
mod camera;
mod cpu_pixels;
mod cpu_splats;
mod device_cut;
mod layers;
mod part;
mod part_cut;
mod passes;
mod plan;
mod prepare;
mod record;
mod settings;
mod split;
mod took;
mod tree_cache;
mod uniforms;
mod view;
mod visible;

use crate::passes::Passes;
use crate::view::PopView;
use pointstage_plugin_api::prelude::*;
use std::sync::Arc;

/// The renderer, prepared: a tree for each mesh.
pub struct Pop {
    passes: Arc<Passes>,
    parts: Vec<Arc<part::Part>>,
}

impl Renderer for Pop {
    type View = PopView;

    fn prepare(
        host: &Host,
        scene: Scene<'_>,
        previous: Option<(&Self, Changes<'_>)>,
        settings: Settings<'_>,
        progress: &Progress<'_>,
    ) -> Result<Self> {
        prepare::prepare(host, scene, previous, settings, progress)
    }

    fn view(&self, host: &Host) -> Result<Self::View> {
        PopView::new(host, self)
    }
}

impl View<Pop> for PopView {
    fn render(&mut self, prepared: &Pop, frame: &mut Frame<'_>) -> Result<Outcome> {
        self.draw(prepared, frame)
    }
}

pointstage_plugin_api::export! { "plugin.json", renderers: [Pop] }

#[cfg(test)]
mod shader_tests;
