//! The tree: nodes by level, the root first and the leaves last.

use crate::node::{Grid, Node};
use core::ops::Range;

/// A tree of bounding spheres over the triangles of a mesh.
///
/// Nodes lie level by level from the root, children of a node side by side and in their parents' order. All leaves are on
/// the last level, one for each triangle. A mesh without triangles has no node at all.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    /// The lattice that centres lie on.
    pub grid: Grid,
    /// All nodes.
    pub nodes: Vec<Node>,
    /// Number of the first node of each level, from the root's level.
    pub level_starts: Vec<u32>,
}

impl Tree {
    /// Number of the first leaf; the leaves are all nodes from here on.
    #[inline]
    pub fn first_leaf(&self) -> u32 {
        self.level_starts.last().copied().unwrap_or_default()
    }

    /// Numbers of the leaves.
    pub fn leaves(&self) -> Range<u32> {
        self.first_leaf()..self.nodes.len() as u32
    }

    /// Triangles in the order of the leaves: numbers of the mesh's triangles.
    pub fn leaf_triangles(&self) -> impl ExactSizeIterator<Item = u32> + '_ {
        self.nodes[self.first_leaf() as usize..]
            .iter()
            .map(|node| node.link())
    }
}
