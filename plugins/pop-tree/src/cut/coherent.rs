//! The cut by what is known from the frame before.
//!
//! Every answer comes with its slack: how far the camera may move until it can change. Two odometers run: how far points of
//! the object moved in view space at most, and how far the eye moved in object space. An answer holds until its odometer
//! reading is passed. Subtrees of some levels ([`CHUNK_LEVELS`]) keep the walk through them, with the least reading of every
//! part: a part in which nothing can have changed is taken over as it stands, untested.
//!
//! The scheme of the seed marks the nodes of the last cut and walks up or down from each, and so asks every node of the cut;
//! this one asks few of them, and what it gives is the full walk's answer by construction.

use super::view::{Open, Projection, Slack, Verdict, View};
use super::{Counts, Cut};
use crate::node::Node;
use crate::tree::Tree;
use pointstage_plugin_api::glam::{DVec3, Mat4, Vec3};

/// Levels of a subtree that keeps its walk; above, every node is asked each time.
const CHUNK_LEVELS: usize = 6;
/// Greatest reading, in extents of the object, until all is asked anew: readings are f32.
const LONGEST_WAY: f64 = 64.0;
/// What is taken off each slack, in units of the greatest length at hand: what single precision can err.
const ROUNDING: f32 = 4e-6;

/// The last cut of a tree, for the next.
#[derive(Clone, Debug, Default)]
pub struct CoherentCut {
    last: Option<Last>,
    chunks: Vec<Option<Box<Chunk>>>,
    /// Odometers: of points in view space, of the eye in object space.
    way_view: f64,
    way_eye: f64,
    spare: Chunk,
}

/// The view of the last cut.
#[derive(Clone, Debug)]
struct Last {
    projection: Projection,
    eye_object: Vec3,
}

/// The walk through a subtree.
#[derive(Clone, Debug, Default)]
struct Chunk {
    /// What the root's ancestors left open.
    open: Option<Open>,
    entries: Vec<Entry>,
    splats: Vec<u32>,
    triangles: Vec<u32>,
    culled: u64,
}

/// A node of the walk, followed by those below it.
#[derive(Clone, Copy, Debug)]
struct Entry {
    /// Place of the entry after the last one below this.
    end: u32,
    /// What the subtree's splats and triangles begin at.
    splats: u32,
    triangles: u32,
    verdict: Verdict,
    /// What the node leaves open.
    open: Open,
    /// Readings until its own answer holds.
    own: Slack,
    /// Least readings of it and all below.
    least: Slack,
}

/// The view and the odometers.
struct Now<'a> {
    tree: &'a Tree,
    view: &'a View,
    way_view: f64,
    way_eye: f64,
    /// Taken off each slack.
    rounding_view: f32,
    rounding_eye: f32,
}

impl CoherentCut {
    /// Forgets what is known.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// The cut of a tree, the same one in every call until [`CoherentCut::forget`]: what [`super::full`] gives.
    pub fn update(&mut self, tree: &Tree, view: &View, cut: &mut Cut) {
        cut.clear();
        if tree.nodes.is_empty() {
            return;
        }
        let chunk_level = tree.level_starts.len().saturating_sub(CHUNK_LEVELS);
        let first = tree.level_starts[chunk_level];
        let end = tree.level_starts.get(chunk_level + 1).copied().unwrap_or(tree.nodes.len() as u32);
        let extent = 2.0 * tree.nodes[0].radius();
        self.travel(tree, view, extent, (end - first) as usize);
        let far = extent + view.eye_object().distance(tree.grid.position(tree.nodes[0].place()));
        let longest = far + LONGEST_WAY as f32 * extent;
        let now = Now {
            tree,
            view,
            way_view: self.way_view,
            way_eye: self.way_eye,
            rounding_view: ROUNDING * longest * view.stretch(),
            // A direction has length 1.
            rounding_eye: if view.projection().is_orthographic { ROUNDING * LONGEST_WAY as f32 } else { ROUNDING * longest },
        };
        self.descend(&now, 0, view.all_open(), first, end, cut);
    }

