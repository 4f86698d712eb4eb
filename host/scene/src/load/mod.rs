//! Files into objects.
//!
//! [`load`] looks at the file's first bytes, hands it to the loader of that format, and returns an object with counted
//! warnings. It runs on a worker thread, reports to a [`Job`] and stops when that is cancelled.

pub(crate) mod fill;
mod ply;
pub(crate) mod source;

use std::path::{Path, PathBuf};

pub use ply::{Place, PlyError};
use ply::{PlyContents, Stop};
use source::Source;

use crate::job::{Cancelled, Job};
use crate::scene::Object;
use crate::warnings::Warnings;

/// How to load.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LoadOptions {
    /// Whether normals and radii that the file lacks are estimated from neighbours at once.
    pub estimation: Estimation,
    /// How a vertex of a mesh gets its radius.
    pub face_radius: FaceRadius,
    /// Which side of a mesh is outside.
    pub winding: Winding,
}

/// Whether to estimate normals and radii of point sets while loading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Estimation {
    /// Below 2 M surfels.
    #[default]
    Automatic,
    /// Whatever it takes.
    Always,
    /// Not while loading; the points can be shown first and estimated later. Faces still give normals and radii.
    Never,
    /// Nothing at all beyond what the file says, not even from faces.
    FileOnly,
}

/// Radius of a vertex of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FaceRadius {
    /// That of the smallest circle enclosing a face, the largest over the incident faces: the disks at a face's corners
    /// cover it.
    #[default]
    EnclosingCircle,
    /// Half the longest incident edge: disks at the ends of an edge touch. Leaves a tenth of an equilateral face open.
    EdgeTouch,
}

/// Which side of a mesh is outside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Winding {
    /// As the file says: counter-clockwise seen from outside.
    #[default]
    AsInFile,
    /// The other side: faces and normals are turned around.
    Flipped,
}

/// What came out of a file.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The object, named after the file.
    pub object: Object,
    /// What was done, but not as asked.
    pub warnings: Warnings,
}

/// A file that cannot be loaded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// The file cannot be read.
    #[error("{}: cannot be read: {source}; check the path and its permissions", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// No loader knows the file.
    #[error("{}: starts with {found}, expected 'ply'; this program reads PLY files, convert the file to PLY", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// Its first bytes, escaped.
        found: String,
    },
    /// The file says something that cannot be.
    #[error("{}, {source}", path.display())]
    Ply {
        /// The file.
        path: PathBuf,
        /// What.
        source: PlyError,
    },
    /// The owner cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Reads a file into an object.
///
/// Thread: any; takes seconds for large files. Stops soon after `job` is cancelled.
///
/// # Errors
/// The file cannot be read, is of no known format, or says something that cannot be.
pub fn load(path: &Path, options: &LoadOptions, job: &Job) -> Result<Loaded, LoadError> {
    let span = tracing::info_span!("load", path = %path.display());
    let _entered = span.enter();
    job.check()?;
    let file = Source::open(path).map_err(|source| LoadError::Io {
        path: path.to_path_buf(),
        source,
    })?;
    if !file.starts_with(b"ply") {
        let start = &file[..file.len().min(16)];
        let found = if start.is_empty() {
            "nothing (the file is empty)".to_owned()
        } else {
            format!("'{}'", start.escape_ascii())
        };
        return Err(LoadError::UnknownFormat {
            path: path.to_path_buf(),
            found,
        });
    }
    let PlyContents {
        origin,
        geometry,
        warnings,
    } = ply::read(&file, *options, job).map_err(|stop| match stop {
        Stop::Ply(source) => LoadError::Ply {
            path: path.to_path_buf(),
            source: *source,
        },
        Stop::Cancelled => LoadError::Cancelled(Cancelled),
    })?;
    let name = path.file_stem().map_or_else(
        || path.display().to_string(),
        |stem| stem.to_string_lossy().into_owned(),
    );
    let mut object = Object::new(name, origin, geometry);
    object.source = Some(path.to_path_buf());
    tracing::debug!(
        surfels = object.geometry.surfel_count,
        triangles = object.geometry.triangle_count(),
        warnings = warnings.iter().count(),
        "loaded"
    );
    Ok(Loaded { object, warnings })
}
