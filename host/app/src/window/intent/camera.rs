//! Intents about the eye.

use pointstage_scene::Projection;

use crate::window::navigation::CameraMove;

/// What to do with the camera.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum CameraIntent {
    /// Move it.
    Move(CameraMove),
    /// Change how it projects.
    Project(Projection),
}
