//! What happens between a renderer and a picture: targets, composition, read-back, and the renderer of last resort.
//!
//! A renderer writes targets ([`targets`] is the catalogue): into textures or, on the CPU path, into the planes of
//! [`CpuTargets`]. Composition then turns them into an 8-bit picture: the colours over the background, or one target as
//! colours with a [`Legend`](legend::Legend). It exists twice, in WGSL (`shaders/compose`) and as a CPU twin, so that a
//! session without a device shows the same. [`Fallback`](fallback::Fallback) draws surfels when no plugin can.
//!
//! Nothing is dithered: the same targets give the same bytes, every time and everywhere, which comparisons rely on.

#[cfg(test)]
mod colour_vision_tests;
pub mod compose;
pub mod compose_cpu;
mod composition;
mod copied;
mod cpu_targets;
mod depth;
pub mod fallback;
pub mod highlight;
pub mod legend;
mod palette;
mod passes;
pub mod pick;
mod picture;
mod readback;
mod srgb;
mod target_set;
pub mod targets;
#[cfg(test)]
mod twin_planes;
#[cfg(test)]
mod twin_tests;

pub use composition::{Composed, Composition};
pub use cpu_targets::{CpuPlane, CpuTargets, PlaneValues};
pub use depth::eye_distance;
pub use picture::{Background, Picture, Plane, Show};
pub use target_set::{Fit, GpuTarget, TargetSet};
pub use targets::{Appearance, PlaneFormat, TargetSpec, TargetSpecError};
