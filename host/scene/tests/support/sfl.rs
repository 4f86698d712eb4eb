//! SFL files made up by tests: one list of sets, laid out as simply as can be.

/// A surfel set.
#[derive(Clone, Debug, Default)]
pub(crate) struct Set {
    pub(crate) mask: Vec<u32>,
    /// Number and offset of each property.
    pub(crate) layout: Vec<(u16, u32)>,
    pub(crate) record_bytes: u32,
    /// Records of each resolution.
    pub(crate) levels: Vec<Vec<u8>>,
    /// More entries of the set: tag, type, number of elements, bytes.
    pub(crate) entries: Vec<(u16, u16, u32, Vec<u8>)>,
}

/// A directory's entries become bytes in two steps: values of more than four bytes go behind all directories.
struct Writer {
    bytes: Vec<u8>,
}

impl Writer {
    fn align(&mut self) {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
    }

    /// Puts values at the end, and returns where they are.
    fn put(&mut self, value: &[u8]) -> u32 {
        self.align();
        let at = self.bytes.len() as u32;
        self.bytes.extend(value);
        self.align();
        at
    }

    /// Puts a directory at the end; its values lie before it. `next` and `child` are offsets.
    fn directory(
        &mut self,
        entries: &[(u16, u16, u32, Vec<u8>)],
        next: u32,
        child: Option<u32>,
    ) -> u32 {
        let words: Vec<[u8; 4]> = entries
            .iter()
            .map(|(_, value_type, _, value)| {
                if *value_type == 10 || value.len() > 4 {
                    return self.put(value).to_be_bytes();
                }
                let mut word = [0; 4];
                word[..value.len()].copy_from_slice(value);
                word
            })
            .collect();
        self.align();
        let at = self.bytes.len() as u32;
        for ((tag, value_type, count, _), word) in entries.iter().zip(words) {
            self.entry(*tag, *value_type, *count, word);
        }
        match child {
            Some(child) => self.entry(2, 12, next, child.to_be_bytes()),
            None => self.entry(1, 11, 1, next.to_be_bytes()),
        }
        at
    }

    fn entry(&mut self, tag: u16, value_type: u16, count: u32, word: [u8; 4]) {
        self.bytes.extend(tag.to_be_bytes());
        self.bytes.extend(value_type.to_be_bytes());
        self.bytes.extend(count.to_be_bytes());
        self.bytes.extend(word);
    }

    fn closing(&mut self) -> u32 {
        self.align();
        let at = self.bytes.len() as u32;
        self.entry(0, 11, 1, [0; 4]);
        at
    }
}

/// An entry of 32-bit numbers.
pub(crate) fn u32s(tag: u16, values: &[u32]) -> (u16, u16, u32, Vec<u8>) {
    let bytes = values.iter().flat_map(|value| value.to_be_bytes());
    (tag, 4, values.len() as u32, bytes.collect())
}

/// An entry of floats.
pub(crate) fn floats(tag: u16, values: &[f32]) -> (u16, u16, u32, Vec<u8>) {
    (tag, 6, values.len() as u32, be(values))
}

/// Floats as records have them.
pub(crate) fn be(values: &[f32]) -> Vec<u8> {
    values
        .iter()
        .flat_map(|value| value.to_be_bytes())
        .collect()
}

/// A file of these sets; `root` are more entries of its root.
pub(crate) fn file(root: &[(u16, u16, u32, Vec<u8>)], sets: &[Set]) -> Vec<u8> {
    let mut writer = Writer {
        bytes: b"GFLF\0\0\0\0SFLF\0\0\0\0\0\0\0\0".to_vec(),
    };
    // From the leaves to the root and from the last sibling to the first, since offsets must be known.
    let mut next_set = writer.closing();
    for set in sets.iter().rev() {
        let mut next_level = writer.closing();
        for records in set.levels.iter().rev() {
            let count = records.len() as u32 / set.record_bytes.max(1);
            let entries = [
                u32s(0x170, &[count]),
                (0x171, 10, records.len() as u32, records.clone()),
            ];
            next_level = writer.directory(&entries, next_level, None);
        }
        let (indices, offsets): (Vec<u16>, Vec<u32>) = set.layout.iter().copied().unzip();
        let indices: Vec<u8> = indices
            .iter()
            .flat_map(|index| index.to_be_bytes())
            .collect();
        let mut entries = vec![
            u32s(0x140, &[set.levels.len() as u32]),
            u32s(0x151, &[set.record_bytes]),
            u32s(0x152, &set.mask),
            (0x153, 2, set.layout.len() as u32, indices),
            u32s(0x154, &offsets),
        ];
        if set.entries.iter().all(|entry| entry.0 != 0x150) {
            entries.push(u32s(0x150, &[1]));
        }
        entries.extend(set.entries.clone());
        next_set = writer.directory(&entries, next_set, Some(next_level));
    }
    let end = writer.closing();
    let list = [u32s(0x130, &[sets.len() as u32])];
    let list = writer.directory(&list, end, Some(next_set));
    let mut entries = vec![u32s(0x120, &[0])];
    entries.extend_from_slice(root);
    let root = writer.directory(&entries, end, Some(list));
    writer.bytes[16..20].copy_from_slice(&root.to_be_bytes());
    writer.bytes
}
