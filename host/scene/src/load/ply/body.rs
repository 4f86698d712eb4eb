//! What a body holds: tables of vertices and lists of corners, whatever the encoding.

use super::ascii::read_ascii;
use super::binary::read_binary;
use super::error::PlyError;
use super::header::{Encoding, PlyHeader};
use super::plan::ElementUse;
use crate::job::{Cancelled, Job};
use crate::load::assemble::{AssembleError, ByteOrder, Corners, Table};
use crate::load::source::Source;
use crate::warnings::Warnings;

/// The body of a file.
#[derive(Debug, Default)]
pub(super) struct Body<'a> {
    /// Elements of vertices, with their names.
    pub(super) tables: Vec<(&'a str, Table<'a>)>,
    /// Elements of faces.
    pub(super) faces: Vec<Corners>,
}

/// Why reading stopped.
#[derive(Debug, PartialEq)]
pub(in crate::load) enum Stop {
    Ply(Box<PlyError>),
    Cancelled,
}

impl From<PlyError> for Stop {
    fn from(error: PlyError) -> Self {
        Self::Ply(Box::new(error))
    }
}

impl From<Cancelled> for Stop {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl From<AssembleError> for Stop {
    fn from(error: AssembleError) -> Self {
        match error {
            AssembleError::NothingFinite { count } => PlyError::NothingFinite { count }.into(),
            AssembleError::Cancelled(_) => Self::Cancelled,
        }
    }
}

impl<'a> Body<'a> {
    /// Reads what `uses` asks for.
    pub(super) fn read(
        file: &'a Source,
        header: &'a PlyHeader,
        uses: &[ElementUse],
        job: &Job,
        warnings: &mut Warnings,
    ) -> Result<Self, Stop> {
        match header.encoding {
            Encoding::Ascii => read_ascii(file, header, uses, job, warnings),
            Encoding::LittleEndian => {
                read_binary(file, header, uses, ByteOrder::Little, job, warnings)
            }
            Encoding::BigEndian => read_binary(file, header, uses, ByteOrder::Big, job, warnings),
        }
    }
}
