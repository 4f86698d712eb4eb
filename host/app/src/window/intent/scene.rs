//! Intents about the objects.

use glam::DAffine3;
use pointstage_scene::ObjectId;
use pointstage_scene::estimate::Steps;

/// What to do with objects.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum SceneIntent {
    /// Estimate normals and radii of every object that lacks them.
    Estimate,
    /// Estimate columns of the selected objects anew, or of all if none is selected.
    EstimateAnew(Steps),
    /// Compare points with so many neighbours.
    SetNeighbours(usize),
    /// Turn an inward-wound mesh inside out.
    Flip(ObjectId),
    /// Show or hide an object.
    SetVisible(ObjectId, bool),
    /// Take an object out of the scene.
    Remove(ObjectId),
    /// Take the selected objects out of the scene.
    RemoveSelected,
    /// Copy the selected objects.
    Duplicate,
    /// Make the selected objects one.
    Merge,
    /// Call an object this.
    Rename(ObjectId, String),
    /// Let an object stand there: its map into the world.
    SetTransform(ObjectId, DAffine3),
    /// Draw an object's surfels with their radii times this factor.
    SetRadiusScale(ObjectId, f32),
    /// Select this object alone.
    Select(ObjectId),
    /// Add this object to the selection, or take it out.
    ToggleSelected(ObjectId),
    /// Select every object.
    SelectAll,
    /// Select no object.
    SelectNone,
}
