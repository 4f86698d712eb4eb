//! Drawing opaque splats: which surfel is nearest at each pixel, then one colour for it.
//!
//! A renderer brings the *footprint* of a surfel: a WESL module `footprint::shape` that says which pixels a surfel covers
//! and at which depth. This crate does the rest, in two steps:
//!
//! 1. **visibility**: for each draw of the selection, the nearest surfel's id and depth per pixel; by the raster pipeline
//!    (quads, depth test) or by a compute kernel (atomic maximum of depth and id). Both decide by the footprint's
//!    functions alone, so they give the same picture.
//! 2. **shading**: for each block, one full-screen triangle that lights the visible surfels and fills the targets that
//!    were asked for. So no surfel is lit in vain, and targets that nobody wants cost nothing.
//!
//! `points` (sprites) and `surfel` (elliptical disks) are made of it. A renderer that blends, as `hqss` does, takes the first
//! step ([`VisibilityView::record_visible`]) and goes on by itself with the draws, targets and kernels that are public here.
//! It stands on the public plugin interface only.

#![forbid(unsafe_code)]

mod buffers;
mod clips;
pub mod cpu;
mod draws;
mod footprint;
mod pipelines;
mod record;
mod rectangle;
mod request;
#[cfg(test)]
mod shader_checks;
mod shading_inputs;
mod targets;
mod view;

pub use buffers::{LARGE_COUNT, Large, rows_of};
pub use clips::{CLIPPED, ClipPlace, Clips, FootprintGroups, Variants};
pub use draws::{BlockItem, DrawItem, DrawList};
pub use footprint::{Footprint, Varying};
pub use pipelines::{
    Cache, Kernels, Prepared, QUADS_PER_INSTANCE, SUMS, Source, adds_int64, blends_float32, cached,
    group_size, has_int64, is_wide, linked_variants,
};
pub use record::{KernelGroups, record_kernels, record_quads};
pub use rectangle::PixelRectangle;
pub use request::{Extent, Path, Request};
pub use shading_inputs::BLOCK_STRIDE;
pub use targets::{TargetSet, Targets, picture_texture};
pub use view::{VisibilityView, Visible};
