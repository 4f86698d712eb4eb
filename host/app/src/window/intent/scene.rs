//! Intents about the objects.

use pointstage_scene::ObjectId;

/// What to do with objects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SceneIntent {
    /// Estimate normals and radii of every object that lacks them.
    Estimate,
    /// Turn an inward-wound mesh inside out.
    Flip(ObjectId),
    /// Show or hide an object.
    SetVisible(ObjectId, bool),
    /// Take an object out of the scene.
    Remove(ObjectId),
}
