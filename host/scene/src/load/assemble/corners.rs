//! Corners of faces as a file has them, not yet compared with the vertices.

use std::sync::Arc;

/// Corners of some faces of a file.
#[derive(Debug)]
pub(in crate::load) enum Corners {
    /// Every row is a triangle.
    Triangles(Triangles),
    /// Rows of any length.
    Lists(CornerLists),
}

/// Rows of three corners.
#[derive(Debug)]
pub(in crate::load) struct Triangles {
    pub(in crate::load) corners: Arc<[[u32; 3]]>,
    /// Largest corner.
    pub(in crate::load) max_corner: u32,
    /// Triangles with a corner twice.
    pub(in crate::load) degenerate_count: u64,
}

/// Rows of any number of corners.
#[derive(Debug)]
pub(in crate::load) struct CornerLists {
    pub(in crate::load) kind: FaceKind,
    /// Length of each row.
    pub(in crate::load) lengths: Vec<u32>,
    /// Corners of all rows: [`STRIP_END`] for −1, [`NO_CORNER`] for what no vertex can be.
    pub(in crate::load) corners: Vec<u32>,
    /// Rows that have holes.
    pub(in crate::load) with_holes: u64,
    /// What rows say beside.
    pub(in crate::load) data: FaceData,
}

/// What faces say of their colour. What a file does not say stays empty.
#[derive(Clone, Debug, Default)]
pub(in crate::load) struct FaceData {
    /// Texture coordinates of each corner; NaN for those that a face leaves out. A reader may hold them as its file does, but
    /// hands them over with v from the top of the picture.
    pub(in crate::load) uvs: Vec<[f32; 2]>,
    /// Which of the file's pictures each face takes; of one that lacks, none is taken.
    pub(in crate::load) pictures: Vec<u32>,
    /// Colour of each face, sRGB with straight alpha, 0 to 1.
    pub(in crate::load) colours: Vec<[f32; 4]>,
}

impl FaceData {
    /// Takes over what follows.
    pub(in crate::load) fn append(&mut self, mut other: Self) {
        self.uvs.append(&mut other.uvs);
        self.pictures.append(&mut other.pictures);
        self.colours.append(&mut other.colours);
    }
}

/// How a list of corners is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::load) enum FaceKind {
    /// A row is one polygon.
    Polygons,
    /// A row is triangle strips, apart by −1.
    Strips,
}

/// −1 in the file.
pub(in crate::load) const STRIP_END: u32 = u32::MAX;

/// Any other number that is no index of a vertex; no file has so many vertices.
pub(in crate::load) const NO_CORNER: u32 = u32::MAX - 1;

/// More vertices than this are refused, so that an index and the two marks above fit a `u32`.
pub(in crate::load) const MOST_VERTICES: u64 = (u32::MAX - 15) as u64;

/// A number of a corner list as [`CornerLists::corners`] holds it.
#[inline]
pub(in crate::load) fn corner_from(number: i64) -> u32 {
    if number == -1 {
        STRIP_END
    } else {
        u32::try_from(number).map_or(NO_CORNER, |corner| corner.min(NO_CORNER))
    }
}
