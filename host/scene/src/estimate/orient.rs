//! One side for the normals of a whole object.
//!
//! A plane fitted to points has two normals. Neighbouring planes that lie nearly alike should have theirs on the same side,
//! so a choice for one point spreads to all others along the edges that are the most certain: those of the minimum spanning
//! forest of the graph of neighbours, where the edge between points with normals n and m weighs 1 − |n·m| (Hoppe et al.,
//! *Surface Reconstruction from Unorganized Points*, SIGGRAPH 1992, section 3.3). Pieces that no edge connects are oriented
//! each for itself, by the normals where it ends along the axes: there they point away from it (`outward`).
//!
//! The forest grows by the rounds of Borůvka: every tree takes the lightest edge that leaves it, all at once, and trees that
//! meet become one. Each point keeps only whether its normal is turned against that of its tree's root, which is what
//! walking along the finished tree would give. Edges of equal weight are told apart by number, so the result is the same
//! for any number of threads.
//!
//! Where we depart from the paper: its graph is completed to be connected, so that far pieces decide about each other; ours
//! is not.

mod outward;

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::Vec3;
use rayon::prelude::*;

use super::tree::TreePoint;
use crate::job::{Cancelled, Job};

/// Points between two looks at the cancel flag.
pub(super) const POINTS_A_PIECE: usize = 1 << 12;

/// Bits of a key that number an edge; the weight stands above them.
const EDGE_BITS: u32 = 40;

/// Weight 1 in the bits above, as fine as an f32 near 1.
const HEAVIEST: f32 = 0xFF_FFFF as f32;

/// No edge.
const NONE: u64 = u64::MAX;

/// The neighbours of each point, by place in the tree; a point that has fewer names itself.
#[derive(Debug)]
pub(super) struct Graph {
    /// [`POINTS_A_PIECE`] points each, but for the last.
    pub(super) pieces: Vec<Vec<u32>>,
    /// Neighbours a point.
    pub(super) degree: usize,
}

impl Graph {
    fn edge(&self, number: usize) -> (usize, usize) {
        let point = number / self.degree;
        let piece = &self.pieces[point / POINTS_A_PIECE];
        let inside = point % POINTS_A_PIECE * self.degree + number % self.degree;
        (point, piece[inside] as usize)
    }
}

/// Which normals to turn, by place in the tree.
#[derive(Debug)]
pub(super) struct Sides {
    pub(super) turned: Vec<bool>,
    /// Pieces that no neighbours connect.
    pub(super) pieces: usize,
}

/// Finds the side of each normal; normals that are zero are not known.
pub(super) fn sides(
    points: &[TreePoint],
    normals: &[Vec3],
    graph: &Graph,
    part: &Range<f32>,
    job: &Job,
) -> Result<Sides, Cancelled> {
    let mut forest = Forest::new(points.len());
    while forest.grow(normals, graph, job)? {
        // Half of the trees go in a round, most often more.
        let trees = forest.growing.len().max(1);
        let part_done = 1.0 - (trees as f32).ln() / (points.len().max(2) as f32).ln();
        job.set_progress(part.start + (part.end - part.start) * part_done);
    }
    let Forest { root, turned, .. } = forest;
    Ok(outward::settle(points, normals, &root, turned))
}

/// Trees over the points.
struct Forest {
    /// Root of each point's tree.
    root: Vec<u32>,
    /// Whether a point's normal is turned against its root's.
    turned: Vec<bool>,
    /// Roots of trees that may still meet others, rising.
    growing: Vec<u32>,
    /// For a root: the lightest edge that leaves its tree.
    lightest: Vec<AtomicU64>,
    links: Links,
}

/// Roots that have become parts of other trees.
struct Links {
    /// The root that a root was joined to; itself while it is one.
    up: Vec<u32>,
    /// Whether its normal is turned against that of `up`.
    turned: Vec<bool>,
    /// Trees joined below it: the smaller joins the larger, so that ways up stay short.
    size: Vec<u32>,
}

