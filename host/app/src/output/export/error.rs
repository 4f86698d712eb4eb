//! Why an image was not saved.

use pointstage_engine::plugins::UnknownPlugin;
use pointstage_engine::stage::FrameError;
use pointstage_scene::Cancelled;

use super::super::exr_file::ExrError;
use super::super::png_file::PngError;
use super::super::whole_file::WriteError;

/// Why an image was not saved. Nothing is left of it, and an older file of its name is still there.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ExportError {
    /// By the user.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The file.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// No tile could be drawn.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// There is no such renderer.
    #[error(transparent)]
    Renderer(#[from] UnknownPlugin),
    /// The picture's bytes.
    #[error(transparent)]
    Png(#[from] PngError),
    /// The targets' bytes.
    #[error(transparent)]
    Exr(#[from] ExrError),
    /// The renderer does not give a target that was asked for.
    #[error("renderer '{renderer}' gives no target '{key}'; it gives {given}")]
    NoTarget {
        /// Its id.
        renderer: String,
        /// The target.
        key: String,
        /// What there is.
        given: String,
    },
    /// An EXR file holds all its values in memory before it is written.
    #[error(
        "an EXR file of {width}×{height} pixels with {layers} layers needs {needed_gb:.1} GB of memory, and at most \
         {most_gb:.1} GB are taken; ask for a smaller size or for fewer targets, or save PNG, which needs little"
    )]
    TooLarge {
        /// px.
        width: u32,
        /// px.
        height: u32,
        /// Targets.
        layers: usize,
        /// What it would take.
        needed_gb: f64,
        /// What it may take.
        most_gb: f64,
    },
    /// The thread that writes the file could not be had, or ended without a word.
    #[error("writing the file stopped: {0}; save it again")]
    Writer(String),
}
