//! Carries out intents about the eye.

use crate::window::app::App;
use crate::window::intent::CameraIntent;

impl App {
    pub(super) fn apply_camera(&mut self, intent: CameraIntent) {
        match intent {
            CameraIntent::Move(camera_move) => self.move_camera(camera_move),
            CameraIntent::Project(projection) => self.session.camera.projection = projection,
        }
    }
}
