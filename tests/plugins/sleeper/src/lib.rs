//! A CPU renderer that sleeps for as long as its settings say and draws nothing: what is measured of it is known beforehand.
#![forbid(unsafe_code)]

use std::time::Duration;

use pointstage_plugin_api::prelude::*;

/// The renderer.
pub struct Sleeper;

impl Renderer for Sleeper {
    type View = Self;

    fn prepare(
        _: &Host,
        _: Scene<'_>,
        _: Option<(&Self, Changes<'_>)>,
        settings: Settings<'_>,
        _: &Progress<'_>,
    ) -> Result<Self> {
        sleep(settings.int("prepare_ms")?);
        Ok(Self)
    }

    fn view(&self, _: &Host) -> Result<Self> {
        Ok(Self)
    }
}

impl View<Sleeper> for Sleeper {
    fn render(&mut self, _: &Sleeper, frame: &mut Frame<'_>) -> Result<Outcome> {
        sleep(frame.settings().int("sleep_ms")?);
        Ok(Outcome::Done)
    }
}

/// * `ms`: below zero is zero.
fn sleep(ms: i64) {
    let ms = u64::try_from(ms).unwrap_or(0);
    if ms > 0 {
        std::thread::sleep(Duration::from_millis(ms));
    }
}

pointstage_plugin_api::export! { "plugin.json", renderers: [Sleeper] }
