//! An object from columns that a loader hands over in runs; what every loader but PLY's own uses.

use std::sync::Arc;

use pointstage_texels::PictureFile;
use rayon::prelude::*;

use super::LoadOptions;
use super::assemble::{
    CornerLists, Corners, FaceData, FaceKind, FileFaces, MOST_VERTICES, PositionScale, Triangles,
    finish,
};
use super::column_spec::{ColumnRole, ColumnSpec};
use super::error::LoadStop;
use super::loader::Contents;
use super::row_columns::RowColumns;
use crate::geometry::ScalarType;
use crate::job::Job;
use crate::textures::NO_PICTURE;
use crate::warnings::{WarningKind, Warnings};

/// A loader that does not keep to what it declared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// A column of a role has the wrong number of components.
    #[error("a column of role {role:?} cannot have {components} components")]
    Components {
        /// Its role.
        role: ColumnRole,
        /// What was declared.
        components: u32,
    },
    /// Positions of another type than I32 are to be scaled.
    #[error("positions can be scaled if they are whole numbers of 32 bits, found {scalar:?}")]
    Scale {
        /// What was declared.
        scalar: ScalarType,
    },
    /// A role, or a name, is declared twice, or there is no position.
    #[error("the columns need one position, and each other role and name at most once: {problem}")]
    Columns {
        /// Which one is wrong.
        problem: String,
    },
    /// Rows without all columns, or with bytes that are not as long as they should be.
    #[error("{rows} surfels of column {column} take {expected} bytes, got {found}")]
    Length {
        /// Surfels handed over.
        rows: u64,
        /// Number of the column, from 0; that of the first one that is missing.
        column: usize,
        /// Bytes that it should have.
        expected: u64,
        /// Bytes that it has.
        found: u64,
    },
    /// The lengths of polygons do not add up to their corners.
    #[error("polygons of {expected} corners in all came with {found} corners")]
    Corners {
        /// Sum of the lengths.
        expected: u64,
        /// Corners handed over.
        found: u64,
    },
    /// Textures of polygons that are none, or of no polygons.
    #[error("textures of polygons: {problem}")]
    Textures {
        /// What does not fit.
        problem: String,
    },
    /// More surfels than an index can name.
    #[error("the file has more than {MOST_VERTICES} surfels; split it")]
    TooMany,
    /// There is nothing to show.
    #[error("the file holds no points and no vertices; there is nothing to show")]
    Nothing,
}

/// Collects columns and faces, checks their lengths, and makes an object of them.
#[derive(Debug)]
pub struct ObjectBuilder {
    columns: RowColumns,
    /// Lengths of the polygons; none while all are triangles.
    lengths: Option<Vec<u32>>,
    corners: Vec<u32>,
    pictures: Vec<PictureFile>,
    /// Of the first polygons.
    textures: FaceData,
    /// What came first, if it was triangles; where nothing else comes, they need not be copied again.
    first_triangles: Option<Arc<[[u32; 3]]>>,
    warnings: Warnings,
}

/// Triangles whose corners are compared at once.
const TRIANGLES_A_PIECE: usize = 1 << 14;

impl ObjectBuilder {
    /// A builder of an object with these columns.
    ///
    /// # Errors
    /// There is no position, something is declared twice, or a column cannot have so many components.
    pub fn new(specs: Vec<ColumnSpec>) -> Result<Self, BuildError> {
        Ok(Self {
            columns: RowColumns::new(specs)?,
            lengths: None,
            corners: Vec::new(),
            pictures: Vec::new(),
            textures: FaceData::default(),
            first_triangles: None,
            warnings: Warnings::new(),
        })
    }

    /// Says what the numbers of the positions, which must be I32, stand for.
    ///
    /// # Errors
    /// They are of another type; nothing is noted then.
    pub fn scale_positions(&mut self, scale: PositionScale) -> Result<(), BuildError> {
        self.columns.scale_positions(scale)
    }

    /// Makes room for surfels that are announced, in memory of `most_bytes` at most; a hint, of which no more is believed than a
    /// few million at once. Without effect once some have come. Positions that are scaled take less memory if their scale was given
    /// before.
    pub fn reserve(&mut self, rows: u64, most_bytes: u64) {
        self.columns.reserve(rows, most_bytes);
    }

    /// Surfels handed over so far.
    pub fn rows(&self) -> usize {
        self.columns.rows()
    }

    /// Adds `rows` surfels: the bytes of each column in the order of their declaration, surfel by surfel, native byte order.
    ///
    /// # Errors
    /// A column is missing or of another length, or there are too many surfels; nothing is added then.
    pub fn add_rows(&mut self, rows: usize, columns: &[&[u8]]) -> Result<(), BuildError> {
        self.columns.add(rows, columns)
    }

    /// Adds triangles, of surfels counted from 0. What names none is dropped and counted in the end.
    pub fn add_triangles(&mut self, triangles: &[[u32; 3]]) {
        if triangles.is_empty() {
            return;
        }
        if self.corners.is_empty() && self.lengths.is_none() && self.first_triangles.is_none() {
            self.first_triangles = Some(triangles.into());
            return;
        }
        self.spill_first_triangles();
        if let Some(lengths) = &mut self.lengths {
            lengths.resize(lengths.len() + triangles.len(), 3);
        }
        self.corners.extend_from_slice(triangles.as_flattened());
    }

    /// Puts the first triangles with those that follow.
    fn spill_first_triangles(&mut self) {
        if let Some(first) = self.first_triangles.take() {
            self.corners.extend_from_slice(first.as_flattened());
        }
    }

