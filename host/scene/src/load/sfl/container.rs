//! The container of SFL files: a tree of directories of tagged values (GFF), big-endian throughout.
//!
//! A directory is a list of entries of 12 bytes that ends with a terminator: UPLINK ends a list of siblings, LINK leads to
//! the next sibling, DOWNLINK leads to the next sibling and to the first child. Every offset counts from the start of the
//! file. Nothing is followed that is not asked for, no directory is read twice, and all directories together hold no more
//! entries than fit into the file, so neither circles nor overlaps can hold a reader up.

use std::collections::HashSet;

use super::error::SflError;

/// Bytes of an entry.
const ENTRY_BYTES: usize = 12;

/// Bytes before the first directory.
const HEADER_BYTES: usize = 20;

const UPLINK: u16 = 0;
const LINK: u16 = 1;
const DOWNLINK: u16 = 2;

/// Type of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ValueType {
    U16,
    U32,
    F32,
    F64,
    Text,
    /// A large block: always stands behind an offset.
    Block,
    Offset,
    /// Anything else; only tags that this reader does not use have it.
    Other(u16),
}

impl ValueType {
    fn from_number(number: u16) -> Self {
        match number {
            2 => Self::U16,
            4 => Self::U32,
            6 => Self::F32,
            7 => Self::F64,
            8 => Self::Text,
            10 => Self::Block,
            11 => Self::Offset,
            other => Self::Other(other),
        }
    }

    /// Bytes of one element.
    fn size(self) -> u64 {
        match self {
            Self::Text | Self::Block | Self::Other(_) => 1,
            Self::U16 => 2,
            Self::U32 | Self::F32 | Self::Offset => 4,
            Self::F64 => 8,
        }
    }

    fn name(self) -> String {
        match self {
            Self::U16 => "UINT16".into(),
            Self::U32 => "UINT32".into(),
            Self::F32 => "FLOAT".into(),
            Self::F64 => "DOUBLE".into(),
            Self::Text => "ASCII".into(),
            Self::Block => "LDB".into(),
            Self::Offset => "OFFSET".into(),
            Self::Other(number) => format!("type {number}"),
        }
    }
}

/// One tagged value.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry<'a> {
    bytes: &'a [u8; ENTRY_BYTES],
    /// Where it stands.
    pub(super) byte: u64,
}

impl Entry<'_> {
    fn tag(&self) -> u16 {
        u16::from_be_bytes([self.bytes[0], self.bytes[1]])
    }

    pub(super) fn value_type(&self) -> ValueType {
        ValueType::from_number(u16::from_be_bytes([self.bytes[2], self.bytes[3]]))
    }

    /// Elements; the first offset of a DOWNLINK.
    pub(super) fn count(&self) -> u32 {
        let [.., a, b, c, d, _, _, _, _] = *self.bytes;
        u32::from_be_bytes([a, b, c, d])
    }

    /// The value, if it is one number of 32 bits; else its offset.
    fn word(&self) -> u32 {
        let [.., a, b, c, d] = *self.bytes;
        u32::from_be_bytes([a, b, c, d])
    }

    /// What it is: 'UINT32, 3 elements'.
    pub(super) fn describe(&self) -> String {
        let count = self.count();
        let s = if count == 1 { "" } else { "s" };
        format!("{}, {count} element{s}", self.value_type().name())
    }
}

/// A list of entries and what it leads to.
#[derive(Clone, Debug)]
pub(super) struct Directory<'a> {
    entries: &'a [u8],
    /// Where it starts.
    pub(super) byte: u64,
    /// Offset of the next sibling, and where that stands.
    next: Option<(u32, u64)>,
    /// Offset of the first child, and where that stands.
    pub(super) child: Option<(u32, u64)>,
    /// It holds nothing but the end of a list of siblings.
    is_end: bool,
}

impl<'a> Directory<'a> {
    /// The first entry of a tag, as the reference library takes it.
    pub(super) fn find(&self, tag: u16) -> Option<Entry<'a>> {
        self.entries().find(|entry| entry.tag() == tag)
    }

    fn entries(&self) -> impl Iterator<Item = Entry<'a>> + use<'a> {
        let byte = self.byte;
        let (entries, _) = self.entries.as_chunks::<ENTRY_BYTES>();
        entries.iter().enumerate().map(move |(index, bytes)| Entry {
            bytes,
            byte: byte + (index * ENTRY_BYTES) as u64,
        })
    }
}

/// A file whose header has been checked.
#[derive(Debug)]
pub(super) struct Container<'a> {
    file: &'a [u8],
    /// Offsets of the directories read so far.
    read: HashSet<u32>,
    /// Entries that may still be read.
    entries_left: usize,
}

