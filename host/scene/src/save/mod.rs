//! Objects into files: PLY, which holds everything, and SFL, which PointShop3D reads.
//!
//! What a writer leaves out it says in its [`Warnings`]. What it wrote, [`load`](crate::load()) reads again into the same
//! columns; only where a column came from is forgotten. A file that is saved appears whole or not at all.

mod columns;
mod ply;
mod sfl;
mod whole_file;

use std::io;
use std::path::{Path, PathBuf};

pub use ply::write_ply;
pub use sfl::write_sfl;

use crate::scene::Object;
use crate::warnings::Warnings;

/// An object that cannot be saved.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SaveError {
    /// The file cannot be written.
    #[error("{}: cannot be written: {source}; check the folder, its permissions and its free space", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The stream does not take what is written to it.
    #[error("cannot be written: {0}")]
    Write(#[from] io::Error),
    /// The format cannot hold so much.
    #[error(
        "the object takes {needed} bytes as {format}, expected at most {most}; save it as PLY, or in parts"
    )]
    TooLarge {
        /// The format.
        format: &'static str,
        /// Bytes of the file.
        needed: u64,
        /// Bytes that the format can hold.
        most: u64,
    },
}

/// Saves an object as a PLY file; see [`write_ply`].
///
/// # Errors
/// The file cannot be written. An older file of this name is then as it was.
pub fn save_ply(object: &Object, path: &Path) -> Result<Warnings, SaveError> {
    whole_file::write(path, |out| Ok(write_ply(object, out)?))
}

/// Saves an object as an SFL file; see [`write_sfl`].
///
/// # Errors
/// The file cannot be written, or would be larger than an SFL file can be. An older file of this name is then as it was.
pub fn save_sfl(object: &Object, path: &Path) -> Result<Warnings, SaveError> {
    whole_file::write(path, |out| write_sfl(object, out))
}