    /// Moves the odometers on, or starts anew where answers cannot be carried over.
    fn travel(&mut self, tree: &Tree, view: &View, extent: f32, chunk_count: usize) {
        let projection = *view.projection();
        let eye_object = view.eye_object();
        let carries = self.last.as_ref().is_some_and(|last| {
            let matrix = last.projection.view_from_object;
            Projection { view_from_object: matrix, ..projection } == last.projection
        });
        if let Some(last) = self.last.as_ref().filter(|_| carries && self.chunks.len() == chunk_count) {
            let moved = greatest_motion(tree, &last.projection.view_from_object, &projection.view_from_object);
            self.way_view += moved;
            self.way_eye += f64::from(eye_object.distance(last.eye_object));
        }
        let limit_view = LONGEST_WAY * f64::from(extent * view.stretch());
        let limit_eye = LONGEST_WAY * if projection.is_orthographic { 1.0 } else { f64::from(extent) };
        let is_near = self.way_view <= limit_view && self.way_eye <= limit_eye;
        if !carries || self.chunks.len() != chunk_count || !is_near {
            self.chunks = vec![None; chunk_count];
            (self.way_view, self.way_eye) = (0.0, 0.0);
        }
        self.last = Some(Last { projection, eye_object });
    }

    /// Asks the nodes above the chunks.
    fn descend(&mut self, now: &Now<'_>, node: u32, open: Open, first: u32, end: u32, cut: &mut Cut) {
        if (first..end).contains(&node) {
            let chunk = &mut self.chunks[(node - first) as usize];
            chunk.get_or_insert_default().update(now, node, open, &mut self.spare, cut);
            return;
        }
        let packed = now.tree.nodes[node as usize];
        cut.counts.evaluated += 1;
        let judged = now.view.judge::<false>(packed, open);
        match judged.verdict {
            Verdict::Culled => cut.counts.culled += 1,
            Verdict::Small => cut.splats.push(node),
            // Leaves are on the last level, so none is above the chunks.
            Verdict::Large => {
                for child in packed.children() {
                    self.descend(now, child, judged.open, first, end, cut);
                }
            }
        }
    }
}

impl Chunk {
    /// Brings the walk up to date and adds its part to the cut.
    fn update(&mut self, now: &Now<'_>, root: u32, open: Open, spare: &mut Self, cut: &mut Cut) {
        let holds = self.open == Some(open) && self.entries.first().is_some_and(|entry| now.holds(entry.least));
        if !holds {
            let had = self.open.is_some().then_some(0);
            let is_same = self.open == Some(open);
            spare.clear();
            let old = &*self;
            spare.walk(now, old, had, !is_same, root, open, &mut cut.counts);
            spare.open = Some(open);
            core::mem::swap(self, spare);
        }
        cut.splats.extend_from_slice(&self.splats);
        cut.triangles.extend_from_slice(&self.triangles);
        cut.counts.culled += self.culled;
    }

    fn clear(&mut self) {
        self.open = None;
        self.entries.clear();
        self.splats.clear();
        self.triangles.clear();
        self.culled = 0;
    }

    /// Walks a node and what is below; `had` is its place in the old walk, whose answer about it is void if `is_void`.
    fn walk(
        &mut self,
        now: &Now<'_>,
        old: &Self,
        had: Option<u32>,
        is_void: bool,
        node: u32,
        open: Open,
        counts: &mut Counts,
    ) {
        let known = had.map(|place| old.entries[place as usize]);
        if let (Some(place), Some(entry)) = (had, known)
            && !is_void
            && now.holds(entry.least)
        {
            self.take_over(old, place, entry.end);
            return;
        }
        let packed = now.tree.nodes[node as usize];
        let (verdict, left_open, own) = match known {
            Some(entry) if !is_void && now.holds(entry.own) => (entry.verdict, entry.open, entry.own),
            _ => {
                counts.evaluated += 1;
                let judged = now.view.judge::<true>(packed, open);
                (judged.verdict, judged.open, now.until(judged.slack))
            }
        };
        let at = self.entries.len();
        self.entries.push(Entry {
            end: 0,
            splats: self.splats.len() as u32,
            triangles: self.triangles.len() as u32,
            verdict,
            open: left_open,
            own,
            least: own,
        });
        match verdict {
            Verdict::Culled => self.culled += 1,
            Verdict::Small => self.splats.push(node),
            Verdict::Large if node >= now.tree.first_leaf() => self.triangles.push(packed.link()),
            Verdict::Large => self.walk_children(now, old, (had, known), packed, left_open, counts, at),
        }
        self.entries[at].end = self.entries.len() as u32;
    }

