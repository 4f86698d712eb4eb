//! Keys of the host's targets.

/// Linear RGB premultiplied by coverage, and coverage: rgba16float.
pub const COLOUR: &str = "colour";
/// Reversed z, 0 where nothing was drawn: depth32float.
pub const DEPTH: &str = "depth";
/// Unit normal in view space, and 1 where there is one: rgba16float.
pub const NORMAL: &str = "normal";
/// Id of the front-most surfel, 0 for nothing: r32uint.
pub const ID: &str = "id";
/// Sum of weights: r16float.
pub const WEIGHT: &str = "weight";
/// Level of detail, 0 the root, [`NO_LEVEL`] where nothing was drawn: r8uint.
pub const LOD: &str = "lod";
/// What the `lod` target is cleared to; a renderer that clears it itself does the same.
pub const NO_LEVEL: u32 = 255;
/// What the pixel shows: [`kind`]; r8uint.
pub const KIND: &str = "kind";
/// Fragments per pixel: r16uint.
pub const OVERDRAW: &str = "overdraw";

/// Values of the `kind` target.
pub mod kind {
    /// Nothing.
    pub const NOTHING: u32 = 0;
    /// A surfel's splat.
    pub const SURFEL: u32 = 1;
    /// A triangle.
    pub const TRIANGLE: u32 = 2;
    /// A line.
    pub const LINE: u32 = 3;
}
