//! Surfels are selected, copied and deleted by hand: tools over the picture, the crop box, and the work that they ask for.
//!
//! A drag with a tool ends in a [`Drawn`] region. A worker finds its surfels ([`work`]); what it found goes into the scene's
//! marks when it comes back, so that strokes that follow each other add up in order. The tint of marked surfels is the
//! engine's.

mod bar;
mod crop;
mod stroke;
#[cfg(test)]
mod tests;
mod work;

use std::sync::Arc;

use pointstage_scene::{Bounds, Object};

pub(crate) use bar::bar_ui;
pub(crate) use crop::{crop_ui, paint_box};
pub(crate) use stroke::Drawn;
use stroke::Stroke;
pub(crate) use work::{
    Depths, Found, Pieces, Purpose, find_in_box, find_in_region, keep_in_box, take_pieces,
};

/// The least and the greatest radius of the brush, points.
pub(crate) const BRUSH_RADII: std::ops::RangeInclusive<f32> = 2.0..=200.0;

/// What a left drag over the picture does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Tool {
    /// Moves the camera.
    #[default]
    Navigate,
    /// Selects in a rectangle.
    Rectangle,
    /// Selects inside a line drawn by hand.
    Lasso,
    /// Selects what a disc goes over.
    Brush,
}

impl Tool {
    /// Those that select, with names and the last parts of their actions' ids.
    pub(crate) const SELECTING: [(Self, &'static str, &'static str); 3] = [
        (Self::Rectangle, "Rectangle", "rectangle"),
        (Self::Lasso, "Lasso", "lasso"),
        (Self::Brush, "Brush", "brush"),
    ];

    /// Its name in a word, for tests and scripts.
    pub(crate) fn key(self) -> &'static str {
        let mut tools = Self::SELECTING.iter();
        tools
            .find(|(tool, ..)| *tool == self)
            .map_or("navigate", |(.., key)| key)
    }
}

/// Which surfels under a tool are selected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Reach {
    /// All, however deep.
    #[default]
    Through,
    /// Those that the picture shows.
    Visible,
}

/// What selecting has on the screen, and what was copied.
#[derive(Debug)]
pub(crate) struct Selecting {
    /// What a left drag does.
    pub(crate) tool: Tool,
    /// How deep tools reach.
    pub(crate) reach: Reach,
    /// Radius of the brush, points.
    pub(crate) brush_radius: f32,
    /// The drag under way.
    stroke: Option<Stroke>,
    /// The crop box, while it is shown.
    pub(crate) crop_box: Option<Bounds>,
    /// What was copied last.
    pub(crate) clipboard: Clipboard,
}

impl Default for Selecting {
    fn default() -> Self {
        Self {
            tool: Tool::Navigate,
            reach: Reach::Through,
            brush_radius: 20.0,
            stroke: None,
            crop_box: None,
            clipboard: Clipboard::default(),
        }
    }
}

/// Surfels that were copied.
#[derive(Clone, Debug, Default)]
pub(crate) struct Clipboard {
    /// As objects of their own.
    pub(crate) pieces: Arc<[Object]>,
    /// The text that stands for them on the system's clipboard: whatever was copied last is pasted.
    pub(crate) token: String,
}

impl Clipboard {
    /// Holds these, under a token of their own.
    pub(crate) fn of(pieces: Vec<Object>) -> Self {
        let count: usize = pieces.iter().map(|piece| piece.geometry.surfel_count).sum();
        let first = pieces.first().map_or(0, |piece| piece.id.0);
        Self {
            token: format!(
                "Pointstage: {count} surfels (copy {}-{first})",
                std::process::id()
            ),
            pieces: pieces.into(),
        }
    }
}
