//! SFL: the surfel files of PointShop3D.
//!
//! `container` reads the tree of tagged directories, `tags` their values; `sets` finds the sets of surfels, their
//! transforms and the records of the resolution that is shown; `layout` tells where each property stands in a record
//! (`property` which there are, `normal` how packed normals are); `rows` puts the records of all sets in one row, and `build`
//! (with `colours`) makes columns of them, each in one parallel pass over the mapped file. Sizes are compared with the file
//! before anything is allocated, and the sets' records together are no longer than the file, so a small file never takes much
//! memory.
//!
//! | in the file | here |
//! |---|---|
//! | right, up and back directions | positions, normals and axes are turned into x, y and z; radii stay, as in PointShop3D |
//! | transform of the only set | the object's transform; a mere translation is its origin |
//! | transforms of several sets | applied, radii by the cube root of the determinant; column `surfel_set` tells the sets apart |
//! | resolutions | the one that the file names is loaded, or the finest, or the coarsest (`resolution`) |
//! | colour model L, LA, RGB, RGBA, YUV, YUVA | sRGB with alpha |
//! | properties | see `property` |
//! | titles, units, camera, markers, feature relations, boxes | left out |
//!
//! The format: M. Zwicker, M. Pauly, O. Knoll, M. Gross, *Pointshop 3D: An Interactive System for Point-Based Surface
//! Editing*, SIGGRAPH 2002; its files were pieced together from those that its library wrote.

mod build;
mod colours;
mod container;
mod error;
mod layout;
mod normal;
mod property;
mod resolution;
mod rows;
mod sets;
mod tags;

use glam::DAffine3;

pub use error::SflError;
pub(crate) use property::{NAMED, NamedProperty, Property, SET_COLUMN};
pub(crate) use tags::Tag;

use super::LoadOptions;
use super::assemble::{AssembleError, FileFaces, finish};
use super::error::LoadStop;
use super::loader::{Claim, Contents, FileStart, Loader, LoaderInfo, SourceFile};
use super::source::Source;
use crate::job::Job;
use crate::warnings::{WarningKind, Warnings};
use resolution::{RESOLUTION, Resolution};
use rows::{Placement, Rows};
use sets::SurfelFile;

/// The loader of SFL files.
#[derive(Debug)]
pub(super) struct SflLoader {
    info: LoaderInfo,
}

impl SflLoader {
    pub(super) fn new() -> Self {
        Self {
            info: LoaderInfo {
                settings: vec![resolution::schema()],
                ..LoaderInfo::built_in("sfl", "PointShop3D surfels (SFL)", &["sfl"])
            },
        }
    }
}

impl Loader for SflLoader {
    fn info(&self) -> &LoaderInfo {
        &self.info
    }

    fn claims(&self, start: &FileStart<'_>) -> Claim {
        if start.bytes.starts_with(b"GFLF") {
            Claim::Certain
        } else {
            Claim::No
        }
    }

    fn load(
        &self,
        file: &SourceFile,
        options: &LoadOptions,
        job: &Job,
    ) -> Result<Contents, LoadStop> {
        let resolution = RESOLUTION.chosen(&self.info.settings, options.loader_values())?;
        read(file.source(), resolution, options, job)
    }
}

/// Reads the bytes of an SFL file.
fn read(
    file: &Source,
    resolution: Resolution,
    options: &LoadOptions,
    job: &Job,
) -> Result<Contents, LoadStop> {
    let mut warnings = Warnings::new();
    job.set_stage("reading the file");
    let SurfelFile {
        standard_from_file,
        sets,
    } = SurfelFile::read(file, resolution, &mut warnings)?;
    let only = match sets.as_slice() {
        [only] => Some(only),
        _ => None,
    };
    // The transform of a set is between positions in the file's axes, the object's between such in ours.
    let mut world_from_object = only.map_or(DAffine3::IDENTITY, |set| {
        standard_from_file * set.world_from_set * standard_from_file.inverse()
    });
    let mut rows = Rows::new(&sets, |set| {
        if only.is_some() {
            return Placement::new(standard_from_file, 1.0);
        }
        let radius_scale = set.world_from_set.matrix3.determinant().abs().cbrt();
        Placement::new(standard_from_file * set.world_from_set, radius_scale)
    });
    let count = rows.count;
    job.set_progress(0.1);
    let mut built = build::build(&mut rows, sets.len(), options.winding, job, &mut warnings)?;
    if count > 0 && rows.count == 0 {
        return Err(SflError::NothingFinite {
            count: count as u64,
        }
        .into());
    }
    if count == 0 {
        let text = "the file holds no surfels: there is nothing to show";
        warnings.add(WarningKind::Other(text.into()), 1);
    }
    if world_from_object.matrix3 == glam::DMat3::IDENTITY {
        built.origin += world_from_object.translation;
        world_from_object = DAffine3::IDENTITY;
    }
    drop(rows);
    file.release(0..file.len());
    let finished = finish(built, count, FileFaces::default(), options, job, warnings);
    let mut contents = finished.map_err(|error: AssembleError| LoadStop::from(error))?;
    contents.world_from_object = world_from_object;
    Ok(contents)
}