impl<'a> Container<'a> {
    /// Checks the header and reads the root directory.
    pub(super) fn open(file: &'a [u8]) -> Result<(Self, Directory<'a>), SflError> {
        for (start, expected) in [(0, "GFLF"), (8, "SFLF")] {
            let found = file.get(start..).unwrap_or_default();
            if !found.starts_with(expected.as_bytes()) {
                return Err(SflError::NotSfl {
                    byte: start as u64,
                    expected,
                    found: found[..found.len().min(4)].escape_ascii().to_string(),
                });
            }
        }
        let word = |byte: usize| {
            file.get(byte..)?
                .first_chunk()
                .copied()
                .map(u32::from_be_bytes)
        };
        let (Some(container), Some(content), Some(root)) = (word(4), word(12), word(16)) else {
            return Err(SflError::BeyondEnd {
                byte: 0,
                what: "the header".into(),
                start: 0,
                length: HEADER_BYTES as u64,
                found: file.len() as u64,
            });
        };
        // The lowest byte is the minor number.
        for (byte, what, found) in [
            (4, "the container's version", container),
            (12, "the format's version", content),
        ] {
            if found > 0xff {
                return Err(SflError::Version { byte, what, found });
            }
        }
        let mut container = Self {
            file,
            read: HashSet::new(),
            entries_left: file.len() / ENTRY_BYTES,
        };
        let root = container.directory(root, 16)?;
        Ok((container, root))
    }

