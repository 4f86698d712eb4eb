//! The cut from the root, each time.

use super::Cut;
use super::view::{Judged, Open, Verdict, View};
use crate::tree::Tree;

/// The cut of a tree, asked from the root.
pub fn full(tree: &Tree, view: &View, cut: &mut Cut) {
    cut.clear();
    if !tree.nodes.is_empty() {
        walk(tree, view, 0, view.all_open(), cut);
    }
}

/// The cut below a node, itself included.
fn walk(tree: &Tree, view: &View, node: u32, open: Open, cut: &mut Cut) {
    let packed = tree.nodes[node as usize];
    cut.counts.evaluated += 1;
    let Judged { verdict, open, .. } = view.judge::<false>(packed, open);
    match verdict {
        Verdict::Culled => cut.counts.culled += 1,
        Verdict::Small => cut.splats.push(node),
        Verdict::Large if node >= tree.first_leaf() => cut.triangles.push(packed.link()),
        Verdict::Large => {
            for child in packed.children() {
                walk(tree, view, child, open, cut);
            }
        }
    }
}
