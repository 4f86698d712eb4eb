//! Intents about views beside each other.

use crate::window::comparison::Way;

/// What to do with views and how they are compared.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum CompareIntent {
    /// Show so many views, 1 to 4.
    Count(usize),
    /// Let panels, keys and menus act on this view.
    Activate(usize),
    /// The next view.
    ActivateNext,
    /// Draw this view with this renderer.
    ChooseRenderer(usize, String),
    /// One camera for all views, or one each.
    Link(bool),
    /// Share all that is not the renderer's own.
    Lock(bool),
    /// Lay views out so.
    Way(Way),
    /// Measure the others against this view.
    Against(usize),
    /// Measure when views rest, or not.
    Measure(bool),
    /// Changes a second of the flicker.
    Flicker(f32),
    /// The wipe's handle, as a part of the width.
    Wipe(f32),
    /// The border between views: axis and part.
    Split(usize, f32),
    /// Enlarge the pictures by a factor around a place, both as parts of the view.
    Zoom(f32, [f32; 2]),
    /// Move the enlarged part by parts of the view's width and height.
    ShiftZoom([f32; 2]),
    /// Show the pictures in their own size again.
    ZoomOut,
    /// Show or hide a panel.
    Toggle(ComparePart),
    /// Hide the curve.
    CloseSweep,
    /// Give the active view this renderer and this value of one of its settings.
    ApplySweep {
        /// The renderer's id.
        renderer: String,
        /// The setting's id.
        setting: String,
        /// Its value, as command lines take it.
        value: String,
    },
}

/// A panel about views beside each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ComparePart {
    /// Frame times and memory.
    Times,
    /// What the views differ in.
    Why,
    /// What is at one pixel of each.
    Pixels,
}
