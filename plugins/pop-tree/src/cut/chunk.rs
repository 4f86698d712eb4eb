//! The walk through a subtree, kept for the next cut.

use super::judge::{Answers, Open, Slack, Verdict};
use super::view::View;
use crate::node::Node;
use crate::tree::Tree;
use core::ops::Range;

/// The walk below a node.
#[derive(Clone, Debug, Default)]
pub(super) struct Chunk {
    /// What the root left open.
    pub(super) open: Option<Open>,
    pub(super) entries: Vec<Entry>,
    pub(super) splats: Vec<u32>,
    pub(super) triangles: Vec<u32>,
    pub(super) culled: u64,
    /// Least readings of all.
    pub(super) least: Slack,
    /// Of the last update.
    pub(super) evaluated: u64,
}

/// A node of the walk, followed by those below it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    /// Place of the entry after the last one below this.
    pub(super) end: u32,
    /// What the subtree's splats and triangles begin at.
    pub(super) splats: u32,
    pub(super) triangles: u32,
    pub(super) verdict: Verdict,
    /// What the node leaves open.
    pub(super) open: Open,
    /// Readings until its own answer holds.
    pub(super) own: Slack,
    /// Least readings of it and all below.
    pub(super) least: Slack,
}

/// The view and the odometers.
pub(super) struct Now<'a> {
    pub(super) tree: &'a Tree,
    pub(super) view: &'a View,
    pub(super) way_view: f64,
    pub(super) way_eye: f64,
    /// Taken off each slack.
    pub(super) rounding_view: f32,
    pub(super) rounding_eye: f32,
}

/// Where the old walk has a node's answer.
#[derive(Clone, Copy)]
pub(super) struct Before<'a> {
    pub(super) chunk: &'a Chunk,
    /// Place of the entry of the first sibling.
    pub(super) first: Option<u32>,
    /// Whether something else was left open for the siblings, so that their answers are void.
    pub(super) is_void: bool,
}

impl Chunk {
    /// Brings the walk up to date; `spare` gets the old one.
    pub(super) fn update(&mut self, now: &Now<'_>, root: u32, open: Open, spare: &mut Self) {
        spare.clear();
        let before = Before {
            chunk: self,
            first: self.open.is_some().then_some(0),
            is_void: self.open != Some(open),
        };
        let children = now.tree.nodes[root as usize].children();
        spare.least = spare.walk(now, before, children, open);
        spare.open = Some(open);
        core::mem::swap(self, spare);
    }

    pub(super) fn clear(&mut self) {
        self.open = None;
        self.entries.clear();
        self.splats.clear();
        self.triangles.clear();
        self.culled = 0;
        self.evaluated = 0;
    }

    /// Walks siblings and what is below them, and keeps nothing for the next cut.
    pub(super) fn walk_anew(&mut self, now: &Now<'_>, siblings: Range<u32>, open: Open) {
        let nodes = now.nodes(&siblings);
        self.evaluated += nodes.len() as u64;
        let answers = now.view.judge::<false>(nodes, open);
        for (place, (number, node)) in siblings.zip(nodes).enumerate() {
            match answers.of(place) {
                (Verdict::Culled, _) => self.culled += 1,
                (Verdict::Small, _) => self.splats.push(number),
                (Verdict::Large, _) if number >= now.tree.first_leaf() => {
                    self.triangles.push(node.link());
                }
                (Verdict::Large, open) => self.walk_anew(now, node.children(), open),
            }
        }
    }

    /// Walks siblings and what is below them; their least readings.
    pub(super) fn walk(
        &mut self,
        now: &Now<'_>,
        before: Before<'_>,
        siblings: Range<u32>,
        open: Open,
    ) -> Slack {
        let nodes = now.nodes(&siblings);
        let old = before.chunk;
        let mut answers: Option<Answers> = None;
        let mut least = Slack::ENDLESS;
        let mut had = before.first;
        for (place, (number, node)) in siblings.zip(nodes).enumerate() {
            let known = had.map(|place| &old.entries[place as usize]);
            let stands = known.filter(|_| !before.is_void);
            if let (Some(from), Some(entry)) = (had, stands)
                && now.holds(entry.least)
            {
                self.take_over(old, from, entry.end);
                least = least.min(entry.least);
                had = Some(entry.end);
                continue;
            }
            let (verdict, left_open, own) = if let Some(entry) =
                stands.filter(|entry| now.holds(entry.own))
            {
                (entry.verdict, entry.open, entry.own)
            } else {
                self.evaluated += 1;
                let answers = answers.get_or_insert_with(|| now.view.judge::<true>(nodes, open));
                let (verdict, left_open) = answers.of(place);
                (verdict, left_open, now.until(answers.slack(place)))
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
                Verdict::Small => self.splats.push(number),
                Verdict::Large if number >= now.tree.first_leaf() => {
                    self.triangles.push(node.link());
                }
                Verdict::Large => {
                    // The old walk has the children if it opened the node; void if it left something else open for them.
                    let opened = known.filter(|entry| entry.verdict == Verdict::Large);
                    let below = Before {
                        chunk: old,
                        first: had.filter(|_| opened.is_some()).map(|place| place + 1),
                        is_void: opened.is_none_or(|entry| entry.open != left_open),
                    };
                    let below = self.walk(now, below, node.children(), left_open);
                    self.entries[at].least = own.min(below);
                }
            }
            self.entries[at].end = self.entries.len() as u32;
            least = least.min(self.entries[at].least);
            had = known.map(|entry| entry.end);
        }
        least
    }

    /// Takes over a part of the old walk as it stands.
    pub(super) fn take_over(&mut self, old: &Self, from: u32, end: u32) {
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
        self.culled += part
            .iter()
            .filter(|entry| entry.verdict == Verdict::Culled)
            .count() as u64;
        self.splats
            .extend_from_slice(&old.splats[first.splats as usize..splats]);
        self.triangles
            .extend_from_slice(&old.triangles[first.triangles as usize..triangles]);
    }
}

impl<'a> Now<'a> {
    pub(super) fn nodes(&self, numbers: &Range<u32>) -> &'a [Node] {
        &self.tree.nodes[numbers.start as usize..numbers.end as usize]
    }

    /// Whether answers with these readings still stand.
    pub(super) fn holds(&self, until: Slack) -> bool {
        f64::from(until.view) > self.way_view && f64::from(until.eye) > self.way_eye
    }

    /// The readings until an answer with this slack stands.
    pub(super) fn until(&self, slack: Slack) -> Slack {
        Slack {
            view: self.way_view as f32 + slack.view - self.rounding_view,
            eye: self.way_eye as f32 + slack.eye - self.rounding_eye,
        }
    }
}
