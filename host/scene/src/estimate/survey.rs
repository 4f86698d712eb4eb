//! One walk over all points that gathers what the steps of an estimate need of each point's neighbours.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::Vec3;
use pointstage_plugin_api::columns::{NO_NORMAL, decode_normal};
use rayon::prelude::*;

use super::cell::Ellipse;
use super::local::{Local, MARGIN};
use super::neighbours::place_of;
use super::orient::{Graph, POINTS_A_PIECE};
use super::tree::{Tree, TreePoint};
use crate::geometry::Geometry;
use crate::job::{Cancelled, Job};

/// Neighbours that normals are oriented along, at most: more would tie the two sides of a thin wall together.
const MOST_EDGES: usize = 10;

/// What is wanted of each point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    pub(super) neighbours: usize,
    pub(super) radii: bool,
    pub(super) axes: bool,
    pub(super) graph: bool,
}

/// What was found, by place in the tree.
#[derive(Debug)]
pub(super) struct Survey {
    /// Unit: the surfel's own where it has one, else that of the plane.
    pub(super) normals: Vec<Vec3>,
    /// 0 where all neighbours are at one place; empty if not wanted.
    pub(super) radii: Vec<f32>,
    /// Of no length where all neighbours are at one place; empty if not wanted.
    pub(super) ellipses: Vec<Ellipse>,
    /// None if not wanted.
    pub(super) graph: Option<Graph>,
}

/// What one run of points gives.
#[derive(Default)]
struct Piece {
    normals: Vec<Vec3>,
    radii: Vec<f32>,
    ellipses: Vec<Ellipse>,
    edges: Vec<u32>,
}

/// Looks at every point of the tree.
pub(super) fn survey(
    geometry: &Geometry,
    tree: &Tree,
    wanted: Wanted,
    part: &Range<f32>,
    job: &Job,
) -> Result<Survey, Cancelled> {
    // The number of neighbours that are looked for is fixed when the program is built; those that are too many are not
    // looked at.
    match wanted.neighbours {
        ..=8 => with_room::<9>(geometry, tree, wanted, part, job),
        9..=16 => with_room::<17>(geometry, tree, wanted, part, job),
        17..=32 => with_room::<33>(geometry, tree, wanted, part, job),
        _ => with_room::<65>(geometry, tree, wanted, part, job),
    }
}

fn with_room<const N: usize>(
    geometry: &Geometry,
    tree: &Tree,
    wanted: Wanted,
    part: &Range<f32>,
    job: &Job,
) -> Result<Survey, Cancelled> {
    let degree = wanted.neighbours.min(MOST_EDGES);
    let done = AtomicUsize::new(0);
    let total = tree.points().len();
    let pieces: Vec<Piece> = tree
        .points()
        .par_chunks(POINTS_A_PIECE)
        .enumerate()
        .map(|(number, points)| {
            job.check()?;
            let mut piece = Piece::default();
            for (place, point) in (number * POINTS_A_PIECE..).zip(points) {
                piece.look::<N>(geometry, tree, place, point, wanted, degree);
            }
            let done = done.fetch_add(points.len(), Ordering::Relaxed) + points.len();
            job.set_progress_within(part, done, total);
            Ok(piece)
        })
        .collect::<Result<_, Cancelled>>()?;
    let mut survey = Survey {
        normals: Vec::with_capacity(total),
        radii: Vec::new(),
        ellipses: Vec::new(),
        graph: None,
    };
    let mut edges = Vec::with_capacity(pieces.len());
    for piece in pieces {
        survey.normals.extend(piece.normals);
        survey.radii.extend(piece.radii);
        survey.ellipses.extend(piece.ellipses);
        edges.push(piece.edges);
    }
    survey.graph = wanted.graph.then_some(Graph {
        pieces: edges,
        degree,
    });
    Ok(survey)
}

impl Piece {
    fn look<const N: usize>(
        &mut self,
        geometry: &Geometry,
        tree: &Tree,
        place: usize,
        point: &TreePoint,
        wanted: Wanted,
        degree: usize,
    ) {
        let near = tree.nearest::<N>(point.centre);
        let local = Local::new(tree, point, &near, wanted.neighbours);
        let normal =
            own_normal(geometry, point.index).map_or_else(|| local.normal(), Vec3::as_dvec3);
        self.normals.push(normal.as_vec3());
        if wanted.radii || wanted.axes {
            let (cell, greatest) = (local.cell(normal), local.greatest());
            if wanted.radii {
                self.radii
                    .push((MARGIN * cell.radius()).min(greatest) as f32);
            }
            if wanted.axes {
                let Ellipse { long, short_length } = cell.ellipse();
                self.ellipses.push(Ellipse {
                    long: (MARGIN * long).clamp_length_max(greatest),
                    short_length: (MARGIN * short_length).min(greatest),
                });
            }
        }
        if wanted.graph {
            let others = near.places[..near.count()]
                .iter()
                .filter(|other| **other as usize != place)
                .take(degree);
            let start = self.edges.len();
            self.edges.extend(others);
            self.edges.resize(start + degree, place as u32);
        }
    }
}

/// The normal that a surfel has; none if it is not known.
fn own_normal(geometry: &Geometry, surfel: u32) -> Option<Vec3> {
    let (block, inside) = place_of(surfel);
    let packed = *geometry.blocks[block].normal.as_ref()?.get(inside)?;
    (packed != NO_NORMAL).then(|| decode_normal(packed))
}
