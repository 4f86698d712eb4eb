//! PLY: polygon file format of Greg Turk, in text and in both binary byte orders.
//!
//! Data passes in this order. `header` parses types and counts; `plan` decides which element is for what; `body` (by
//! `binary` or `ascii`) turns vertices into tables of scalars and faces into lists of corners; `roles` finds out what each
//! scalar means; `build` makes columns of the tables; `faces` makes triangles of the corners (`polygon` cuts what has more
//! than three); then [`estimate`](crate::estimate) adds what is missing. Sizes are compared with the file before anything
//! is allocated, so a small file never takes much memory, whatever its header says.
//!
//! The format: G. Turk, *The PLY Polygon File Format*, 1994; the names of properties are those in use since (see `roles`).

mod ascii;
mod binary;
mod body;
mod build;
mod error;
mod faces;
mod header;
mod number;
mod place;
mod plan;
mod polygon;
mod roles;
mod row;
mod table;
mod text;
mod triangles;
mod words;

use std::sync::Arc;

use glam::DVec3;

pub use error::{Place, PlyError};

use body::{Body, Corners};
use build::{Built, build};
use faces::{Faces, Vertices};
use header::PlyHeader;
use roles::Roles;

use super::source::Source;
use super::{Estimation, LoadOptions, Winding};
use crate::estimate::{Neighbours, Orientation, complete};
use crate::geometry::Geometry;
use crate::job::Job;
use crate::scene::Revision;
use crate::warnings::{WarningKind, Warnings};

pub(in crate::load) use body::Stop;

/// Point sets up to this size are completed from neighbours while they load.
const AUTOMATIC_SURFELS: usize = 2_000_000;

/// The contents of a PLY file.
#[derive(Debug)]
pub(super) struct PlyContents {
    pub(super) origin: DVec3,
    pub(super) geometry: Geometry,
    pub(super) warnings: Warnings,
}

/// Reads the bytes of a PLY file.
pub(super) fn read(file: &Source, options: LoadOptions, job: &Job) -> Result<PlyContents, Stop> {
    let mut warnings = Warnings::new();
    job.set_stage("reading the file");
    let header = PlyHeader::parse(file)?;
    let uses = plan::plan(&header)?;
    let Body { tables, faces } = Body::read(file, &header, &uses, job, &mut warnings)?;
    job.set_progress(0.3);
    job.set_stage("building columns");
    // The plan found x and y, and an element's scalars all become columns.
    let roles = Roles::assign(&tables).ok_or(PlyError::NoPositions {
        found: "x or y as a list".into(),
    })?;
    let row_count = tables.first().map_or(0, |(_, table)| table.rows);
    let Built {
        blocks,
        origin,
        bounds,
        new_index,
        origins,
    } = build(&roles, row_count, options.winding, job, &mut warnings)?;
    drop(roles);
    drop(tables);
    file.release(0..file.len());
    let surfel_count = blocks.iter().map(crate::geometry::Block::len).sum();
    let mut geometry = Geometry {
        blocks,
        triangles: None,
        bounds,
        surfel_count,
        origins,
        revision: Revision::next(),
    };
    job.set_progress(0.4);
    let polygons = add_faces(
        &mut geometry,
        faces,
        row_count,
        new_index.as_deref(),
        options,
        job,
        &mut warnings,
    )?;
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
    Ok(PlyContents {
        origin,
        geometry,
        warnings,
    })
}

/// Adds the triangles; returns the polygons that they were cut from, if any had more corners.
fn add_faces(
    geometry: &mut Geometry,
    faces: Vec<Corners>,
    row_count: usize,
    new_index: Option<&[u32]>,
    options: LoadOptions,
    job: &Job,
    warnings: &mut Warnings,
) -> Result<Option<crate::estimate::Polygons>, Stop> {
    let centre = |index: u32| geometry.centre(index as usize).unwrap_or(DVec3::NAN);
    let vertices = Vertices {
        row_count,
        new_index,
        centre: &centre,
    };
    let Some(Faces {
        mut triangles,
        mut polygons,
    }) = faces::resolve(faces, &vertices, job, warnings)?
    else {
        return Ok(None);
    };
    if options.winding == Winding::Flipped {
        for triangle in Arc::make_mut(&mut triangles) {
            triangle.swap(1, 2);
        }
        if let Some(polygons) = &mut polygons {
            polygons.flip();
        }
        warnings.add(WarningKind::Flipped, 1);
    }
    geometry.triangles = Some(triangles);
    Ok(polygons)
}

/// Completes normals and radii as far as the options say, and looks which way the mesh is wound.
fn add_missing(
    geometry: &mut Geometry,
    polygons: Option<&crate::estimate::Polygons>,
    options: LoadOptions,
    job: &Job,
    warnings: &mut Warnings,
) -> Result<(), Stop> {
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
