//! Objects into files: PLY, which holds everything, and SFL, which PointShop3D reads.
//!
//! What a writer leaves out it says in its [`Warnings`]. What it wrote, [`load`](crate::load()) reads again into the same
//! columns; only where a column came from is forgotten. A file that is saved appears whole or not at all.

mod columns;
mod pictures;
mod ply;
mod ply_faces;
mod ply_row;
mod sfl;
mod whole_file;

use std::io;
use std::path::{Path, PathBuf};

pub use ply::write_ply;
pub use ply_row::PlyEncoding;
pub use sfl::write_sfl;

use pictures::Beside;

use crate::job::{Cancelled, Job};
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
    /// The owner cancelled it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
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

/// A format that objects are saved in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SaveFormat {
    /// PLY; see [`write_ply`].
    Ply(PlyEncoding),
    /// SFL; see [`write_sfl`].
    Sfl,
}

impl SaveFormat {
    /// The format that a file's name ends in, `.ply` or `.sfl`; PLY is binary then.
    pub fn of_name(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "ply" => Some(Self::Ply(PlyEncoding::default())),
            "sfl" => Some(Self::Sfl),
            _ => None,
        }
    }
}

/// What was saved.
#[derive(Debug)]
#[non_exhaustive]
pub struct Saved {
    /// What the file does not hold, or holds otherwise.
    pub warnings: Warnings,
    /// The files of the pictures that it names, beside it.
    pub pictures: Vec<PathBuf>,
}

/// Saves an object as a file.
///
/// The pictures of textures go beside a PLY file, as `NAME.png`, `NAME_2.png` and so on, or `.jpg`: the bytes that they were read
/// from. A file of that name that is no such picture is left as it is, and the next name taken.
///
/// Thread: any; takes seconds for large objects. Stops soon after `job` is cancelled.
///
/// # Errors
/// The file, or a picture, cannot be written, or would be larger than its format can be, or the job was cancelled. An older file
/// of this name is then as it was, and no new picture is left.
pub fn save(
    object: &Object,
    path: &Path,
    format: SaveFormat,
    job: &Job,
) -> Result<Saved, SaveError> {
    job.set_stage("writing");
    let textures = object.geometry.textures.as_ref();
    let pictures = match (format, textures) {
        (SaveFormat::Ply(_), Some(textures)) => Beside::write(path, &textures.pictures, job)?,
        _ => Beside::default(),
    };
    let warnings = whole_file::write(path, |out| match format {
        SaveFormat::Ply(encoding) => ply::write(object, encoding, &pictures.names(), job, out),
        SaveFormat::Sfl => write_sfl(object, job, out),
    })?;
    job.set_progress(1.0);
    Ok(Saved {
        warnings,
        pictures: pictures.keep(),
    })
}

/// Surfels and triangles between two looks at the cancel flag.
const ROWS_A_LOOK: usize = 1 << 14;

/// How far writing is.
struct Saving<'a> {
    job: &'a Job,
    written: usize,
    total: usize,
}

impl<'a> Saving<'a> {
    fn new(job: &'a Job, total: usize) -> Self {
        Self {
            job,
            written: 0,
            total,
        }
    }

    /// A surfel or a triangle follows.
    fn one_more(&mut self) -> Result<(), Cancelled> {
        if self.written.is_multiple_of(ROWS_A_LOOK) {
            self.job.check()?;
            self.job
                .set_progress_within(&(0.0..1.0), self.written, self.total);
        }
        self.written += 1;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_says_the_format() {
        let of = |name: &str| SaveFormat::of_name(Path::new(name));
        assert_eq!(
            of("a.PLY"),
            Some(SaveFormat::Ply(PlyEncoding::LittleEndian))
        );
        assert_eq!(of("a.b.sfl"), Some(SaveFormat::Sfl));
        assert_eq!((of("a.obj"), of("ply"), of("a")), (None, None, None));
    }
}
