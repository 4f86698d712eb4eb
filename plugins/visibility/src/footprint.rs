//! What a renderer brings: its footprint module.

use pointstage_plugin_api::wgsl::Module;

/// The footprint of a renderer, in WESL, and how the raster path carries it.
///
/// The module has the path `footprint::shape`, binds its settings as `@group(2) @binding(0) var<uniform>`, and declares
///
/// ```text
/// struct Footprint { number: u32, pixels: vec4i, .. }            surfel's place in the block; first pixel, one past the last
/// fn footprint_of(index: u32) -> Footprint                       of the draw's index-th surfel, cut to the target
/// fn footprint_covers(footprint: Footprint, pixel: vec2f) -> bool
/// fn footprint_depth(footprint: Footprint, pixel: vec2f) -> f32   linear in the pixel; outside 0..1 it is not visible
/// Varying::Flat:    fn footprint_flat(footprint) -> vec3f,          fn flat_covers(flat: vec3f, pixel: vec2f) -> bool
/// Varying::Linear:  fn footprint_linear(footprint, pixel) -> vec3f,  fn linear_covers(linear: vec3f) -> bool
/// Varying::Both:    both functions of footprints, and              fn both_cover(flat, linear, depth: f32) -> bool
/// ```
///
/// A footprint whose renderer cuts surfels off at clip lines ([`crate::Prepared::clipped_by`]) knows the feature `clipped`: its
/// linear numbers are (u, v, 1) / w, a member `clip: lib::clip::ClipLines` of `Footprint` is in their units, taken from
/// `@group(2) @binding(1) var<storage, read>`, and `footprint_covers` heeds it.
#[derive(Clone, Copy, Debug)]
pub struct Footprint {
    /// The renderer's name, for labels.
    pub name: &'static str,
    /// The module's text.
    pub source: &'static str,
    /// How fragments learn whether they are covered.
    pub varying: Varying,
    /// Size of the settings' uniform; bytes.
    pub uniform_size: u64,
}

/// How the raster path's fragments learn whether they are covered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Varying {
    /// By three numbers that are the same for the whole splat.
    Flat,
    /// By three numbers that are linear on the screen.
    Linear,
    /// By three of each.
    Both,
}

impl Footprint {
    /// The module, as the passes import it.
    pub(crate) fn module(&self) -> Module<'static> {
        Module::new("footprint::shape", self.source)
    }
}
