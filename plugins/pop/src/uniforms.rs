//! `TreeUniform` of `shaders/pop/tree.wesl`.

use crate::part::Part;
use bytemuck::{Pod, Zeroable};

/// Bytes from one uniform to the next, an offset that every device accepts.
pub(crate) const STRIDE: u32 = 256;

/// Levels that a tree may have: 2³⁰ nodes in groups of two or more.
const LEVELS: usize = 32;

/// See `shaders/pop/tree.wesl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct TreeUniform {
    pub(crate) origin: [f32; 3],
    pub(crate) step: f32,
    pub(crate) base: u32,
    pub(crate) node_count: u32,
    pub(crate) triangle_count: u32,
    pub(crate) vertex_count: u32,
    pub(crate) first_leaf: u32,
    pub(crate) count_at: u32,
    pub(crate) list_first: u32,
    pub(crate) list_step: u32,
    pub(crate) stretch: f32,
    pub(crate) point_px: f32,
    pub(crate) owns_vertices: u32,
    pub(crate) level_count: u32,
    pub(crate) level_starts: [u32; LEVELS],
}

impl TreeUniform {
    /// What of it the part alone decides.
    pub(crate) fn of(part: &Part, base: u32) -> Self {
        let starts = &part.tree.level_starts;
        let mut level_starts = [u32::MAX; LEVELS];
        for (level, &start) in level_starts.iter_mut().zip(starts) {
            *level = start;
        }
        Self {
            origin: part.tree.grid.origin,
            step: part.tree.grid.step,
            base,
            node_count: part.tree.nodes.len() as u32,
            triangle_count: part.triangle_count,
            vertex_count: part.vertex_count,
            first_leaf: part.tree.first_leaf(),
            list_step: 1,
            owns_vertices: part.owns_vertices.into(),
            level_count: starts.len().min(LEVELS) as u32,
            level_starts,
            ..Self::default()
        }
    }
}
