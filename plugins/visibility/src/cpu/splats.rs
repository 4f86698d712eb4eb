//! What a renderer of opaque splats brings for the CPU.

use super::bins::Bins;
use super::image::Rectangle;
use super::nearest::Nearest;
use super::surfels::Stage;
use core::fmt::Debug;

/// Splats that the CPU can draw: the twin of a footprint module.
pub trait Splats: Debug + Sync {
    /// Draws a stage's surfels, on so many threads; the pixels that they can reach.
    ///
    /// * `bins`, `nearest`: what they hold means nothing before. `nearest` has the picture's size; all of its bands are to be
    ///   cleared.
    fn draw(
        &self,
        stage: &Stage<'_>,
        thread_count: usize,
        bins: &mut Bins,
        nearest: &mut Nearest,
    ) -> Rectangle;
}
