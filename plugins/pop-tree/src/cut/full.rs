//! The cut from the root, each time.

use super::Cut;
use super::judge::{Open, Verdict};
use super::view::View;
use crate::tree::Tree;
use core::ops::Range;

/// The cut of a tree, asked from the root.
pub fn full(tree: &Tree, view: &View, cut: &mut Cut) {
    cut.clear();
    if !tree.nodes.is_empty() {
        walk(tree, view, 0..1, view.all_open(), cut);
    }
}

/// The cut below siblings, themselves included.
fn walk(tree: &Tree, view: &View, siblings: Range<u32>, open: Open, cut: &mut Cut) {
    let nodes = &tree.nodes[siblings.start as usize..siblings.end as usize];
    cut.counts.evaluated += nodes.len() as u64;
    let answers = view.judge::<false>(nodes, open);
    for (place, (number, node)) in siblings.zip(nodes).enumerate() {
        match answers.of(place) {
            (Verdict::Culled, _) => cut.counts.culled += 1,
            (Verdict::Small, _) => cut.splats.push(number),
            (Verdict::Large, _) if number >= tree.first_leaf() => cut.triangles.push(node.link()),
            (Verdict::Large, open) => walk(tree, view, node.children(), open, cut),
        }
    }
}
