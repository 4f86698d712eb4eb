//! Intents about what is under the pointer.

/// What to look at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum InspectIntent {
    /// Keep the surfel at this pixel of the picture, and list all that is known of it.
    Pin([u32; 2]),
    /// Let go of the kept surfel.
    Unpin,
    /// Turn around the surfel at this pixel of the picture.
    PivotOn([u32; 2]),
}
