//! Intents about the eye.

use glam::DVec3;
use pointstage_scene::{NearClipping, Projection};

use crate::window::navigation::{CameraMove, Glide, NavigationOptions};

/// What to do with the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum CameraIntent {
    /// Move it.
    Move(CameraMove),
    /// Turn to this point of the world, and around it from then on.
    PivotAt(DVec3),
    /// Let a drag go on by itself.
    Glide(Glide),
    /// End what it does by itself.
    Stop,
    /// Change how it projects.
    Project(Projection),
    /// Let this decide where the near plane stands.
    Near(NearClipping),
    /// Let it answer to pointer and keys like this.
    Options(NavigationOptions),
    /// Fly this many times as fast.
    FlySpeed(f64),
    /// Lock the turntable, which levels the horizon, or let the scene turn freely.
    ToggleTurntable,
}
