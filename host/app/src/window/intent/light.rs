//! Intents about lights and material.

use pointstage_scene::{Lights, Material};

/// How the scene is lit.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum LightIntent {
    /// Light the scene like this.
    Set(Lights),
    /// Move the first light as the pointer goes.
    Drag {
        /// To the right, picture heights.
        right: f64,
        /// Upwards, picture heights.
        up: f64,
    },
    /// Move the first light away from the eye by this part of the distance to the pivot, if it is a point.
    Push(f64),
    /// Let objects take light like this: the selected ones, or all if none is.
    Material(Material),
}
