//! QSplat: trees of bounding spheres, version 11.
//!
//! A file is fragments one behind the other: comments, and models. Of each model the leaves are loaded as surfels, with the
//! sphere's centre and radius, the normal and the colour; inner nodes, which are coarser versions, are left out. `tree` walks
//! to the leaves, `codes` tells what the bits of a node mean. No more nodes are visited than the file has room for, so a small
//! file never takes much memory.
//!
//! The tree: S. Rusinkiewicz, M. Levoy, *QSplat: A Multiresolution Point Rendering System for Large Meshes*, SIGGRAPH 2000;
//! its bits in the file are those of the authors' program.

mod codes;
mod error;
mod tree;

use glam::DVec3;
use pointstage_plugin_api::columns::{colour_from_bytes, encode_normal};
use pointstage_plugin_api::lines::excerpt;

pub use error::QsError;

use super::assemble::{Built, FileFaces, finish, origin_for};
use super::columns::Columns;
use super::error::LoadStop;
use super::loader::{Claim, Contents, FileStart, Loader, LoaderInfo, SourceFile};
use super::source::Source;
use super::{LoadOptions, Winding};
use crate::bounds::Bounds;
use crate::geometry::{Origins, Provenance};
use crate::job::Job;
use crate::warnings::{WarningKind, Warnings};
use tree::{MODEL_HEADER_BYTES, Model, u32_at};

/// What every fragment starts with: the format and its version.
const MAGIC: &[u8; 8] = b"QSplat11";

/// Bytes of the header that all fragments have.
const HEADER_BYTES: usize = 20;

/// Option bits of a fragment.
const HAS_COLOURS: u32 = 1;
const IS_COMMENT: u32 = 2;

/// The loader of QSplat files.
#[derive(Debug)]
pub(super) struct QsLoader {
    info: LoaderInfo,
}

impl QsLoader {
    pub(super) fn new() -> Self {
        Self {
            info: LoaderInfo::built_in("qs", "QSplat trees (QS)", &["qs"]),
        }
    }
}

impl Loader for QsLoader {
    fn info(&self) -> &LoaderInfo {
        &self.info
    }

    fn claims(&self, start: &FileStart<'_>) -> Claim {
        // Of other versions, the error says more than that nobody knows the file.
        if start.bytes.starts_with(b"QSplat") {
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
        read(file.source(), options, job)
    }
}

/// The models of a file.
fn models(file: &[u8]) -> Result<Vec<Model<'_>>, QsError> {
    let mut models = Vec::new();
    let mut start = 0;
    while start < file.len() || start == 0 {
        let rest = file.get(start..).unwrap_or_default();
        let byte = start as u64;
        if !rest.starts_with(MAGIC) {
            return Err(QsError::NotQSplat {
                byte,
                found: excerpt(&rest[..rest.len().min(MAGIC.len())]),
            });
        }
        let length = u32_at(rest, 8) as usize;
        let least = if u32_at(rest, 16) & IS_COMMENT == 0 {
            MODEL_HEADER_BYTES
        } else {
            HEADER_BYTES
        };
        if rest.len() < least || length < least {
            return Err(QsError::BeyondEnd {
                byte,
                what: "the header of a fragment",
                length: least as u64,
                found: length.min(rest.len()) as u64,
                whole: "it or of the file",
            });
        }
        let Some(fragment) = rest.get(..length) else {
            return Err(QsError::BeyondEnd {
                byte,
                what: "a fragment",
                length: length as u64,
                found: rest.len() as u64,
                whole: "the file",
            });
        };
        let options = u32_at(fragment, 16);
        if options & IS_COMMENT == 0 {
            let leaf_count = u32_at(fragment, 12);
            models.push(Model::read(
                fragment,
                byte,
                leaf_count,
                options & HAS_COLOURS != 0,
            )?);
        }
        start += length;
    }
    Ok(models)
}

/// Reads the bytes of a QSplat file.
fn read(file: &Source, options: &LoadOptions, job: &Job) -> Result<Contents, LoadStop> {
    let mut warnings = Warnings::new();
    job.set_stage("reading the file");
    let models = models(file)?;
    let around = models.iter().fold(Bounds::EMPTY, |bounds, model| {
        let reach = DVec3::splat(model.root.radius);
        bounds
            .with_point(model.root.centre - reach)
            .with_point(model.root.centre + reach)
    });
    let origin = origin_for(&around);
    let mut columns = Columns::default();
    let mut bounds = Bounds::EMPTY;
    let mut without_radius = 0;
    let sign = options.winding.sign();
    let any_colours = models.iter().any(|model| model.has_colours);
    for model in &models {
        let before = columns.position_radius.len();
        let mut groups = 0_u32;
        model.leaves(
            |_| {
                groups = groups.wrapping_add(1);
                if groups.is_multiple_of(1 << 14) {
                    job.check().map_err(LoadStop::from)
                } else {
                    Ok(())
                }
            },
            |leaf| {
                let local = (leaf.sphere.centre - origin).as_vec3();
                let radius = leaf.sphere.radius as f32;
                without_radius += u64::from(radius <= 0.0);
                bounds = bounds.with_point(local.as_dvec3());
                columns
                    .position_radius
                    .push([local.x, local.y, local.z, radius]);
                columns
                    .normal
                    .push(encode_normal((leaf.normal * sign).as_vec3()));
                if any_colours {
                    let [red, green, blue] = leaf.rgb;
                    columns
                        .colour
                        .push(colour_from_bytes([red, green, blue, 255]));
                }
            },
        )?;
        let found = columns.position_radius.len() - before;
        if found != model.leaf_count as usize {
            let text = "a model has another number of points than its header says";
            warnings.add(WarningKind::Other(text.into()), 1);
        }
    }
    let count = columns.position_radius.len();
    if count == 0 {
        return Err(QsError::Nothing.into());
    }
    if options.winding == Winding::Flipped {
        warnings.add(WarningKind::Flipped, 1);
    }
    warnings.add(WarningKind::UnusableRadiiReplaced, without_radius);
    let origins = Origins {
        normals: Provenance::FromFile,
        radii: if without_radius < count as u64 {
            Provenance::FromFile
        } else {
            Provenance::Missing
        },
        colours: if any_colours {
            Provenance::FromFile
        } else {
            Provenance::Missing
        },
        axes: Provenance::Missing,
    };
    file.release(0..file.len());
    let built = Built {
        blocks: columns.into_blocks(),
        origin,
        bounds,
        new_index: None,
        origins,
    };
    Ok(finish(
        built,
        count,
        FileFaces::default(),
        options,
        job,
        warnings,
    )?)
}
