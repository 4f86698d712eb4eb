//! Carries out intents about how the picture is shown.

use crate::window::app::App;
use crate::window::intent::ViewIntent;

impl App {
    pub(super) fn apply_view(&mut self, intent: ViewIntent) {
        let view = &mut self.session.panes.active.view;
        match intent {
            ViewIntent::Show(show) => view.show = show,
            ViewIntent::Background(background) => view.background = background,
            ViewIntent::Exposure(exposure) => view.exposure = exposure,
            ViewIntent::RadiusScale(scale) => view.radius_scale = scale,
            ViewIntent::Pace(pacing) => self.session.pacing = pacing,
            ViewIntent::DrawNow => self.screens.active.asking.invalidate(),
        }
    }
}
