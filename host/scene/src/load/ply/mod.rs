//! PLY: polygon file format of Greg Turk, in text and in both binary byte orders.
//!
//! Data passes in this order. `header` parses types and counts; `plan` decides which element is for what; `body` (by
//! `binary` or `ascii`) turns vertices into tables of scalars and faces into lists of corners; of these `assemble` makes the
//! object, as for every format. Sizes are compared with the file before anything is allocated, so a small file never takes
//! much memory, whatever its header says.
//!
//! The format: G. Turk, *The PLY Polygon File Format*, 1994; the names of properties are those in use since (see `roles` in
//! `assemble`).

mod ascii;
mod binary;
mod body;
mod error;
mod header;
pub(in crate::load) mod number;
mod plan;
mod row;
mod text;
mod triangles;
mod words;

pub use error::PlyError;

use body::{Body, Stop};
use header::PlyHeader;

use super::LoadOptions;
use super::assemble::{Roles, build, finish};
use super::error::LoadStop;
use super::loader::{Claim, Contents, FileStart, Loader, LoaderInfo, SourceFile};
use super::source::Source;
use crate::job::Job;
use crate::warnings::Warnings;

/// The loader of PLY files.
#[derive(Debug)]
pub(super) struct PlyLoader {
    info: LoaderInfo,
}

impl PlyLoader {
    pub(super) fn new() -> Self {
        Self {
            info: LoaderInfo::built_in("ply", "Polygon file format (PLY)", &["ply"]),
        }
    }
}

impl Loader for PlyLoader {
    fn info(&self) -> &LoaderInfo {
        &self.info
    }

    fn claims(&self, start: &FileStart<'_>) -> Claim {
        if start.bytes.starts_with(b"ply") {
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
        read(file.source(), options, job).map_err(|stop| match stop {
            Stop::Ply(error) => LoadStop::Format(error),
            Stop::Cancelled => LoadStop::Cancelled,
        })
    }
}

/// Reads the bytes of a PLY file.
fn read(file: &Source, options: &LoadOptions, job: &Job) -> Result<Contents, Stop> {
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
    let built = build(&roles, row_count, options.winding, job, &mut warnings)?;
    drop(roles);
    drop(tables);
    file.release(0..file.len());
    Ok(finish(built, row_count, faces, options, job, warnings)?)
}
