//! Tables of vertices and corners of faces into an object's geometry; the same for every format.
//!
//! A reader makes [`Table`]s of what the file says of its vertices, and [`Corners`] of its faces. `roles` says what each
//! scalar means; `build` makes columns (see `place` for positions and their origin); `faces` makes triangles of the corners
//! (`pointstage_texels::polygon` cuts what has more than three); then [`estimate`](crate::estimate) adds what is missing.

mod build;
mod corners;
mod faces;
mod place;
mod roles;
mod scaled;
mod table;
mod triples;

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use pointstage_texels::PictureFile;

pub(in crate::load) use build::{Built, build};
pub(in crate::load) use corners::{
    CornerLists, Corners, FaceData, FaceKind, MOST_VERTICES, Triangles, corner_from,
};
pub(crate) use place::origin_for;
pub(in crate::load) use place::{MAX_COORDINATE, Placed, relative, usable};
pub(in crate::load) use roles::Roles;
pub use scaled::PositionScale;
pub(in crate::load) use scaled::{NumberBox, numbers_of};
pub(in crate::load) use table::{
    ByteOrder, Field, RowSelection, Table, TableColumn, read_integer, read_number, write_native,
};

use super::loader::Contents;
use super::{Estimation, LoadOptions, Winding};
use crate::estimate::{Neighbours, Orientation, Polygons, complete};
use crate::geometry::{Block, Geometry};
use crate::job::{Cancelled, Job};
use crate::scene::Revision;
use crate::textures::TriangleTextures;
use crate::warnings::{WarningKind, Warnings};
use faces::{Faces, Vertices};

/// Point sets up to this size are completed from neighbours while they load.
const AUTOMATIC_SURFELS: usize = 2_000_000;

/// Why no object came of tables and corners.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(in crate::load) enum AssembleError {
    /// No vertex can be placed.
    #[error(
        "all {count} vertices have NaN or infinite coordinates, expected finite numbers; there is nothing to show, export the file again"
    )]
    NothingFinite {
        /// How many there were.
        count: u64,
    },
    /// The owner cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// What a file says of its faces.
#[derive(Debug, Default)]
pub(in crate::load) struct FileFaces {
    pub(in crate::load) corners: Vec<Corners>,
    /// What [`FaceData::pictures`] counts.
    pub(in crate::load) pictures: Vec<PictureFile>,
}

impl From<Vec<Corners>> for FileFaces {
    fn from(corners: Vec<Corners>) -> Self {
        Self {
            corners,
            pictures: Vec::new(),
        }
    }
}

/// Adds to the columns what the faces say and what the file lacks; reports progress from 0.4 on.
pub(in crate::load) fn finish(
    built: Built,
    row_count: usize,
    FileFaces { corners, pictures }: FileFaces,
    options: &LoadOptions,
    job: &Job,
    mut warnings: Warnings,
) -> Result<Contents, AssembleError> {
    let Built {
        blocks,
        origin,
        bounds,
        new_index,
        origins,
    } = built;
    let surfel_count = blocks.iter().map(Block::len).sum();
    let mut geometry = Geometry {
        blocks,
        triangles: None,
        textures: None,
        bounds,
        surfel_count,
        origins,
        revision: Revision::next(),
        framed: std::sync::OnceLock::new(),
    };
    job.set_progress(0.4);
    let (polygons, textures) = add_faces(
        &mut geometry,
        corners,
        row_count,
        new_index.as_deref(),
        options,
        job,
        &mut warnings,
    )?;
    geometry.textures = textures.and_then(|textures| textures.with(pictures));
    drop(new_index);
    job.set_progress(0.5);
    add_missing(
        &mut geometry,
        polygons.as_ref(),
        options,
        job,
        &mut warnings,
    )?;
    geometry.touch();
    job.set_progress(1.0);
    Ok(Contents {
        origin,
        world_from_object: DAffine3::IDENTITY,
        geometry,
        warnings,
    })
}

/// Adds the triangles; returns the polygons that they were cut from, if any had more corners, and what they take from pictures.
fn add_faces(
    geometry: &mut Geometry,
    corners: Vec<Corners>,
    row_count: usize,
    new_index: Option<&[u32]>,
    options: &LoadOptions,
    job: &Job,
    warnings: &mut Warnings,
) -> Result<(Option<Polygons>, Option<TriangleTextures>), Cancelled> {
    let centre = |index: u32| geometry.centre(index as usize).unwrap_or(DVec3::NAN);
    let vertices = Vertices {
        row_count,
        new_index,
        centre: &centre,
    };
    let Some(Faces {
        mut triangles,
        mut polygons,
        mut textures,
    }) = faces::resolve(corners, &vertices, job, warnings)?
    else {
        return Ok((None, None));
    };
    if options.winding == Winding::Flipped {
        for triangle in Arc::make_mut(&mut triangles) {
            triangle.swap(1, 2);
        }
        if let Some(polygons) = &mut polygons {
            polygons.flip();
        }
        for uvs in textures.iter_mut().flat_map(|textures| &mut textures.uvs) {
            uvs.swap(1, 2);
        }
        warnings.add(WarningKind::Flipped, 1);
    }
    geometry.triangles = Some(triangles);
    Ok((polygons, textures))
}

/// Completes normals and radii as far as the options say, and looks which way the mesh is wound.
pub(in crate::load) fn add_missing(
    geometry: &mut Geometry,
    polygons: Option<&Polygons>,
    options: &LoadOptions,
    job: &Job,
    warnings: &mut Warnings,
) -> Result<(), Cancelled> {
    let neighbours = match options.estimation {
        Estimation::FileOnly => return Ok(()),
        Estimation::Always => Neighbours::Use,
        Estimation::Automatic if geometry.surfel_count <= AUTOMATIC_SURFELS => Neighbours::Use,
        Estimation::Automatic | Estimation::Never => Neighbours::Leave,
    };
    let orientation = complete(
        geometry,
        polygons,
        options.face_radius,
        neighbours,
        job,
        warnings,
    )?;
    if orientation == Orientation::Inward {
        warnings.add(WarningKind::WoundInward, 1);
    }
    Ok(())
}
