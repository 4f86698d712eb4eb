#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod bins;
mod footprint;
mod parts;
mod picture;
mod samples;
mod settings;
#[cfg(test)]
mod test_camera;
mod tile;
mod triangle;
mod work;

use crate::picture::Picture;
use crate::settings::Wanted;
use pointstage_plugin_api::prelude::*;

/// The renderer. It keeps nothing of the scene.
pub struct EwaReference;

/// The renderer in one viewport, with the picture as far as it is drawn.
#[derive(Default)]
pub struct EwaReferenceView {
    picture: Picture,
}

impl Renderer for EwaReference {
    type View = EwaReferenceView;

    fn prepare(
        _host: &Host,
        _scene: Scene<'_>,
        _previous: Option<(&Self, Changes<'_>)>,
        _settings: Settings<'_>,
        _progress: &Progress<'_>,
    ) -> Result<Self> {
        Ok(Self)
    }

    fn view(&self, _host: &Host) -> Result<Self::View> {
        Ok(EwaReferenceView::default())
    }
}

impl View<EwaReference> for EwaReferenceView {
    fn render(&mut self, _prepared: &EwaReference, frame: &mut Frame<'_>) -> Result<Outcome> {
        let wanted = Wanted::new(frame.settings())?;
        self.picture.render(frame, &wanted)
    }
}

pointstage_plugin_api::export! { "plugin.json", renderers: [EwaReference] }
