//! Carries out intents about stored views.

use pointstage_scene::ViewRecord;

use crate::window::app::App;
use crate::window::intent::ViewsIntent;

impl App {
    pub(super) fn apply_views(&mut self, intent: ViewsIntent) {
        match intent {
            ViewsIntent::Store(slot) => {
                let record = self.view_record();
                if let Some(kept) = self.session.views.slots.get_mut(slot) {
                    *kept = Some(record);
                }
            }
            ViewsIntent::Recall(slot) => {
                if let Some(Some(record)) = self.session.views.slots.get(slot) {
                    self.session.camera = record.camera();
                }
            }
        }
    }

    /// The present view.
    pub(in crate::window) fn view_record(&self) -> ViewRecord {
        let [width, height] = self
            .viewport
            .map_or([1280, 720], |viewport| viewport.size_px);
        ViewRecord::new(self.session.camera, width, height)
    }
}
