//! The tree of a model fragment, walked to its leaves.
//!
//! Groups of siblings lie behind one another in breadth-first order; a pointer at the start of a group leads to the groups of
//! its nodes' children. The walk is depth first, so that leaves that are neighbours in space follow one another. It only
//! ever moves on in the file, and no more nodes are visited than the fragment has room for.

use glam::DVec3;

use super::codes::{Sphere, colour, normal};
use super::error::QsError;
use crate::load::assemble::MAX_COORDINATE;

/// Bytes of the header of a model fragment.
pub(super) const MODEL_HEADER_BYTES: usize = 40;

/// Levels below the root that are followed; a tree of 2⁶⁴ leaves would be as deep.
const MAX_DEPTH: u32 = 64;

/// A leaf, as a surfel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaf {
    pub(super) sphere: Sphere,
    pub(super) normal: DVec3,
    /// White, where the fragment has no colours.
    pub(super) rgb: [u8; 3],
}

/// A fragment with a model.
#[derive(Clone, Copy, Debug)]
pub(super) struct Model<'a> {
    /// All of it, header included.
    bytes: &'a [u8],
    /// Where it starts in the file.
    start: u64,
    pub(super) leaf_count: u32,
    pub(super) has_colours: bool,
    pub(super) root: Sphere,
    child_count: usize,
}

/// Siblings whose nodes have not been read yet.
#[derive(Clone, Copy, Debug)]
struct Group {
    offset: usize,
    count: usize,
    has_pointer: bool,
    parent: Sphere,
    depth: u32,
}

impl<'a> Model<'a> {
    /// Reads the header of a model fragment.
    pub(super) fn read(
        bytes: &'a [u8],
        start: u64,
        leaf_count: u32,
        has_colours: bool,
    ) -> Result<Self, QsError> {
        if bytes.len() < MODEL_HEADER_BYTES {
            return Err(QsError::BeyondEnd {
                byte: start,
                what: "the header of a model",
                length: MODEL_HEADER_BYTES as u64,
                found: bytes.len() as u64,
                whole: "the fragment",
            });
        }
        let float = |offset: usize| f64::from(f32::from_bits(u32_at(bytes, offset)));
        let root = Sphere {
            centre: DVec3::new(float(20), float(24), float(28)),
            radius: float(32),
        };
        // Written so that NaN fails.
        let is_usable = root.centre.is_finite()
            && root.centre.abs().max_element() <= MAX_COORDINATE
            && root.radius >= 0.0
            && root.radius <= MAX_COORDINATE;
        if !is_usable {
            return Err(QsError::Value {
                byte: start + 20,
                what: "centre and radius of the root",
                expected: "finite numbers, and a radius of 0 or more".into(),
                found: format!("{} and {}", root.centre, root.radius),
            });
        }
        let child_count = u32_at(bytes, 36);
        if child_count > 4 {
            return Err(QsError::Value {
                byte: start + 36,
                what: "children of the root",
                expected: "0 to 4".into(),
                found: child_count.to_string(),
            });
        }
        Ok(Self {
            bytes,
            start,
            leaf_count,
            has_colours,
            root,
            child_count: child_count as usize,
        })
    }

    const fn node_bytes(&self) -> usize {
        if self.has_colours { 6 } else { 4 }
    }

    const fn group_bytes(&self, count: usize, has_pointer: bool) -> usize {
        count * self.node_bytes() + if has_pointer { 4 } else { 0 }
    }

    /// Calls `each` for every leaf, depth first, and `pause` before every group.
    pub(super) fn leaves<E: From<QsError>>(
        &self,
        mut pause: impl FnMut(usize) -> Result<(), E>,
        mut each: impl FnMut(Leaf),
    ) -> Result<(), E> {
        if self.child_count == 0 {
            return Ok(());
        }
        let mut nodes_left = self.bytes.len() / self.node_bytes();
        let mut groups = vec![Group {
            offset: MODEL_HEADER_BYTES,
            count: self.child_count,
            // The header's leaves tell; there is no flag.
            has_pointer: self.leaf_count as usize > self.child_count,
            parent: self.root,
            depth: 1,
        }];
        while let Some(group) = groups.pop() {
            pause(nodes_left)?;
            nodes_left = nodes_left
                .checked_sub(group.count)
                .ok_or_else(|| QsError::Value {
                    byte: self.start + group.offset as u64,
                    what: "nodes of a fragment",
                    expected: "no more than it has room for".into(),
                    found: "groups that overlap".into(),
                })?;
            let first_of_group = groups.len();
            self.read_group(&group, &mut groups, &mut each)?;
            // The first child's group is the next to be read.
            groups[first_of_group..].reverse();
        }
        Ok(())
    }

