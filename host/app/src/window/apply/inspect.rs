//! Carries out intents about what is under the pointer.

use std::time::Instant;

use pointstage_engine::stage::Severity;

use crate::window::app::App;
use crate::window::inspector::REACH_PX;
use crate::window::intent::{CameraIntent, InspectIntent};

impl App {
    pub(super) fn apply_inspect(&mut self, intent: InspectIntent) {
        match intent {
            InspectIntent::Pin(pixel) => self.pin(pixel),
            InspectIntent::Unpin => self.inspector.unpin(),
            InspectIntent::PivotOn(pixel) => self.pivot_on(pixel),
        }
    }

    fn pin(&mut self, pixel: [u32; 2]) {
        let Some(shown) = self.screens.active.shown.clone() else {
            return;
        };
        if self.inspector.pin(pixel, &shown, &self.session.scene) {
            self.panels.inspector = true;
        }
    }

    fn pivot_on(&mut self, pixel: [u32; 2]) {
        // The double click's first click kept the surfel; it was not meant.
        self.inspector.unpin();
        let pick = self
            .screens
            .active
            .shown
            .as_ref()
            .and_then(|shown| shown.pick(pixel.map(i64::from), REACH_PX));
        match pick {
            Some(pick) => self.apply_camera(CameraIntent::PivotAt(pick.position_world)),
            None => self.log.say(
                Severity::Info,
                "There is no surface to turn around at that place.",
                Instant::now(),
            ),
        }
    }
}
