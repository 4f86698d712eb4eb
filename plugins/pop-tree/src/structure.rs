//! What holds for every tree that [`crate::build()`] makes, checked of one that came from elsewhere.
//!
//! A tree that passes leads a traversal from the root to every node once, in at most as many steps as there are levels, to
//! triangles that there are. Whether the spheres hold what is below them is not checked: if not, a picture is wrong.

use crate::node::{Node, decode_radius};
use crate::tree::Tree;

/// What is wrong, and where.
#[derive(Debug, PartialEq)]
pub(crate) struct Fault {
    pub(crate) what: String,
    pub(crate) place: Place,
}

/// Part of a tree.
#[derive(Debug, PartialEq)]
pub(crate) enum Place {
    Grid,
    /// The start of a level.
    Level(usize),
    Node(usize),
}

/// The first fault of a tree, if it has one.
pub(crate) fn check(tree: &Tree) -> Result<(), Fault> {
    if !(tree.grid.step > 0.0
        && tree.grid.step.is_finite()
        && tree.grid.origin.iter().all(|at| at.is_finite()))
    {
        return Err(fault(
            "the grid is not finite, or without extent".to_owned(),
            Place::Grid,
        ));
    }
    check_starts(tree)?;
    let ends = tree
        .level_starts
        .iter()
        .skip(1)
        .copied()
        .chain([tree.nodes.len() as u32]);
    let levels: Vec<_> = tree
        .level_starts
        .iter()
        .zip(ends)
        .map(|(&start, end)| start as usize..end as usize)
        .collect();
    for pair in levels.windows(2) {
        let (level, below) = (&pair[0], &pair[1]);
        let mut next = below.start;
        for number in level.clone() {
            next = check_inner(&tree.nodes, number, next, below.end)?;
        }
        if next != below.end {
            let what = format!(
                "the level has the nodes up to {}, but no parent from {next} on",
                below.end
            );
            return Err(fault(what, Place::Node(next)));
        }
    }
    check_leaves(tree)
}

fn fault(what: String, place: Place) -> Fault {
    Fault { what, place }
}

/// Levels begin one after the other, the root's with one node.
fn check_starts(tree: &Tree) -> Result<(), Fault> {
    let mut least = 0;
    for (level, &start) in tree.level_starts.iter().enumerate() {
        let greatest = if level < 2 {
            level as u32
        } else {
            tree.nodes.len() as u32 - 1
        };
        if !(least..=greatest).contains(&start) || start as usize >= tree.nodes.len() {
            let what = format!(
                "level {level} starts at node {start}, not at one of {least} to {greatest}"
            );
            return Err(fault(what, Place::Level(level)));
        }
        least = start + 1;
    }
    let root_alone = tree.level_starts.len() != 1 || tree.nodes.len() == 1;
    if tree.level_starts.is_empty() != tree.nodes.is_empty() || !root_alone {
        let what = format!(
            "{} levels have {} nodes",
            tree.level_starts.len(),
            tree.nodes.len()
        );
        return Err(fault(what, Place::Level(0)));
    }
    Ok(())
}

/// A node's children begin at `next`, end by `end`, and are smaller; returns where they end.
fn check_inner(nodes: &[Node], number: usize, next: usize, end: usize) -> Result<usize, Fault> {
    let node = nodes[number];
    let children = node.children();
    let range = children.start as usize..children.end as usize;
    if range.start != next || range.end > end {
        let what = format!(
            "node {number} has the children {range:?}, which should start at {next} and end by {end}"
        );
        return Err(fault(what, Place::Node(number)));
    }
    if let Some(child) = range
        .clone()
        .find(|&child| nodes[child].radius_code() >= node.radius_code())
    {
        let what = format!("node {number} is not greater than its child {child}");
        return Err(fault(what, Place::Node(number)));
    }
    if !decode_radius(node.radius_code()).is_finite() {
        return Err(fault(
            format!("node {number} has no finite radius"),
            Place::Node(number),
        ));
    }
    Ok(range.end)
}