    /// The directory at `offset`, which stands at `named_at`.
    fn directory(&mut self, offset: u32, named_at: u64) -> Result<Directory<'a>, SflError> {
        let beyond_end = || SflError::BeyondEnd {
            byte: named_at,
            what: "a directory".into(),
            start: u64::from(offset),
            length: ENTRY_BYTES as u64,
            found: self.file.len() as u64,
        };
        let start = offset as usize;
        if start < HEADER_BYTES {
            return Err(SflError::Value {
                byte: named_at,
                what: "offset of a directory".into(),
                expected: format!("{HEADER_BYTES} or more"),
                found: offset.to_string(),
            });
        }
        if !self.read.insert(offset) {
            return Err(SflError::Cycle {
                byte: u64::from(offset),
            });
        }
        let rest = self.file.get(start..).ok_or_else(beyond_end)?;
        if rest.len() < ENTRY_BYTES {
            return Err(beyond_end());
        }
        let (all, _) = rest.as_chunks::<ENTRY_BYTES>();
        for (index, bytes) in all.iter().enumerate() {
            let entry = Entry {
                bytes,
                byte: u64::from(offset) + (index * ENTRY_BYTES) as u64,
            };
            self.entries_left = self.entries_left.checked_sub(1).ok_or(SflError::Cycle {
                byte: u64::from(offset),
            })?;
            let (next, child) = match entry.tag() {
                // A writer of the time cut a tag of 0x50000 to 16 bits; only an offset is an uplink.
                UPLINK if entry.value_type() == ValueType::Offset => (None, None),
                LINK => (Some((entry.word(), entry.byte)), None),
                DOWNLINK => (
                    Some((entry.count(), entry.byte)),
                    Some((entry.word(), entry.byte)),
                ),
                _ => continue,
            };
            return Ok(Directory {
                entries: rest.get(..index * ENTRY_BYTES).unwrap_or_default(),
                byte: u64::from(offset),
                next,
                child,
                is_end: index == 0 && entry.tag() == UPLINK,
            });
        }
        Err(SflError::BeyondEnd {
            byte: u64::from(offset),
            what: "a directory without an end".into(),
            start: u64::from(offset),
            length: (rest.len() + 1) as u64,
            found: self.file.len() as u64,
        })
    }

    /// The first child of `parent`; `None` if it has none.
    pub(super) fn first_child(
        &mut self,
        parent: &Directory<'a>,
    ) -> Result<Option<Directory<'a>>, SflError> {
        self.follow(parent.child)
    }

    /// The sibling after `directory`; `None` after the last.
    pub(super) fn next_sibling(
        &mut self,
        directory: &Directory<'a>,
    ) -> Result<Option<Directory<'a>>, SflError> {
        self.follow(directory.next)
    }

    /// Child `index` of `parent`; `None` if it has fewer.
    pub(super) fn child(
        &mut self,
        parent: &Directory<'a>,
        index: u32,
    ) -> Result<Option<Directory<'a>>, SflError> {
        let mut child = self.first_child(parent)?;
        for _ in 0..index {
            let Some(directory) = child else {
                return Ok(None);
            };
            child = self.next_sibling(&directory)?;
        }
        Ok(child)
    }

    fn follow(&mut self, link: Option<(u32, u64)>) -> Result<Option<Directory<'a>>, SflError> {
        let Some((offset, named_at)) = link else {
            return Ok(None);
        };
        let directory = self.directory(offset, named_at)?;
        Ok((!directory.is_end).then_some(directory))
    }

    /// The bytes of a value.
    pub(super) fn value_bytes(&self, entry: &Entry<'a>, what: &str) -> Result<&'a [u8], SflError> {
        let length = u64::from(entry.count()) * entry.value_type().size();
        if length <= 4 && entry.value_type() != ValueType::Block {
            return Ok(&entry.bytes[8..8 + length as usize]);
        }
        if length == 0 {
            return Ok(&[]);
        }
        let start = entry.word() as usize;
        let rest = self.file.get(start..).unwrap_or_default();
        let bytes = usize::try_from(length)
            .ok()
            .and_then(|length| rest.get(..length));
        bytes.ok_or_else(|| SflError::BeyondEnd {
            byte: entry.byte,
            what: what.to_owned(),
            start: start as u64,
            length,
            found: self.file.len() as u64,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(tag: u16, value_type: u16, count: u32, word: u32) -> Vec<u8> {
        [
            &tag.to_be_bytes()[..],
            &value_type.to_be_bytes(),
            &count.to_be_bytes(),
            &word.to_be_bytes(),
        ]
        .concat()
    }

    fn file(entries: &[Vec<u8>]) -> Vec<u8> {
        let mut file = b"GFLF\0\0\0\0SFLF\0\0\0\0\0\0\0\x14".to_vec();
        file.extend(entries.concat());
        file
    }

    #[test]
    fn children_are_those_up_to_the_uplink() {
        // Root at 20 (two entries), children at 44 and 56, the end at 68.
        let bytes = file(&[
            entry(0x100, 8, 4, u32::from_be_bytes(*b"abc\0")),
            entry(DOWNLINK, 12, 0, 44),
            entry(LINK, 11, 1, 56),
            entry(LINK, 11, 1, 68),
            entry(UPLINK, 11, 1, 0),
        ]);
        let (mut container, root) = Container::open(&bytes).unwrap();
        let title = root.find(0x100).unwrap();
        assert_eq!(container.value_bytes(&title, "title").unwrap(), b"abc\0");
        let first = container.first_child(&root).unwrap().unwrap();
        let second = container.next_sibling(&first).unwrap().unwrap();
        assert_eq!((first.byte, second.byte), (44, 56));
        assert!(container.next_sibling(&second).unwrap().is_none());
        assert!(
            matches!(
                container.first_child(&root),
                Err(SflError::Cycle { byte: 44 })
            ),
            "nothing is read twice"
        );
    }

    #[test]
    fn a_number_under_tag_0_is_no_uplink() {
        let bytes = file(&[entry(UPLINK, 6, 1, 7), entry(LINK, 11, 1, 0)]);
        let (mut container, root) = Container::open(&bytes).unwrap();
        assert!(!root.is_end && container.first_child(&root).unwrap().is_none());
    }

    #[test]
    fn overlapping_directories_run_out_of_entries() {
        // Each directory starts one entry after the last one and runs to the same end.
        let mut entries = vec![entry(DOWNLINK, 12, 0, 32)];
        entries.extend((0..20).map(|_| entry(0x7777, 4, 1, 0)));
        entries.push(entry(LINK, 11, 1, 44));
        let bytes = file(&entries);
        let (mut container, root) = Container::open(&bytes).unwrap();
        let child = container.first_child(&root).unwrap().unwrap();
        assert!(matches!(
            container.next_sibling(&child),
            Err(SflError::Cycle { byte: 44 })
        ));
    }

    #[test]
    fn headers_are_checked() {
        let good = file(&[entry(UPLINK, 11, 1, 0)]);
        assert!(Container::open(&good).is_ok());
        for (byte, value) in [(0, b'g'), (11, b'X'), (6, 1), (14, 1), (19, 0), (19, 200)] {
            let mut bad = good.clone();
            bad[byte] = value;
            assert!(Container::open(&bad).is_err(), "byte {byte}");
        }
        for (byte, value) in [(7, 3), (15, 9)] {
            let mut newer = good.clone();
            newer[byte] = value;
            assert!(
                Container::open(&newer).is_ok(),
                "minor version at byte {byte}"
            );
        }
    }
}
