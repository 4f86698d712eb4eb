//! A good renderer: all green, half-way deep. The harness builds it against changed copies of `plugin-api`.
#![forbid(unsafe_code)]

use pointstage_plugin_api::prelude::*;

/// The renderer, and its view.
pub struct Green;

impl Renderer for Green {
    type View = Self;

    fn prepare(
        _: &Host,
        _: Scene<'_>,
        _: Option<(&Self, Changes<'_>)>,
        _: Settings<'_>,
        _: &Progress<'_>,
    ) -> Result<Self> {
        Ok(Self)
    }

    fn view(&self, _: &Host) -> Result<Self> {
        Ok(Self)
    }
}

impl View<Green> for Green {
    fn render(&mut self, _: &Green, frame: &mut Frame<'_>) -> Result<Outcome> {
        if let Some(mut plane) = frame.take_plane("colour") {
            plane.rows::<[f32; 4]>().for_each(|row| row.fill([0.0, 1.0, 0.0, 1.0]));
        }
        if let Some(mut plane) = frame.take_plane("depth") {
            plane.rows::<f32>().for_each(|row| row.fill(0.5));
        }
        Ok(Outcome::Done)
    }
}

#[cfg(not(feature = "newer"))]
pointstage_plugin_api::export! { "plugin.json", renderers: [Green] }

#[cfg(feature = "newer")]
pointstage_plugin_api::export! { "newer.json", renderers: [Green, novel::Novel] }

/// What only the newer `plugin-api` can say.
#[cfg(feature = "newer")]
mod novel {
    use pointstage_plugin_api::abi::commands;
    use pointstage_plugin_api::prelude::*;

    /// Records a command that the host does not know.
    pub struct Novel;

    impl Renderer for Novel {
        type View = Self;

        fn prepare(
            _: &Host,
            _: Scene<'_>,
            _: Option<(&Self, Changes<'_>)>,
            _: Settings<'_>,
            _: &Progress<'_>,
        ) -> Result<Self> {
            Ok(Self)
        }

        fn view(&self, _: &Host) -> Result<Self> {
            Ok(Self)
        }
    }

    impl View<Novel> for Novel {
        fn render(&mut self, _: &Novel, frame: &mut Frame<'_>) -> Result<Outcome> {
            let mut recorder = Recorder::new();
            recorder.push(commands::Novelty { value: 7 });
            frame.submit(recorder);
            Ok(Outcome::Done)
        }
    }
}
