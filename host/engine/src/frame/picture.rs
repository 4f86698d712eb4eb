//! What a frame shows, and the pictures and planes that come out of it.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

/// What is shown: the composed colours, or one target as it is, with a legend.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub enum Show {
    /// The colour target over the background.
    #[default]
    Colours,
    /// A target by its key (`normal`, `depth`, `id`, `lod`, `kind`, …).
    Target(String),
}

/// What lies behind the objects; sRGB, 0..1. In files: `"transparent"`, `{ solid = [r, g, b] }` or
/// `{ gradient = [[r, g, b], [r, g, b]] }`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Background {
    /// Nothing: the picture keeps its coverage as alpha.
    Transparent,
    /// One colour.
    Solid([f32; 3]),
    /// From top to bottom.
    Gradient([f32; 3], [f32; 3]),
}

/// An 8-bit picture, rows from the top, 4 bytes a pixel: sRGB, straight alpha.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// px.
    pub size_px: [u32; 2],
    /// Red, green, blue, alpha.
    pub rgba: Arc<[u8]>,
}

/// A target, read back.
#[derive(Clone, Debug, PartialEq)]
pub enum Plane {
    /// `channels` floats a pixel, rows from the top.
    Float {
        /// Floats a pixel.
        channels: u32,
        /// Row by row.
        values: Arc<[f32]>,
    },
    /// One number a pixel, rows from the top.
    Uint(Arc<[u32]>),
}
