//! Saving an image of any size: drawn tile by tile, written whole or not at all.
//!
//! [`Export`] says what is saved. [`Exporting`] does it in steps, so that a window can draw its own pictures in between:
//! it waits until the renderer is prepared, draws one tile after the other ([`tiling`]), each until it does not refine any
//! more, and hands them to a sink that writes on a thread of its own: [`png_rows`] streams bands of rows, so that no image
//! is ever in memory as a whole; [`exr_layers`] gathers all targets first, since EXR wants them at once.

mod error;
mod exporting;
mod exr_layers;
mod png_rows;
mod tiling;
mod writer;

use std::path::{Path, PathBuf};

use pointstage_engine::stage::{FrameRequest, FrameStats, Notice};

pub(crate) use error::ExportError;
pub(crate) use exporting::Exporting;

/// The form of an image's file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// The picture, 8-bit sRGB.
    Png,
    /// The values of targets, a layer each.
    Exr,
}

/// An image to save. Plain data.
#[derive(Clone, Debug)]
pub(crate) struct Export {
    /// Where it goes.
    pub(crate) path: PathBuf,
    /// In which form.
    pub(crate) format: Format,
    /// What is drawn, in the size of the image.
    pub(crate) frame: FrameRequest,
    /// Keys of the targets of an EXR file; empty for all that the renderer gives.
    pub(crate) targets: Vec<String>,
    /// What the image is made from; who drew it is added.
    pub(crate) record: serde_json::Value,
    /// The greatest side of a tile, px.
    pub(crate) most_tile_px: u32,
}

/// A tile that is drawn in one go where nobody waits for another picture, px.
pub(crate) const LARGE_TILE_PX: u32 = 4096;

/// A tile that a window can wait for where a graphics card draws, px: about as many pixels as a large screen has.
pub(crate) const SMALL_TILE_PX: u32 = 2048;

/// The same where the CPU draws, px.
pub(crate) const CPU_TILE_PX: u32 = 512;

/// An image that was saved.
#[derive(Clone, Debug)]
pub(crate) struct Saved {
    /// Where it is.
    pub(crate) path: PathBuf,
    /// The renderer that drew it.
    pub(crate) drawn_by: String,
    /// Times and counts of all tiles together.
    pub(crate) stats: FrameStats,
    /// Tiles that it was drawn in.
    pub(crate) tile_count: usize,
    /// What came up while it was drawn.
    pub(crate) notices: Vec<Notice>,
}

impl Format {
    /// The form that a file's extension stands for.
    pub(crate) fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_string_lossy().to_lowercase();
        match extension.as_str() {
            "png" => Some(Self::Png),
            "exr" => Some(Self::Exr),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests;
