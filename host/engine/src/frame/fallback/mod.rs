//! The renderer of last resort: opaque lit surfels on the CPU, native Rust, no plugin and no device.
//!
//! Every surfel is drawn as its disc in perspective, nothing is culled, and the nearest wins. Two passes:
//!
//! 1. *Visibility* ([`visibility`]): all threads splat surfels into one buffer of atomics, depth in the upper and the
//!    surfel's number of this frame in the lower half. The greatest value wins, so the result depends neither on the
//!    order of the surfels (but for equal depths) nor on the number of threads.
//! 2. *Shading* ([`shading`]): each pixel looks its surfel up, lights it and writes the requested planes.
//!
//! It takes what a plugin takes, `FrameUniform` and `DrawRecord`s with their columns on the CPU, so that it draws under
//! any selection. It draws with square atomics rather than with tiles and bins because that is shorter, and fast enough:
//! see `benches/frame.rs`.
//!
//! It departs from finer renderers on purpose: no blending, no antialiasing, circular discs where surfels have axes, and
//! splats end at [`MAX_HALF_EXTENT_PX`].

mod draws;
mod lighting;
mod shading;
mod splat;
mod visibility;

use pointstage_plugin_api::abi::{DrawRecord, FrameUniform};

use super::cpu_targets::CpuTargets;
use super::targets::{COLOUR, DEPTH, ID, KIND, LOD, NORMAL};
use draws::Draws;
use visibility::VisibilityBuffer;

pub use splat::MAX_HALF_EXTENT_PX;

/// The targets that the fallback writes; others keep their clear values.
pub const TARGETS: [&str; 6] = [COLOUR, DEPTH, NORMAL, ID, KIND, LOD];

/// The built-in renderer of one viewport. It keeps nothing from frame to frame but memory.
#[derive(Debug, Default)]
pub struct Fallback {
    visible: VisibilityBuffer,
}

/// What a frame of the fallback drew.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Drawn {
    /// Surfels that were splatted, in view or not.
    pub surfel_count: u64,
    /// Surfels left out because a coordinate or the radius is not finite.
    pub broken_surfel_count: u64,
    /// Draws left out because their surfel numbers are on the device alone, or their columns do not fit the layout.
    pub unreadable_draw_count: u32,
    /// Whether `should_stop` ended the frame before all surfels were drawn.
    pub stopped: bool,
}

impl Fallback {
    /// Draws into cleared planes. Planes of targets that are not in [`TARGETS`] are left alone.
    ///
    /// Thread: any; uses the threads of the current rayon pool. `should_stop` is asked now and then by all of them.
    pub fn draw(
        &mut self,
        frame: &FrameUniform,
        draws: &[DrawRecord<'_>],
        targets: &mut CpuTargets,
        should_stop: &(dyn Fn() -> bool + Sync),
    ) -> Drawn {
        let (draws, unreadable_draw_count) = Draws::readable(draws);
        self.visible.fit(targets.size_px());
        let mut drawn = self.visible.splat_all(frame, &draws, should_stop);
        drawn.unreadable_draw_count = unreadable_draw_count;
        shading::shade(&self.visible, frame, &draws, targets);
        drawn
    }
}

#[cfg(test)]
mod tests;
