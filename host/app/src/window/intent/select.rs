//! Intents about surfels: which are marked, and what becomes of them.

use pointstage_scene::{Bounds, MarkMode};

use crate::window::selecting::{Drawn, Reach, Tool};

/// What to do with surfels.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum SelectIntent {
    /// Let drags over the picture select with this tool, or navigate.
    Tool(Tool),
    /// Select what is seen, or what lies behind too.
    Reach(Reach),
    /// Radius of the brush, points.
    BrushRadius(f32),
    /// Select what lies in this part of a view.
    Region(Drawn, MarkMode),
    /// Select the others.
    Invert,
    /// Select none.
    Clear,
    /// Copy the selected surfels, and take them out.
    Cut,
    /// Copy the selected surfels.
    Copy,
    /// Add what was copied last as new objects.
    Paste,
    /// Take the selected surfels out.
    Delete,
    /// Show or hide the crop box.
    ToggleCropBox,
    /// Let the crop box be this one.
    SetCropBox(Bounds),
    /// Select what lies in the crop box.
    SelectInCropBox(MarkMode),
    /// Take out what lies outside the crop box.
    KeepInCropBox,
}
