//! The cut of a tree for a view: which nodes are splats, which leaves are triangles.
//!
//! A node that cannot be seen is left out; one whose sphere is at most the threshold wide on the screen is a splat; a larger
//! leaf is a triangle; else the children decide. [`full`] asks from the root each time. [`CoherentCut`] keeps what it asked
//! for how far the camera may move until the answer can change, and asks again only then; the cut is the same.
//!
//! The WGSL twin of `View::judge` is `shaders/pop/judge.wesl`.

mod chunk;
mod coherent;
mod full;
mod judge;
mod view;

pub use coherent::{CoherentCut, Keep};
pub use full::full;
pub use view::{Projection, Root, View, ViewWords};

/// A cut.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Cut {
    /// Numbers of nodes to draw as splats, in the order of a walk from the root.
    pub splats: Vec<u32>,
    /// Numbers of the mesh's triangles to draw as such, in the same order.
    pub triangles: Vec<u32>,
    /// What it took.
    pub counts: Counts,
}

/// What a cut took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Nodes asked: tested against the view.
    pub evaluated: u64,
    /// Nodes left out because they are outside the view or turned away, each with all below it.
    pub culled: u64,
}

impl Cut {
    /// Nodes and leaves that are drawn.
    pub fn len(&self) -> usize {
        self.splats.len() + self.triangles.len()
    }

    /// Whether nothing is drawn.
    pub fn is_empty(&self) -> bool {
        self.splats.is_empty() && self.triangles.is_empty()
    }

    fn clear(&mut self) {
        self.splats.clear();
        self.triangles.clear();
        self.counts = Counts::default();
    }
}
