//! Well-known keys of what a renderer may report with each frame. Others are shown under their own name.

/// Surfels that the selection held.
pub const SURFELS_SELECTED: &str = "surfels_selected";
/// Splats that reached the screen.
pub const SPLATS_DRAWN: &str = "splats_drawn";
/// Triangles drawn.
pub const TRIANGLES_DRAWN: &str = "triangles_drawn";
/// Nodes of a structure that were looked at.
pub const NODES_VISITED: &str = "nodes_visited";
/// Passes recorded.
pub const PASSES: &str = "passes";
/// Time on the CPU, ms.
pub const CPU_MS: &str = "cpu_ms";
/// Bytes held on the device.
pub const BYTES: &str = "bytes";
/// Which way was taken where there are several: 0 raster, 1 compute, 2 the CPU.
pub const PATH: &str = "path";
