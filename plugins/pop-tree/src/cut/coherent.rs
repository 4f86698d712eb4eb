//! The cut by what is known from the frame before.
//!
//! Every answer comes with its slack: how far the camera may move until it can change. Two odometers run: how far points of
//! the object moved in view space at most, and how far the eye moved in object space. An answer holds until its odometer
//! reading is passed. Subtrees of some levels ([`CHUNK_LEVELS`]) keep the walk through them, with the least reading of every
//! part: a part in which nothing can have changed is taken over as it stands, untested. Subtrees are independent, so threads
//! share them.
//!
//! The usual scheme marks the nodes of the last cut and walks up or down from each, and so asks every node of the cut;
//! this one asks few of them, and what it gives is the full walk's answer by construction.

use super::Cut;
use super::chunk::{Chunk, Now};
use super::judge::{Open, Verdict};
use super::view::{Projection, View};
use crate::tree::Tree;
use core::ops::Range;
use pointstage_plugin_api::glam::{DVec3, Mat4, Vec3};
use std::sync::{Mutex, PoisonError};
use std::thread;

/// Levels of a subtree that keeps its walk; above, every node is asked each time.
const CHUNK_LEVELS: usize = 7;
/// Greatest reading, in extents of the object, until all is asked anew: readings are f32.
const LONGEST_WAY: f64 = 64.0;
/// What is taken off each slack, in units of the greatest length at hand: what single precision can err.
const ROUNDING: f32 = 4e-6;
/// Fewer subtrees than this are walked on the calling thread.
const FEWEST_FOR_THREADS: usize = 16;

/// A motion that is this much smaller than one that asked too many nodes is tried again.
const SMALLER: f64 = 0.25;
/// Above this share of nodes asked again, asking all is faster than keeping books.
const MOST_ASKED: f64 = 0.05;

/// Whether a cut takes over what is known from the last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keep {
    /// Wherever it can.
    Always,
    /// If the camera moves so little that few nodes are asked again.
    WhereItPays,
    /// Never.
    Never,
}

/// The last cut of a tree, for the next.
#[derive(Clone, Debug, Default)]
pub struct CoherentCut {
    last: Option<Last>,
    /// The least motion by which too many nodes were asked again.
    too_far: Option<f64>,
    /// Of the nodes on one level, in their order.
    chunks: Vec<Chunk>,
    /// What the walk above the subtrees meets, in its order.
    met: Vec<Met>,
    /// Odometers: of points in view space, of the eye in object space.
    way_view: f64,
    way_eye: f64,
}

/// The view of the last cut.
#[derive(Clone, Debug)]
struct Last {
    projection: Projection,
    eye_object: Vec3,
}

/// What the walk above the subtrees meets.
#[derive(Clone, Copy, Debug)]
enum Met {
    Splat(u32),
    /// A subtree by its number, with what its root leaves open.
    Chunk(u32, Open),
}

impl CoherentCut {
    /// Forgets what is known.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// The cut of a tree, the same one in every call until [`CoherentCut::forget`]: what [`super::full`] gives.
    ///
    /// * `thread_count`: threads to walk on, the calling one if 0 or 1.
    pub fn update(
        &mut self,
        tree: &Tree,
        view: &View,
        keep: Keep,
        thread_count: usize,
        cut: &mut Cut,
    ) {
        cut.clear();
        if tree.nodes.is_empty() {
            return;
        }
        let chunk_level = tree.level_starts.len().saturating_sub(CHUNK_LEVELS);
        let first = tree.level_starts[chunk_level];
        let end = tree
            .level_starts
            .get(chunk_level + 1)
            .copied()
            .unwrap_or(tree.nodes.len() as u32);
        let extent = 2.0 * tree.nodes[0].radius();
        let motion = self.travel(tree, view, extent, (end - first) as usize);
        let keeps = match keep {
            Keep::Always => true,
            Keep::WhereItPays => self
                .too_far
                .is_none_or(|too_far| motion.is_some_and(|motion| motion < SMALLER * too_far)),
            Keep::Never => false,
        };
        let far = extent
            + view
                .eye_object()
                .distance(tree.grid.position(tree.nodes[0].place()));
        let longest = far + LONGEST_WAY as f32 * extent;
        let now = Now {
            tree,
            view,
            way_view: self.way_view,
            way_eye: self.way_eye,
            rounding_view: ROUNDING * longest * view.stretch(),
            // A direction has length 1.
            rounding_eye: ROUNDING
                * if view.projection().is_orthographic {
                    LONGEST_WAY as f32
                } else {
                    longest
                },
        };
        self.met.clear();
        self.descend(&now, 0..1, view.all_open(), first..end, cut);
        self.walk_chunks(&now, first, keeps, thread_count);
        for met in &self.met {
            match *met {
                Met::Splat(node) => cut.splats.push(node),
                Met::Chunk(number, _) => {
                    let chunk = &self.chunks[number as usize];
                    cut.splats.extend_from_slice(&chunk.splats);
                    cut.triangles.extend_from_slice(&chunk.triangles);
                    cut.counts.culled += chunk.culled;
                    cut.counts.evaluated += chunk.evaluated;
                }
            }
        }
        if keeps {
            self.look_back(motion, cut.counts.evaluated);
        }
    }