impl Links {
    /// The root above a root, and whether it is turned against that.
    fn top(&self, root: u32) -> (u32, bool) {
        let (mut at, mut turned) = (root, false);
        while self.up[at as usize] != at {
            turned ^= self.turned[at as usize];
            at = self.up[at as usize];
        }
        (at, turned)
    }

    /// Makes two trees one; `turned`: whether one root's normal is turned against the other's.
    fn join(&mut self, a: u32, b: u32, turned: bool) {
        let (below, above) = if self.size[a as usize] < self.size[b as usize] {
            (a, b)
        } else {
            (b, a)
        };
        self.up[below as usize] = above;
        self.turned[below as usize] = turned;
        self.size[above as usize] += self.size[below as usize];
    }
}

impl Forest {
    /// A tree a point.
    fn new(count: usize) -> Self {
        let all: Vec<u32> = (0..count as u32).collect();
        Self {
            root: all.clone(),
            turned: vec![false; count],
            growing: all.clone(),
            lightest: (0..count).map(|_| AtomicU64::new(NONE)).collect(),
            links: Links {
                up: all,
                turned: vec![false; count],
                size: vec![1; count],
            },
        }
    }

    /// One round; false when no tree met another.
    fn grow(&mut self, normals: &[Vec3], graph: &Graph, job: &Job) -> Result<bool, Cancelled> {
        for root in &self.growing {
            self.lightest[*root as usize] = AtomicU64::new(NONE);
        }
        self.find_lightest(normals, graph, job)?;
        let mut has_met = false;
        for root in &self.growing {
            let key = self.lightest[*root as usize].load(Ordering::Relaxed);
            if key == NONE {
                continue;
            }
            let (from, to) = graph.edge((key & ((1 << EDGE_BITS) - 1)) as usize);
            let (a, a_turned) = self.links.top(self.root[from]);
            let (b, b_turned) = self.links.top(self.root[to]);
            if a != b {
                let opposite = normals[from].dot(normals[to]) < 0.0;
                let turned = opposite ^ self.turned[from] ^ a_turned ^ self.turned[to] ^ b_turned;
                self.links.join(a, b, turned);
                has_met = true;
            }
        }
        job.check()?;
        let Self {
            root,
            turned,
            growing,
            lightest,
            links,
        } = self;
        growing.retain(|root| {
            let is_root = links.up[*root as usize] == *root;
            is_root && lightest[*root as usize].load(Ordering::Relaxed) != NONE
        });
        root.par_iter_mut()
            .zip(turned)
            .with_min_len(POINTS_A_PIECE)
            .for_each(|(root, turned)| {
                let (top, top_turned) = links.top(*root);
                *root = top;
                *turned ^= top_turned;
            });
        Ok(has_met)
    }

    /// Finds the lightest edge that leaves each tree.
    fn find_lightest(&self, normals: &[Vec3], graph: &Graph, job: &Job) -> Result<(), Cancelled> {
        let degree = graph.degree;
        graph
            .pieces
            .par_iter()
            .enumerate()
            .try_for_each(|(piece, neighbours)| {
                job.check()?;
                let first = piece * POINTS_A_PIECE;
                for (from, neighbours) in (first..).zip(neighbours.chunks_exact(degree)) {
                    for (slot, to) in neighbours.iter().enumerate() {
                        let roots = [self.root[from], self.root[*to as usize]];
                        if roots[0] == roots[1] {
                            continue;
                        }
                        let alike = normals[from].dot(normals[*to as usize]).abs();
                        let weight = ((1.0 - alike.min(1.0)) * HEAVIEST) as u64;
                        let key = (weight << EDGE_BITS) | (from * degree + slot) as u64;
                        for root in roots {
                            let lightest = &self.lightest[root as usize];
                            // A look is cheaper than a write, and most edges are heavier.
                            if key < lightest.load(Ordering::Relaxed) {
                                lightest.fetch_min(key, Ordering::Relaxed);
                            }
                        }
                    }
                }
                Ok(())
            })
    }
}
