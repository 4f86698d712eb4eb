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
    /// Select this object alone.
    Select(ObjectId),
    /// Add this object to the selection, or take it out.
    ToggleSelected(ObjectId),
    /// Select every object.
    SelectAll,
    /// Select no object.
    SelectNone,
}