/// Leaves' triangles are as many as the leaves.
fn check_leaves(tree: &Tree) -> Result<(), Fault> {
    let count = tree.leaves().len();
    for number in tree.leaves() {
        let leaf = tree.nodes[number as usize];
        if leaf.link() as usize >= count {
            let what = format!(
                "leaf {number} is of triangle {}, but there are {count}",
                leaf.link()
            );
            return Err(fault(what, Place::Node(number as usize)));
        }
        if !decode_radius(leaf.radius_code()).is_finite() {
            return Err(fault(
                format!("leaf {number} has no finite radius"),
                Place::Node(number as usize),
            ));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{Place, check};
    use crate::{Grid, Node, Tree};
    use pointstage_plugin_api::glam::Vec3;

    fn node(radius_code: u32, link: u32) -> Node {
        Node([0, 0, radius_code, 0, link])
    }

    /// Seven leaves in two groups.
    fn tree() -> Tree {
        let inner = [
            node(9, Node::link_to(1, 2)),
            node(8, Node::link_to(3, 3)),
            node(8, Node::link_to(6, 4)),
        ];
        let leaves = (0..7).map(|triangle| node(7, triangle));
        Tree {
            grid: Grid::over(Vec3::ZERO, Vec3::ONE),
            nodes: inner.into_iter().chain(leaves).collect(),
            level_starts: vec![0, 1, 3],
        }
    }

    fn place_of_fault(change: impl FnOnce(&mut Tree)) -> Option<Place> {
        let mut tree = tree();
        change(&mut tree);
        check(&tree).err().map(|fault| fault.place)
    }

    #[test]
    fn a_sound_tree_passes_and_so_do_none_and_one() {
        assert_eq!(check(&tree()), Ok(()));
        let grid = Grid::over(Vec3::ZERO, Vec3::ZERO);
        assert_eq!(
            check(&Tree {
                grid,
                nodes: vec![],
                level_starts: vec![]
            }),
            Ok(())
        );
        assert_eq!(
            check(&Tree {
                grid,
                nodes: vec![node(0, 0)],
                level_starts: vec![0]
            }),
            Ok(())
        );
    }

    #[test]
    fn faults_are_found_where_they_are() {
        let node_fault = |number: usize, new: Node| place_of_fault(|tree| tree.nodes[number] = new);
        assert_eq!(
            node_fault(0, node(9, Node::link_to(0, 2))),
            Some(Place::Node(0)),
            "a loop"
        );
        assert_eq!(
            node_fault(1, node(8, Node::link_to(3, 2))),
            Some(Place::Node(2)),
            "a gap"
        );
        assert_eq!(
            node_fault(2, node(8, Node::link_to(6, 3))),
            Some(Place::Node(9)),
            "a leaf without parent"
        );
        assert_eq!(
            node_fault(2, node(8, Node::link_to(u32::MAX >> 2, 4))),
            Some(Place::Node(2)),
            "out of range"
        );
        assert_eq!(
            node_fault(2, node(7, Node::link_to(6, 4))),
            Some(Place::Node(2)),
            "no margin"
        );
        assert_eq!(
            node_fault(5, node(7, 7)),
            Some(Place::Node(5)),
            "no such triangle"
        );
        assert_eq!(
            node_fault(0, node(0xff00, Node::link_to(1, 2))),
            Some(Place::Node(0)),
            "endless radius"
        );
        for starts in [
            vec![0, 1],
            vec![0, 2, 3],
            vec![0, 1, 1],
            vec![1, 2, 3],
            vec![0, 1, 10],
            vec![0],
            vec![],
        ] {
            assert!(
                place_of_fault(|tree| tree.level_starts = starts.clone()).is_some(),
                "{starts:?}"
            );
        }
        assert_eq!(
            place_of_fault(|tree| tree.grid.step = f32::NAN),
            Some(Place::Grid)
        );
        assert_eq!(
            place_of_fault(|tree| tree.grid.origin[1] = f32::INFINITY),
            Some(Place::Grid)
        );
    }
}