    /// Reads one group: leaves go to `each`, groups of children to `groups`.
    fn read_group(
        &self,
        group: &Group,
        groups: &mut Vec<Group>,
        each: &mut impl FnMut(Leaf),
    ) -> Result<(), QsError> {
        let byte = self.start + group.offset as u64;
        let length = self.group_bytes(group.count, group.has_pointer);
        let rest = self.bytes.get(group.offset..).unwrap_or_default();
        let Some(bytes) = rest.get(..length) else {
            return Err(QsError::BeyondEnd {
                byte,
                what: "a group of nodes",
                length: length as u64,
                found: rest.len() as u64,
                whole: "the fragment",
            });
        };
        let mut child_offset = None;
        let mut nodes = bytes;
        if group.has_pointer {
            let pointer = u32_at(bytes, 0);
            if (pointer as usize) < length || pointer as usize >= rest.len() {
                return Err(QsError::Value {
                    byte,
                    what: "pointer to the groups of children",
                    expected: format!(
                        "{length} or more, and less than the {} to the end",
                        rest.len()
                    ),
                    found: pointer.to_string(),
                });
            }
            child_offset = Some(group.offset + pointer as usize);
            nodes = &bytes[4..];
        }
        for (index, node) in nodes.chunks_exact(self.node_bytes()).enumerate() {
            let byte = byte + (length - nodes.len() + index * self.node_bytes()) as u64;
            let (first, second) = (u16_at(node, 0), u16_at(node, 2));
            let sphere = group
                .parent
                .child(first >> 3)
                .ok_or_else(|| QsError::Value {
                    byte,
                    what: "code of a sphere",
                    expected: format!("one below {}", Sphere::code_count()),
                    found: (first >> 3).to_string(),
                })?;
            // One less than the children, and 0 for a leaf.
            let child_code = usize::from(first & 3);
            if child_code == 0 {
                each(Leaf {
                    sphere,
                    normal: normal(second >> 2),
                    rgb: if self.has_colours {
                        colour(u16_at(node, 4))
                    } else {
                        [255; 3]
                    },
                });
                continue;
            }
            let count = child_code + 1;
            let has_pointer = first & 4 != 0;
            let Some(offset) = &mut child_offset else {
                return Err(QsError::Value {
                    byte,
                    what: "children of a node",
                    expected: "0, since its group has no pointer to any".into(),
                    found: count.to_string(),
                });
            };
            if group.depth >= MAX_DEPTH {
                return Err(QsError::Value {
                    byte,
                    what: "depth of the tree",
                    expected: format!("{MAX_DEPTH} levels at most"),
                    found: "more".into(),
                });
            }
            groups.push(Group {
                offset: *offset,
                count,
                has_pointer,
                parent: sphere,
                depth: group.depth + 1,
            });
            *offset += self.group_bytes(count, has_pointer);
        }
        Ok(())
    }
}

/// Four bytes that are there, by the checks of whoever asks; 0 otherwise.
#[inline]
pub(super) fn u32_at(bytes: &[u8], offset: usize) -> u32 {
    let number = bytes.get(offset..).and_then(<[u8]>::first_chunk);
    number.copied().map_or(0, u32::from_be_bytes)
}

/// Two bytes that are there, by the checks of whoever asks; 0 otherwise.
#[inline]
fn u16_at(bytes: &[u8], offset: usize) -> u16 {
    let number = bytes.get(offset..).and_then(<[u8]>::first_chunk);
    number.copied().map_or(0, u16::from_be_bytes)
}
