//! Directories of the container, as bytes.

use crate::load::sfl::Tag;

/// Bytes of an entry.
pub(super) const ENTRY_BYTES: u64 = 12;

/// Types of values.
const U16: u16 = 2;
const U32: u16 = 4;
const F32: u16 = 6;
const TEXT: u16 = 8;
const BLOCK: u16 = 10;
const OFFSET: u16 = 11;
const TWO_OFFSETS: u16 = 12;

/// Tags of the container itself.
const UPLINK: u16 = 0;
const LINK: u16 = 1;
const DOWNLINK: u16 = 2;
const CHILD_COUNT: u16 = 3;

/// A directory in the making.
#[derive(Clone, Debug, Default)]
pub(super) struct Directory {
    entries: Vec<Entry>,
}

#[derive(Clone, Debug)]
struct Entry {
    tag: u16,
    value_type: u16,
    count: u32,
    value: Value,
}

#[derive(Clone, Debug)]
enum Value {
    Bytes(Vec<u8>),
    /// The bytes right behind the directory.
    Behind,
}

/// How a directory ends.
#[derive(Clone, Copy, Debug)]
pub(super) enum End {
    /// With the offset of the next sibling.
    Leaf { next: u64 },
    /// With the offsets of the next sibling and the first child.
    Parent {
        next: u64,
        first_child: u64,
        children: u32,
    },
}

impl Directory {
    fn push(&mut self, tag: Tag, value_type: u16, count: usize, bytes: Vec<u8>) {
        self.entries.push(Entry {
            tag: tag.number,
            value_type,
            count: count as u32,
            value: Value::Bytes(bytes),
        });
    }

    /// A text, with the NUL that ends it.
    pub(super) fn text(&mut self, tag: Tag, text: &str) {
        let mut bytes: Vec<u8> = text.bytes().filter(|byte| *byte != 0).collect();
        bytes.push(0);
        self.push(tag, TEXT, bytes.len(), bytes);
    }

    pub(super) fn u32s(&mut self, tag: Tag, values: &[u32]) {
        let bytes = values.iter().flat_map(|value| value.to_be_bytes());
        self.push(tag, U32, values.len(), bytes.collect());
    }

    pub(super) fn u16s(&mut self, tag: Tag, values: &[u16]) {
        let bytes = values.iter().flat_map(|value| value.to_be_bytes());
        self.push(tag, U16, values.len(), bytes.collect());
    }

    pub(super) fn f32s(&mut self, tag: Tag, values: &[f32]) {
        let bytes = values.iter().flat_map(|value| value.to_be_bytes());
        self.push(tag, F32, values.len(), bytes.collect());
    }

    /// A block of `length` bytes right behind the directory, which must have no other value there.
    pub(super) fn block(&mut self, tag: Tag, length: u64) {
        self.entries.push(Entry {
            tag: tag.number,
            value_type: BLOCK,
            count: length as u32,
            value: Value::Behind,
        });
    }

    /// Bytes with all values but the block, for a directory with or without children.
    pub(super) fn byte_count(&self, has_children: bool) -> u64 {
        let end = if has_children { 2 } else { 1 };
        let values = self.entries.iter().map(|entry| match &entry.value {
            Value::Bytes(bytes) if bytes.len() > 4 => (bytes.len() as u64).next_multiple_of(4),
            _ => 0,
        });
        (self.entries.len() as u64 + end) * ENTRY_BYTES + values.sum::<u64>()
    }

    /// The bytes, for a directory at `offset`. All offsets fit 32 bits.
    pub(super) fn write(&self, offset: u64, end: End) -> Vec<u8> {
        let has_children = matches!(end, End::Parent { .. });
        let mut entries = Vec::new();
        let mut values = Vec::new();
        let terminators = if has_children { 2 } else { 1 };
        let values_offset = offset + (self.entries.len() as u64 + terminators) * ENTRY_BYTES;
        let behind = offset + self.byte_count(has_children);
        for entry in &self.entries {
            let mut word = [0; 4];
            match &entry.value {
                Value::Bytes(bytes) if bytes.len() <= 4 => {
                    word[..bytes.len()].copy_from_slice(bytes);
                }
                Value::Bytes(bytes) => {
                    word = ((values_offset + values.len() as u64) as u32).to_be_bytes();
                    values.extend(bytes);
                    values.resize(values.len().next_multiple_of(4), 0);
                }
                // A block of nothing is nowhere.
                Value::Behind if entry.count == 0 => {}
                Value::Behind => word = (behind as u32).to_be_bytes(),
            }
            push_entry(&mut entries, entry.tag, entry.value_type, entry.count, word);
        }
        match end {
            End::Leaf { next } => {
                push_entry(&mut entries, LINK, OFFSET, 1, (next as u32).to_be_bytes());
            }
            End::Parent {
                next,
                first_child,
                children,
            } => {
                // The reference library counts the directory that closes the list, too.
                let count = (children + 1).to_be_bytes();
                push_entry(&mut entries, CHILD_COUNT, U32, 1, count);
                let first = (first_child as u32).to_be_bytes();
                push_entry(&mut entries, DOWNLINK, TWO_OFFSETS, next as u32, first);
            }
        }
        entries.extend(values);
        entries
    }
}

/// The directory that closes a list; `up` is where the parent's level goes on.
pub(super) fn closing(up: u64) -> Vec<u8> {
    let mut entries = Vec::new();
    push_entry(&mut entries, UPLINK, OFFSET, 1, (up as u32).to_be_bytes());
    entries
}

fn push_entry(entries: &mut Vec<u8>, tag: u16, value_type: u16, count: u32, word: [u8; 4]) {
    entries.extend(tag.to_be_bytes());
    entries.extend(value_type.to_be_bytes());
    entries.extend(count.to_be_bytes());
    entries.extend(word);
}
