//! The bytes of a file, mapped into memory.

use std::fs::File;
use std::io;
use std::ops::{Deref, Range};
use std::path::Path;

/// A mapped file, private to one load.
#[derive(Debug)]
pub(crate) struct Source {
    /// `None` stands for an empty file, which cannot be mapped.
    map: Option<memmap2::Mmap>,
}

impl Source {
    /// Maps a regular file.
    pub(crate) fn open(path: &Path) -> io::Result<Self> {
        let file = File::open(path)?;
        let metadata = file.metadata()?;
        if !metadata.is_file() {
            // A pipe has no size to check counts against, and may never end.
            let kind = if metadata.is_dir() {
                "it is a folder"
            } else {
                "it is not a regular file"
            };
            return Err(io::Error::other(kind));
        }
        if metadata.len() == 0 {
            return Ok(Self { map: None });
        }
        #[allow(
            unsafe_code,
            reason = "a memory map has no safe form; it saves a copy of the file"
        )]
        // SAFETY: the map is private to this load, never handed out, and read as plain bytes, of which any value is valid.
        // The readers take each size from the slice's length, which the map fixed. Should another program change the file
        // meanwhile, its bytes may change under us, which the readers survive because they check what they index with
        // where they use it; should it shorten the file, the system ends us with SIGBUS, as with every program that maps
        // files.
        let map = unsafe { memmap2::Mmap::map(&file) }?;
        Ok(Self { map: Some(map) })
    }

    /// Tells the system that these bytes have been read, so that they no longer count as our memory. They can be read
    /// again, from the file.
    pub(crate) fn release(&self, range: Range<usize>) {
        #[cfg(unix)]
        if let Some(map) = &self.map
            && range.start < range.end
            && range.end <= map.len()
        {
            #[allow(
                unsafe_code,
                reason = "the map's crate cannot know that this advice is harmless here"
            )]
            // SAFETY: the pages are a read-only map of a file and nobody can have written to them, so the system drops
            // nothing but its own copies; whoever reads them next, in this thread or another, gets the file's bytes as
            // before. The range is within the map.
            let advised = unsafe {
                map.unchecked_advise_range(
                    memmap2::UncheckedAdvice::DontNeed,
                    range.start,
                    range.len(),
                )
            };
            // Without the advice the load takes more memory and is as right.
            advised.unwrap_or_default();
        }
        #[cfg(not(unix))]
        let _ = range;
    }
}

impl Deref for Source {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        self.map.as_deref().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn released_bytes_can_be_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bytes");
        let bytes: Vec<u8> = (0..100_000_u32).map(|index| (index % 251) as u8).collect();
        std::fs::write(&path, &bytes).unwrap();
        let source = Source::open(&path).unwrap();
        assert_eq!(&*source, bytes);
        for range in [0..100_000, 5000..99_999, 7..7, 90_000..200_000] {
            source.release(range);
        }
        assert_eq!(&*source, bytes);
    }

    #[test]
    fn an_empty_file_has_no_bytes() {
        let file = tempfile::NamedTempFile::new().unwrap();
        assert!(Source::open(file.path()).unwrap().is_empty());
    }
}
