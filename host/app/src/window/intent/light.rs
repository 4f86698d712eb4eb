//! Intents about lights and material.

use pointstage_scene::{Lights, Material};

/// How the scene is lit.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum LightIntent {
    /// Light the scene like this.
    Set(Lights),
    /// Let objects take light like this: the selected ones, or all if none is.
    Material(Material),
}