    /// Walks the children of the entry at `at`.
    fn walk_children(
        &mut self,
        now: &Now<'_>,
        old: &Self,
        (had, known): (Option<u32>, Option<Entry>),
        packed: Node,
        open: Open,
        counts: &mut Counts,
        at: usize,
    ) {
        // The old walk has the children if it opened the node; their answers are void if something else is left open now.
        let is_void = known.is_none_or(|entry| entry.open != open);
        let mut had_child = had
            .zip(known)
            .filter(|(_, entry)| entry.verdict == Verdict::Large)
            .map(|(place, _)| place + 1);
        let mut least = self.entries[at].own;
        for child in packed.children() {
            let place = self.entries.len();
            self.walk(now, old, had_child, is_void, child, open, counts);
            had_child = had_child.map(|place| old.entries[place as usize].end);
            let below = self.entries[place].least;
            least = Slack {
                view: least.view.min(below.view),
                eye: least.eye.min(below.eye),
            };
        }
        self.entries[at].least = least;
    }

    /// Takes over a part of the old walk as it stands.
    fn take_over(&mut self, old: &Self, from: u32, end: u32) {
        let part = &old.entries[from as usize..end as usize];
        let Some(first) = part.first() else { return };
        let (splats, triangles) = match old.entries.get(end as usize) {
            Some(next) => (next.splats as usize, next.triangles as usize),
            None => (old.splats.len(), old.triangles.len()),
        };
        let at = self.entries.len() as u32;
        let splat_at = self.splats.len() as u32;
        let triangle_at = self.triangles.len() as u32;
        self.entries.extend(part.iter().map(|entry| Entry {
            end: entry.end - from + at,
            splats: entry.splats - first.splats + splat_at,
            triangles: entry.triangles - first.triangles + triangle_at,
            ..*entry
        }));
        self.culled += part.iter().filter(|entry| entry.verdict == Verdict::Culled).count() as u64;
        self.splats.extend_from_slice(&old.splats[first.splats as usize..splats]);
        self.triangles.extend_from_slice(&old.triangles[first.triangles as usize..triangles]);
    }
}

impl Now<'_> {
    /// Whether answers with these readings still stand.
    fn holds(&self, until: Slack) -> bool {
        f64::from(until.view) > self.way_view && f64::from(until.eye) > self.way_eye
    }

    /// The readings until an answer with this slack stands.
    fn until(&self, slack: Slack) -> Slack {
        Slack {
            view: self.way_view as f32 + slack.view - self.rounding_view,
            eye: self.way_eye as f32 + slack.eye - self.rounding_eye,
        }
    }
}

/// How far a point of the tree's bounds moves in view space at most: the distance is convex, so a corner moves farthest.
fn greatest_motion(tree: &Tree, old: &Mat4, new: &Mat4) -> f64 {
    let centre = tree.grid.position(tree.nodes[0].place()).as_dvec3();
    let radius = f64::from(tree.nodes[0].radius());
    let [old, new] = [old.as_dmat4(), new.as_dmat4()];
    (0..8)
        .map(|corner| {
            let sign = |axis: u32| if corner >> axis & 1 == 0 { -radius } else { radius };
            let corner = centre + DVec3::new(sign(0), sign(1), sign(2));
            old.transform_point3(corner).distance(new.transform_point3(corner))
        })
        .fold(0.0, f64::max)
}
