//! Normals, radii and tangent axes that a file did not give, or that the user wants anew.
//!
//! [`normals_and_radii`] completes a geometry: first from its faces, where there are any (`faces`), then from the nearest
//! neighbours (`neighbours`) for what is still missing: all of a point set, or the vertices of a mesh that no face uses.
//! What a file gave is kept. [`estimate()`] does what it is told, one column or several, with any number of neighbours, and
//! replaces what is there. Where each column came from is noted in [`Origins`](crate::Origins).

mod cell;
mod faces;
mod local;
mod neighbours;
mod orient;
mod plane;
mod steps;
mod sums;
mod survey;
mod tree;
mod winding;

pub use steps::{Steps, estimate};

use pointstage_plugin_api::columns::NO_NORMAL;

use crate::geometry::{Geometry, Provenance};
use crate::job::{Cancelled, Job};
use crate::load::FaceRadius;
use crate::warnings::Warnings;

/// Neighbours that normals and radii come from, unless the user says otherwise.
pub const DEFAULT_NEIGHBOURS: usize = 16;

/// The fewest and the most neighbours that may be asked for: three points make a plane, and beyond 64 corners are rounded.
pub const NEIGHBOURS_RANGE: std::ops::RangeInclusive<usize> = 3..=64;

/// Faces of any number of corners, as they were before they were cut into triangles.
#[derive(Clone, Debug, Default)]
pub(crate) struct Polygons {
    lengths: Vec<u32>,
    corners: Vec<u32>,
}

impl Polygons {
    /// One polygon a triangle.
    pub(crate) fn from_triangles(triangles: &[[u32; 3]]) -> Self {
        Self {
            lengths: vec![3; triangles.len()],
            corners: triangles.as_flattened().to_vec(),
        }
    }

    /// Adds a polygon.
    pub(crate) fn push(&mut self, corners: &[u32]) {
        self.lengths.push(corners.len() as u32);
        self.corners.extend_from_slice(corners);
    }

    /// Turns every polygon over.
    pub(crate) fn flip(&mut self) {
        let mut rest = self.corners.as_mut_slice();
        for length in &self.lengths {
            let (corners, others) = rest.split_at_mut(*length as usize);
            corners.reverse();
            rest = others;
        }
    }

    /// How many.
    #[cfg(test)]
    pub(crate) fn len(&self) -> usize {
        self.lengths.len()
    }

    /// The corners of each.
    fn iter(&self) -> impl Iterator<Item = &[u32]> {
        let mut rest = self.corners.as_slice();
        self.lengths.iter().map(move |length| {
            let (corners, others) = rest.split_at(*length as usize);
            rest = others;
            corners
        })
    }
}

/// Whether what faces do not give may come from neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Neighbours {
    /// Look for them.
    Use,
    /// Leave normals and radii missing.
    Leave,
}

/// What [`complete`] learnt about the mesh on the way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Orientation {
    /// Not closed enough to tell, or not looked at.
    Unknown,
    /// Counter-clockwise seen from outside.
    Outward,
    /// Clockwise seen from outside.
    Inward,
}

/// The geometry with normals and radii for every surfel.
///
/// Normals and radii that are there are kept. From faces: the normal is the mean of the unit normals of the incident
/// faces, the radius that of the smallest circle enclosing an incident face, the largest of them. From neighbours: the
/// normal is that of the plane through the 16 nearest, with an arbitrary sign; the radius reaches all places that are
/// nearest to the surfel, so that the disks leave no holes between them.
///
/// Thread: any; takes about 1 s per million surfels without faces on two cores. The result is the same for any number of
/// threads.
///
/// # Errors
/// [`Cancelled`] when the job was.
pub fn normals_and_radii(
    geometry: &Geometry,
    job: &Job,
) -> Result<(Geometry, Warnings), Cancelled> {
    let mut completed = geometry.clone();
    let mut warnings = Warnings::new();
    complete(
        &mut completed,
        None,
        FaceRadius::default(),
        Neighbours::Use,
        job,
        &mut warnings,
    )?;
    completed.touch();
    Ok((completed, warnings))
}

/// Completes `geometry` in place; see [`normals_and_radii`]. `polygons` are the faces before they were cut, if they were.
pub(crate) fn complete(
    geometry: &mut Geometry,
    polygons: Option<&Polygons>,
    rule: FaceRadius,
    neighbours: Neighbours,
    job: &Job,
    warnings: &mut Warnings,
) -> Result<Orientation, Cancelled> {
    let mut orientation = Orientation::Unknown;
    if let Some(triangles) = geometry.triangles.clone() {
        job.set_stage("computing normals and radii from faces");
        orientation = faces::complete(geometry, &triangles, polygons, rule, job)?;
    }
    let wants_neighbours = lacks_any(geometry);
    if wants_neighbours && neighbours == Neighbours::Use {
        neighbours::complete(geometry, job, warnings)?;
    }
    Ok(orientation)
}

/// True if a normal or a radius is missing.
fn lacks_any(geometry: &Geometry) -> bool {
    if geometry.origins.normals == Provenance::Missing
        || geometry.origins.radii == Provenance::Missing
    {
        return true;
    }
    geometry.blocks.iter().any(|block| {
        let lacks_normal = block
            .normal
            .as_ref()
            .is_some_and(|normals| normals.contains(&NO_NORMAL));
        lacks_normal || block.position_radius.iter().any(|surfel| surfel[3] <= 0.0)
    })
}
