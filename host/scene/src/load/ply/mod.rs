//! PLY: polygon file format of Greg Turk, in text and in both binary byte orders.
//!
//! Data passes in this order. `header` parses types and counts; `plan` decides which element is for what; `body` (by
//! `binary` or `ascii`) turns vertices into tables of scalars and faces into lists of corners; of these `assemble` makes the
//! object, as for every format, with colours from pictures and faces (`colours`, as `textures` says). Sizes are compared with the
//! file before anything is allocated, so a small file never takes much memory, whatever its header says.
//!
//! The format: G. Turk, *The PLY Polygon File Format*, 1994; the names of properties are those in use since (see `roles` in
//! `assemble`).

mod ascii;
mod binary;
mod body;
mod colours;
mod error;
mod face_data;
mod header;
pub(in crate::load) mod number;
mod places;
mod plan;
mod row;
mod text;
mod textures;
mod triangles;
mod words;

pub use error::PlyError;

use body::{Body, Stop};
use colours::Found;
use header::PlyHeader;
use textures::{TEXTURES, Textures};

use super::LoadOptions;
use super::assemble::{FileFaces, Roles, build, finish};
use super::error::LoadStop;
use super::loader::{Claim, Contents, FileStart, Loader, LoaderInfo, SourceFile};
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
            info: LoaderInfo {
                settings: vec![textures::schema()],
                ..LoaderInfo::built_in("ply", "Polygon file format (PLY)", &["ply"])
            },
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
        let textures = TEXTURES.chosen(&self.info.settings, options.loader_values())?;
        read(file, textures, options, job).map_err(|stop| match stop {
            Stop::Ply(error) => LoadStop::Format(error),
            Stop::Cancelled => LoadStop::Cancelled,
        })
    }
}

/// Reads the bytes of a PLY file.
fn read(
    source: &SourceFile,
    textures: Textures,
    options: &LoadOptions,
    job: &Job,
) -> Result<Contents, Stop> {
    let file = source.source();
    let mut warnings = Warnings::new();
    job.set_stage("reading the file");
    let header = PlyHeader::parse(file)?;
    let uses = plan::plan(&header)?;
    let mut body = Body::read(file, &header, &uses, job, &mut warnings)?;
    let (named, path) = (&header.pictures, source.path());
    let Found { lights, pictures } =
        colours::find(&mut body, named, path, textures, job, &mut warnings)?;
    let Body { tables, faces } = body;
    let faces = FileFaces {
        corners: faces,
        pictures,
    };
    job.set_progress(0.3);
    job.set_stage("building columns");
    // The plan found x and y, and an element's scalars all become columns.
    let roles = Roles::assign(&tables).ok_or(PlyError::NoPositions {
        found: "x or y as a list".into(),
    })?;
    let row_count = tables.first().map_or(0, |(_, table)| table.rows);
    let mut built = build(&roles, row_count, options.winding, job, &mut warnings)?;
    if let Some(lights) = lights {
        colours::apply(&mut built, &lights);
    }
    drop(roles);
    drop(tables);
    file.release(0..file.len());
    Ok(finish(built, row_count, faces, options, job, warnings)?)
}
