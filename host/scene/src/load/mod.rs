//! Files into objects.
//!
//! [`load`] shows the file's first bytes to the [`Loaders`], hands it to the one that claims it most, and returns an object
//! with counted warnings. It runs on a worker thread, reports to a [`Job`] and stops when that is cancelled. To add a
//! format here, write a [`Loader`] and enter it in `loaders`; a stranger's comes as a plugin.

mod assemble;
mod block_slots;
mod choice;
mod column_spec;
mod columns;
mod error;
pub(crate) mod fill;
mod gathered;
mod loader;
mod loaders;
pub(crate) mod memory;
mod not_read;
mod object_builder;
mod ply;
mod qs;
mod row_columns;
pub(crate) mod sfl;
pub(crate) mod source;
mod tri;

use std::path::Path;
use std::sync::Arc;

pub use assemble::PositionScale;
pub(crate) use assemble::origin_for;
pub use column_spec::{ColumnRole, ColumnSpec};
pub use error::{FormatError, LoadError, LoadStop, Place};
pub use loader::{Claim, Contents, FileStart, Loader, LoaderInfo, START_BYTES, SourceFile};
pub use loaders::{Loaders, UnknownLoader};
pub use object_builder::{BuildError, ObjectBuilder};
pub use ply::PlyError;
pub use qs::QsError;
pub use sfl::SflError;
pub use tri::TriError;

use pointstage_plugin_api::settings_schema::SettingValues;

use crate::job::Job;
use crate::scene::Object;
use crate::warnings::Warnings;

/// How to load.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadOptions {
    /// The loader that the user chose; without one, content and extension decide.
    pub loader: Option<LoaderChoice>,
    /// Whether normals and radii that the file lacks are estimated from neighbours at once.
    pub estimation: Estimation,
    /// How a vertex of a mesh gets its radius.
    pub face_radius: FaceRadius,
    /// Which side of a mesh is outside.
    pub winding: Winding,
}

impl LoadOptions {
    /// Values of the loader's own options, as far as the user gave any.
    pub fn loader_values(&self) -> &SettingValues {
        static NONE: SettingValues = SettingValues::new();
        self.loader
            .as_ref()
            .map_or(&NONE, |choice| &choice.settings)
    }
}

/// A loader that the user chose for a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoaderChoice {
    /// Its id or alias.
    pub loader: String,
    /// Values of its own options; what is absent takes its default.
    pub settings: SettingValues,
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

impl Winding {
    /// What normals of the file are multiplied by: 1 or −1.
    pub(crate) const fn sign(self) -> f64 {
        match self {
            Self::AsInFile => 1.0,
            Self::Flipped => -1.0,
        }
    }
}

/// What came out of a file.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The object, named after the file.
    pub object: Object,
    /// What read it.
    pub loader: LoaderInfo,
    /// What was done, but not as asked.
    pub warnings: Warnings,
}

/// Reads a file into an object, by the loaders that come with the program.
///
/// Thread: any; takes seconds for large files. Stops soon after `job` is cancelled.
///
/// # Errors
/// The file cannot be read, is of no known format, or says something that cannot be.
pub fn load(path: &Path, options: &LoadOptions, job: &Job) -> Result<Loaded, LoadError> {
    load_with(&Loaders::built_in(), path, options, job)
}

/// Reads a file into an object, by one of `loaders`.
///
/// Thread: any; takes seconds for large files. Stops soon after `job` is cancelled.
///
/// # Errors
/// As [`load`], and if there is no loader of the name asked for.
pub fn load_with(
    loaders: &Loaders,
    path: &Path,
    options: &LoadOptions,
    job: &Job,
) -> Result<Loaded, LoadError> {
    let span = tracing::info_span!("load", path = %path.display());
    let _entered = span.enter();
    job.check()?;
    let file = SourceFile::open(path).map_err(|source| LoadError::Io {
        path: path.to_path_buf(),
        source,
    })?;
    let loader: Arc<dyn Loader> = {
        let wanted = options.loader.as_ref();
        loaders.choose(&file, wanted.map(|choice| choice.loader.as_str()))?
    };
    let Contents {
        origin,
        world_from_object,
        geometry,
        warnings,
    } = loader
        .load(&file, options, job)
        .map_err(|stop| stop.of_file(path.to_path_buf(), loader.info()))?;
    let name = path.file_stem().map_or_else(
        || path.display().to_string(),
        |stem| stem.to_string_lossy().into_owned(),
    );
    let mut object = Object::new(name, origin, geometry);
    object.world_from_object = world_from_object;
    object.placed = world_from_object;
    object.source = Some(path.to_path_buf());
    object.loaded = Some(object.geometry.revision);
    object.loader.clone_from(&options.loader);
    tracing::debug!(
        loader = loader.info().id,
        surfels = object.geometry.surfel_count,
        triangles = object.geometry.triangle_count(),
        warnings = warnings.iter().count(),
        "loaded"
    );
    Ok(Loaded {
        object,
        loader: loader.info().clone(),
        warnings,
    })
}