    /// Learns from a cut that was kept whether such a motion is small enough.
    fn look_back(&mut self, motion: Option<f64>, evaluated: u64) {
        let Some(motion) = motion.filter(|motion| *motion > 0.0) else {
            return;
        };
        let kept = self.met.iter().map(|met| match *met {
            Met::Chunk(number, _) => self.chunks[number as usize].entries.len(),
            Met::Splat(_) => 1,
        });
        let asked_too_many = evaluated as f64 > MOST_ASKED * kept.sum::<usize>() as f64;
        self.too_far = asked_too_many.then_some(motion);
    }

    /// Moves the odometers on, or starts anew where answers cannot be carried over; the motion since the last cut, unless it
    /// starts anew.
    fn travel(&mut self, tree: &Tree, view: &View, extent: f32, chunk_count: usize) -> Option<f64> {
        let projection = *view.projection();
        let eye_object = view.eye_object();
        let carries = self.last.as_ref().is_some_and(|last| {
            let matrix = last.projection.view_from_object;
            Projection {
                view_from_object: matrix,
                ..projection
            } == last.projection
        });
        let mut motion = None;
        if let Some(last) = self.last.as_ref().filter(|_| carries) {
            let of_points = greatest_motion(
                tree,
                &last.projection.view_from_object,
                &projection.view_from_object,
            );
            let of_eye = f64::from(eye_object.distance(last.eye_object));
            self.way_view += of_points;
            self.way_eye += of_eye;
            motion = Some(of_points / f64::from(view.stretch()) + of_eye);
        }
        let limit_view = LONGEST_WAY * f64::from(extent * view.stretch());
        let limit_eye = LONGEST_WAY
            * if projection.is_orthographic {
                1.0
            } else {
                f64::from(extent)
            };
        let is_near = self.way_view <= limit_view && self.way_eye <= limit_eye;
        if !carries || self.chunks.len() != chunk_count || !is_near {
            self.chunks.clear();
            self.chunks.resize_with(chunk_count, Chunk::default);
            (self.way_view, self.way_eye) = (0.0, 0.0);
        }
        self.last = Some(Last {
            projection,
            eye_object,
        });
        motion
    }

    /// Asks the nodes above the subtrees and the subtrees' roots.
    fn descend(
        &mut self,
        now: &Now<'_>,
        siblings: Range<u32>,
        open: Open,
        roots: Range<u32>,
        cut: &mut Cut,
    ) {
        let nodes = now.nodes(&siblings);
        cut.counts.evaluated += nodes.len() as u64;
        let answers = now.view.judge::<false>(nodes, open);
        for (place, (number, node)) in siblings.zip(nodes).enumerate() {
            match answers.of(place) {
                (Verdict::Culled, _) => cut.counts.culled += 1,
                (Verdict::Small, _) => self.met.push(Met::Splat(number)),
                // Only a tree of one node has a leaf here.
                (Verdict::Large, _) if number >= now.tree.first_leaf() => {
                    cut.triangles.push(node.link());
                }
                (Verdict::Large, open) if roots.contains(&number) => {
                    self.met.push(Met::Chunk(number - roots.start, open));
                }
                (Verdict::Large, open) => {
                    self.descend(now, node.children(), open, roots.clone(), cut);
                }
            }
        }
    }

    /// Brings the subtrees that were met up to date.
    fn walk_chunks(&mut self, now: &Now<'_>, first: u32, keeps: bool, thread_count: usize) {
        let mut chunks = self.chunks.iter_mut().enumerate();
        let mut stale = Vec::new();
        for met in &self.met {
            let Met::Chunk(number, open) = *met else {
                continue;
            };
            // Subtrees are met by rising numbers.
            let Some((_, chunk)) = chunks.find(|(other, _)| *other == number as usize) else {
                continue;
            };
            chunk.evaluated = 0;
            if !keeps || chunk.open != Some(open) || !now.holds(chunk.least) {
                stale.push((first + number, open, chunk));
            }
        }
        let is_worth_it = stale.len() >= FEWEST_FOR_THREADS && thread_count > 1;
        let jobs = Mutex::new(stale.into_iter());
        let work = || {
            let mut spare = Chunk::default();
            loop {
                let job = jobs.lock().unwrap_or_else(PoisonError::into_inner).next();
                let Some((root, open, chunk)) = job else {
                    return;
                };
                if keeps {
                    chunk.update(now, root, open, &mut spare);
                } else {
                    chunk.clear();
                    let children = now.tree.nodes[root as usize].children();
                    chunk.walk_anew(now, children, open);
                }
            }
        };
        thread::scope(|scope| {
            for _ in 1..if is_worth_it { thread_count } else { 1 } {
                // A thread that is not to be had is not needed.
                if thread::Builder::new()
                    .name("pop".into())
                    .spawn_scoped(scope, work)
                    .is_err()
                {
                    break;
                }
            }
            work();
        });
    }
}

/// How far a point of the tree's bounds moves in view space at most: the distance is convex, so a corner moves farthest.
fn greatest_motion(tree: &Tree, old: &Mat4, new: &Mat4) -> f64 {
    let centre = tree.grid.position(tree.nodes[0].place()).as_dvec3();
    let radius = f64::from(tree.nodes[0].radius());
    let [old, new] = [old.as_dmat4(), new.as_dmat4()];
    (0..8)
        .map(|corner| {
            let sign = |axis: u32| {
                if corner >> axis & 1 == 0 {
                    -radius
                } else {
                    radius
                }
            };
            let corner = centre + DVec3::new(sign(0), sign(1), sign(2));
            old.transform_point3(corner)
                .distance(new.transform_point3(corner))
        })
        .fold(0.0, f64::max)
}
