//! How many nodes each level has: that follows from the number of triangles alone.

/// The most nodes that a group holds.
pub(crate) const GROUP: usize = 4;

/// Groups that `count` nodes are divided into; `count` is not 0.
///
/// After d halvings there are 2ᵈ parts of f = ⌊count / 2ᵈ⌋ or f + 1 nodes, count mod 2ᵈ of the latter. At the first d with
/// f ≤ 4 only parts of 5 are too large, and those become two groups each.
pub(crate) fn group_count(count: usize) -> usize {
    let halvings = (0..usize::BITS)
        .find(|halvings| count >> halvings <= GROUP)
        .unwrap_or(0);
    let parts = 1 << halvings;
    if count >> halvings == GROUP {
        parts + count % parts
    } else {
        parts
    }
}

/// Times that the largest part of `count` nodes is halved, about.
pub(crate) fn halvings(count: usize) -> u64 {
    u64::from(
        (count.max(1) - 1)
            .checked_ilog2()
            .map_or(0, |log| (log + 1).saturating_sub(2)),
    )
}

/// Nodes of each level, from the leaves' level to the root's; none for no leaves.
pub(crate) fn level_sizes(leaf_count: usize) -> Vec<usize> {
    if leaf_count == 0 {
        return Vec::new();
    }
    let mut sizes = vec![leaf_count];
    let mut size = leaf_count;
    while size > 1 {
        size = group_count(size);
        sizes.push(size);
    }
    sizes
}

/// Nodes of the tree of a mesh.
pub fn node_count(triangle_count: usize) -> usize {
    level_sizes(triangle_count).into_iter().sum()
}

#[cfg(test)]
mod tests {
    use super::{GROUP, group_count, halvings, level_sizes};

    fn counted(count: usize) -> usize {
        if count <= GROUP {
            1
        } else {
            counted(count / 2) + counted(count - count / 2)
        }
    }

    #[test]
    fn groups_are_those_of_the_recursion() {
        for count in (1..5000).chain([65_535, 65_536, 65_537, 100_003]) {
            assert_eq!(group_count(count), counted(count), "{count}");
        }
    }

    #[test]
    fn nodes_are_those_of_the_thesis_table_5_6() {
        let table = [
            (96_966, 140_657),
            (871_414, 1_220_939),
            (1_000_000, 1_349_525),
            (4_000_000, 5_398_101),
        ];
        for (triangles, nodes) in table {
            assert_eq!(
                level_sizes(triangles).iter().sum::<usize>(),
                nodes,
                "{triangles}"
            );
        }
    }

    #[test]
    fn one_leaf_is_the_root_and_none_is_nothing() {
        assert_eq!(level_sizes(1), [1]);
        assert_eq!(level_sizes(2), [2, 1]);
        assert!(level_sizes(0).is_empty());
    }

    #[test]
    fn halvings_end_at_groups() {
        assert_eq!(
            [1, 4, 5, 8, 9, 1_000_000].map(halvings),
            [0, 0, 1, 1, 2, 18]
        );
    }
}
