//! A CPU renderer with a setting of every kind: the picture is a bar of colour for each, from top to bottom, in the
//! manifest's order, so that a test sees in the picture what it changed in the panel.
#![forbid(unsafe_code)]

use pointstage_plugin_api::prelude::*;

/// The renderer: it keeps the setting that costs a preparation.
pub struct Everything {
    thorough: bool,
}

/// Its view: how often the action was pressed.
pub struct EverythingView {
    presses: u32,
}

impl Renderer for Everything {
    type View = EverythingView;

    fn prepare(
        _: &Host,
        _: Scene<'_>,
        _: Option<(&Self, Changes<'_>)>,
        settings: Settings<'_>,
        _: &Progress<'_>,
    ) -> Result<Self> {
        Ok(Self { thorough: settings.bool("thorough")? })
    }

    fn view(&self, _: &Host) -> Result<EverythingView> {
        Ok(EverythingView { presses: 0 })
    }
}

impl View<Everything> for EverythingView {
    fn render(&mut self, prepared: &Everything, frame: &mut Frame<'_>) -> Result<Outcome> {
        if frame.pressed("again") {
            self.presses += 1;
        }
        let bars = self.bars(prepared, frame.settings())?;
        let (Some(mut colour), Some(mut depth)) = (frame.take_plane("colour"), frame.take_plane("depth")) else {
            return Err("the host lends no colour or depth plane".into());
        };
        let height = frame.size_px()[1] as usize;
        for (y, row) in colour.rows::<[f32; 4]>().enumerate() {
            let [red, green, blue] = bars[y * bars.len() / height.max(1)];
            row.fill([red, green, blue, 1.0]);
        }
        // Anything but the clear value: the bars lie before the background.
        depth.rows::<f32>().for_each(|row| row.fill(0.5));
        Ok(Outcome::Done)
    }
}

impl EverythingView {
    /// Linear colours, one a setting.
    fn bars(&self, prepared: &Everything, settings: Settings<'_>) -> Result<[[f32; 3]; 11]> {
        let switch = |on: bool| if on { [0.0, 0.8, 0.0] } else { [0.8, 0.0, 0.0] };
        let part = |value: f32| {
            let value = value.clamp(0.0, 1.0);
            [value, 0.2, 1.0 - value]
        };
        let form = match settings.choice("form")? {
            "round" => [0.8, 0.0, 0.0],
            "square" => [0.0, 0.8, 0.0],
            _ => [0.0, 0.0, 0.8],
        };
        let [red, green, blue, _] = settings.colour("tint")?;
        let sum: u32 = settings.text("note")?.bytes().map(u32::from).sum();
        Ok([
            switch(settings.bool("switch")?),
            part(settings.int("count")? as f32 / 16.0),
            part(settings.float("amount")?),
            part(0.5 + 0.25 * settings.float("scale")?.log10()),
            part(0.5 + 0.1 * settings.float("offset")?),
            form,
            part(settings.float("corner")?),
            [red, green, blue],
            part((sum % 16) as f32 / 15.0),
            switch(prepared.thorough),
            part((self.presses % 5) as f32 / 4.0),
        ])
    }
}

pointstage_plugin_api::export! { "plugin.json", renderers: [Everything] }
