//! Memory for records that are decompressed, in large pages where the system has them: a page of 4 KB costs a microsecond when it is
//! first touched, which for records is some twentieth of a load.

use std::ops::{Deref, DerefMut};

use memmap2::MmapMut;

/// Bytes of any number. What they hold after a change of it is not defined, but never what somebody else wrote.
#[derive(Debug, Default)]
pub(crate) struct LargeMemory {
    memory: Memory,
    length: usize,
}

#[derive(Debug)]
enum Memory {
    Pages(MmapMut),
    /// What the system gives where it gives no pages.
    Bytes(Vec<u8>),
}

impl Default for Memory {
    fn default() -> Self {
        Self::Bytes(Vec::new())
    }
}

impl Memory {
    fn new(length: usize) -> Self {
        let Ok(pages) = MmapMut::map_anon(length) else {
            return Self::Bytes(vec![0; length]);
        };
        #[cfg(target_os = "linux")]
        // Without large pages, which a system need not have, it takes longer and is as right.
        let _ = pages.advise(memmap2::Advice::HugePage);
        Self::Pages(pages)
    }
}

impl LargeMemory {
    /// Makes them so many, for somebody who writes all of them.
    pub(crate) fn set_length(&mut self, length: usize) {
        self.length = 0;
        if self.all().len() < length {
            // Not both at once.
            self.memory = Memory::default();
            self.memory = Memory::new(length);
        }
        self.length = length;
    }

    fn all(&self) -> &[u8] {
        match &self.memory {
            Memory::Pages(pages) => pages,
            Memory::Bytes(bytes) => bytes,
        }
    }
}

impl Deref for LargeMemory {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.all()[..self.length]
    }
}

impl DerefMut for LargeMemory {
    fn deref_mut(&mut self) -> &mut [u8] {
        let all = match &mut self.memory {
            Memory::Pages(pages) => &mut pages[..],
            Memory::Bytes(bytes) => bytes,
        };
        &mut all[..self.length]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_grows_shrinks_and_may_be_empty() {
        let mut memory = LargeMemory::default();
        assert!(memory.is_empty());
        for length in [0, 7, 5_000_000, 3, 0, 6_000_000] {
            memory.set_length(length);
            assert_eq!(memory.len(), length);
            memory.fill(length as u8);
            assert!(memory.iter().all(|byte| *byte == length as u8));
        }
    }
}
