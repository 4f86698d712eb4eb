//! Intents about how the picture is shown.

use pointstage_engine::stage::{Background, Show};

use crate::window::pacing::Pacing;

/// How the picture is shown, whatever the renderer.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ViewIntent {
    /// Show this.
    Show(Show),
    /// Put this behind the scene.
    Background(Background),
    /// Factor on linear colours.
    Exposure(f32),
    /// Factor on every radius.
    RadiusScale(f32),
    /// How often, and how long moving pictures may take.
    Pace(Pacing),
    /// Draw once, whatever the limit on the rate says.
    DrawNow,
}