    /// Adds polygons: the corners of each, one after the other. They are cut into triangles in the end.
    ///
    /// # Errors
    /// The lengths do not add up to the corners; nothing is added then.
    pub fn add_polygons(&mut self, lengths: &[u32], corners: &[u32]) -> Result<(), BuildError> {
        let expected: u64 = lengths.iter().map(|length| u64::from(*length)).sum();
        if expected != corners.len() as u64 {
            return Err(BuildError::Corners {
                expected,
                found: corners.len() as u64,
            });
        }
        self.spill_first_triangles();
        if self.lengths.is_none() && lengths.iter().any(|length| *length != 3) {
            self.lengths = Some(vec![3; self.corners.len() / 3]);
        }
        if let Some(own) = &mut self.lengths {
            own.extend_from_slice(lengths);
        }
        self.corners.extend_from_slice(corners);
        Ok(())
    }

    /// Keeps a picture with the object; its number.
    pub fn add_picture(&mut self, name: &str, file: &[u8]) -> u32 {
        self.pictures.push(PictureFile {
            name: name.into(),
            bytes: file.into(),
        });
        self.pictures.len() as u32 - 1
    }

    /// Says which pictures the next polygons that have none yet take, in the order in which polygons and triangles were added:
    /// the number of each one's, or [`NO_PICTURE`](crate::NO_PICTURE), and texture coordinates of all their corners, v from the
    /// top of the picture.
    ///
    /// # Errors
    /// There are not so many polygons, or their corners are not as many as the coordinates, or there is no such picture;
    /// nothing is noted then.
    pub fn add_polygon_pictures(
        &mut self,
        pictures: &[u32],
        uvs: &[[f32; 2]],
    ) -> Result<(), BuildError> {
        let problem = |problem: String| Err(BuildError::Textures { problem });
        self.spill_first_triangles();
        let first = self.textures.pictures.len();
        let polygons = first..first + pictures.len();
        let corners = match &self.lengths {
            None => (polygons.end <= self.corners.len() / 3).then_some(3 * pictures.len() as u64),
            Some(lengths) => lengths
                .get(polygons)
                .map(|lengths| lengths.iter().map(|length| u64::from(*length)).sum()),
        };
        let Some(corners) = corners else {
            return problem(format!("there are no {} more of them", pictures.len()));
        };
        if corners != uvs.len() as u64 {
            return problem(format!(
                "{corners} corners came with {} coordinates",
                uvs.len()
            ));
        }
        let lacks =
            |picture: &u32| *picture != NO_PICTURE && *picture as usize >= self.pictures.len();
        if let Some(picture) = pictures.iter().find(|picture| lacks(picture)) {
            return problem(format!("there is no texture {picture}"));
        }
        self.textures.pictures.extend_from_slice(pictures);
        self.textures.uvs.extend_from_slice(uvs);
        Ok(())
    }

    /// Notes what was done, but not as asked.
    pub fn warn(&mut self, kind: WarningKind, count: u64) {
        self.warnings.add(kind, count);
    }

    /// Makes the object: chooses its origin, cuts polygons, completes normals and radii as far as `options` say. Reports
    /// progress from 0.4 on.
    ///
    /// # Errors
    /// There is nothing to show, or the job was cancelled.
    pub fn finish(mut self, options: &LoadOptions, job: &Job) -> Result<Contents, LoadStop> {
        let rows = self.rows();
        if rows == 0 {
            return Err(BuildError::Nothing.into());
        }
        job.set_stage("building columns");
        let faces = FileFaces {
            corners: self.take_faces(),
            pictures: std::mem::take(&mut self.pictures),
        };
        let mut warnings = self.warnings;
        let built = self.columns.build(options.winding, job, &mut warnings)?;
        Ok(finish(built, rows, faces, options, job, warnings)?)
    }

    fn take_faces(&mut self) -> Vec<Corners> {
        let corners = std::mem::take(&mut self.corners);
        if let Some(triangles) = self.first_triangles.take() {
            return vec![Corners::Triangles(counted(triangles))];
        }
        if corners.is_empty() {
            return Vec::new();
        }
        let data = std::mem::take(&mut self.textures);
        let mut lengths = self.lengths.take();
        if !data.pictures.is_empty() {
            lengths = lengths.or_else(|| Some(vec![3; corners.len() / 3]));
        }
        let Some(lengths) = lengths else {
            let triangles = corners.as_chunks::<3>().0.into();
            return vec![Corners::Triangles(counted(triangles))];
        };
        vec![Corners::Lists(CornerLists {
            kind: FaceKind::Polygons,
            lengths,
            corners,
            with_holes: 0,
            data,
        })]
    }
}

/// Triangles with what is known of all of them.
fn counted(corners: Arc<[[u32; 3]]>) -> Triangles {
    let pieces = corners.par_chunks(TRIANGLES_A_PIECE).map(|piece| {
        piece
            .iter()
            .fold((0, 0), |(largest, degenerate), &[a, b, c]| {
                let is_degenerate = a == b || b == c || a == c;
                (
                    a.max(b).max(c).max(largest),
                    degenerate + u64::from(is_degenerate),
                )
            })
    });
    let (max_corner, degenerate_count) = pieces.reduce(
        || (0, 0),
        |(max_a, count_a): (u32, u64), (max_b, count_b)| (max_a.max(max_b), count_a + count_b),
    );
    Triangles {
        corners,
        max_corner,
        degenerate_count,
    }
}

#[cfg(test)]
#[path = "object_builder_tests.rs"]
mod tests;
