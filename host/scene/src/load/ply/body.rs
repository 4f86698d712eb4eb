//! What a body holds: tables of vertices and lists of corners, whatever the encoding.

use std::sync::Arc;

use super::ascii::read_ascii;
use super::binary::read_binary;
use super::error::PlyError;
use super::header::{Encoding, PlyHeader};
use super::plan::{ElementUse, FaceKind};
use super::table::{ByteOrder, Table};
use crate::job::{Cancelled, Job};
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

/// Corners of an element's faces, as the file has them; not yet compared with the vertices.
#[derive(Debug)]
pub(super) enum Corners {
    /// Every row is a triangle.
    Triangles(Triangles),
    /// Rows of any length.
    Lists(CornerLists),
}

/// Rows of three corners.
#[derive(Debug)]
pub(super) struct Triangles {
    pub(super) corners: Arc<[[u32; 3]]>,
    /// Largest corner.
    pub(super) max_corner: u32,
    /// Triangles with a corner twice.
    pub(super) degenerate_count: u64,
}

/// Rows of any number of corners.
#[derive(Debug)]
pub(super) struct CornerLists {
    pub(super) kind: FaceKind,
    /// Length of each row.
    pub(super) lengths: Vec<u32>,
    /// Corners of all rows: [`STRIP_END`] for −1, [`NO_CORNER`] for what no vertex can be.
    pub(super) corners: Vec<u32>,
    /// Rows that have holes.
    pub(super) with_holes: u64,
}

/// −1 in the file.
pub(super) const STRIP_END: u32 = u32::MAX;

/// Any other number that is no index of a vertex; the plan has fewer vertices than this.
pub(super) const NO_CORNER: u32 = u32::MAX - 1;

/// A number of a corner list as [`CornerLists::corners`] holds it.
#[inline]
pub(super) fn corner_from(number: i64) -> u32 {
    if number == -1 {
        STRIP_END
    } else {
        u32::try_from(number).map_or(NO_CORNER, |corner| corner.min(NO_CORNER))
    }
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
