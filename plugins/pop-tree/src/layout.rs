//! The final order of nodes: level by level from the root, children side by side and in their parents' order.

use crate::build::Level;
use crate::crew::{Cancelled, Crew, Hand};
use crate::node::{Grid, Node};
use crate::tree::Tree;
use bytemuck::zeroed_vec;

/// Nodes that a task lays out.
const STRETCH: usize = 1 << 13;

/// Units of work of a node; see [`Crew::new`].
pub(crate) const LAYOUT_UNITS: u64 = 20;

/// Joins levels, from the leaves to the root, to a tree.
pub(crate) fn lay_out(
    grid: Grid,
    mut levels: Vec<Level>,
    crew: &mut Crew<'_>,
) -> Result<Tree, Cancelled> {
    let node_count = levels.iter().map(|level| level.nodes.len()).sum();
    let mut nodes: Vec<Node> = zeroed_vec(node_count);
    let mut level_starts = Vec::with_capacity(levels.len());
    let mut rest = nodes.as_mut_slice();
    let mut start = 0;
    // Numbers of the level's nodes as they were made, in final order.
    let mut order = vec![0];
    while let Some(level) = levels.pop() {
        let (final_nodes, below) = rest.split_at_mut(level.nodes.len());
        rest = below;
        level_starts.push(start);
        start += final_nodes.len() as u32;
        if let Some(children) = levels.last() {
            order = lay_out_inner(&level, children, &order, final_nodes, start, crew)?;
        } else {
            lay_out_leaves(&level, &order, final_nodes, crew)?;
        }
    }
    Ok(Tree {
        grid,
        nodes,
        level_starts,
    })
}

/// Lays out a level of inner nodes whose children begin at `first_child`; returns the order of the children.
fn lay_out_inner(
    level: &Level,
    children: &Level,
    order: &[u32],
    final_nodes: &mut [Node],
    first_child: u32,
    crew: &mut Crew<'_>,
) -> Result<Vec<u32>, Cancelled> {
    let mut child_order = zeroed_vec(children.nodes.len());
    let mut rest = child_order.as_mut_slice();
    let mut first = first_child;
    let mut tasks = Vec::with_capacity(order.len().div_ceil(STRETCH));
    for (order, final_nodes) in order.chunks(STRETCH).zip(final_nodes.chunks_mut(STRETCH)) {
        let count = order
            .iter()
            .map(|&number| level.nodes[number as usize].children().len())
            .sum();
        let (child_order, behind) = rest.split_at_mut(count);
        rest = behind;
        tasks.push((order, final_nodes, child_order, first));
        first += count as u32;
    }
    let lay_out_stretch =
        |(order, final_nodes, child_order, first): (&[u32], &mut [Node], &mut [u32], u32),
         hand: &Hand<'_, _>| {
            let mut laid_out = 0;
            for (&number, final_node) in order.iter().zip(final_nodes) {
                let node = level.nodes[number as usize];
                let range = node.children();
                *final_node =
                    node.with_link(Node::link_to(first + laid_out as u32, range.len() as u32));
                for record in &children.records[range.start as usize..range.end as usize] {
                    child_order[laid_out] = record.node;
                    laid_out += 1;
                }
            }
            hand.advance(LAYOUT_UNITS * order.len() as u64);
        };
    crew.run("laying out", order.len(), tasks, lay_out_stretch)?;
    Ok(child_order)
}

/// Lays out the leaves: each in the place of its triangle.
fn lay_out_leaves(
    level: &Level,
    order: &[u32],
    final_nodes: &mut [Node],
    crew: &mut Crew<'_>,
) -> Result<(), Cancelled> {
    let tasks = order
        .chunks(STRETCH)
        .zip(final_nodes.chunks_mut(STRETCH))
        .collect();
    crew.run(
        "laying out",
        order.len(),
        tasks,
        |(order, final_nodes), hand: &Hand<'_, _>| {
            for (&number, final_node) in order.iter().zip(final_nodes) {
                *final_node = level.nodes[number as usize];
            }
            hand.advance(LAYOUT_UNITS * order.len() as u64);
        },
    )
}
