//! Writes a file whole or not at all.

use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// A file that could not be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot be written: {source}; check that the folder exists, may be written to, and has space", path.display())]
pub(crate) struct WriteError {
    path: PathBuf,
    source: std::io::Error,
}

impl WriteError {
    /// What the system said about `path`.
    pub(crate) fn new(path: &Path, source: std::io::Error) -> Self {
        Self {
            path: path.to_path_buf(),
            source,
        }
    }
}

/// Writes `bytes` to `path`, replacing what is there.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let mut part = PartFile::create(path)?;
    part.file
        .write_all(bytes)
        .map_err(|source| WriteError::new(path, source))?;
    part.commit()
}

/// The same for a file that is written many times a second and worth nothing after a crash: it is not forced to the disk.
pub(crate) fn replace(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let mut part = PartFile::create(path)?;
    part.file
        .write_all(bytes)
        .map_err(|source| WriteError::new(path, source))?;
    part.take_place()
}

/// A file in the making, under a neighbouring name of this process. It takes the file's place by renaming, so a reader sees
/// the old file or the new one. Dropped before that it goes away: an interrupted write leaves neither half a file nor a
/// damaged one.
#[derive(Debug)]
pub(crate) struct PartFile {
    path: PathBuf,
    temporary: PathBuf,
    /// To be written to.
    pub(crate) file: File,
    is_in_place: bool,
}

impl PartFile {
    /// Begins the file `path`.
    pub(crate) fn create(path: &Path) -> Result<Self, WriteError> {
        let at = |source| WriteError::new(path, source);
        let name = path
            .file_name()
            .ok_or_else(|| at(std::io::ErrorKind::IsADirectory.into()))?;
        let mut temporary_name = std::ffi::OsString::from(".");
        temporary_name.push(name);
        temporary_name.push(format!(".{}.part", std::process::id()));
        let temporary = path.with_file_name(temporary_name);
        Ok(Self {
            path: path.to_path_buf(),
            file: File::create(&temporary).map_err(at)?,
            temporary,
            is_in_place: false,
        })
    }

    /// Ends the file: what was written is forced to the disk and takes its place.
    pub(crate) fn commit(self) -> Result<(), WriteError> {
        self.file
            .sync_all()
            .map_err(|source| WriteError::new(&self.path, source))?;
        self.take_place()
    }

    fn take_place(mut self) -> Result<(), WriteError> {
        std::fs::rename(&self.temporary, &self.path)
            .map_err(|source| WriteError::new(&self.path, source))?;
        self.is_in_place = true;
        Ok(())
    }
}

impl Drop for PartFile {
    fn drop(&mut self) {
        if !self.is_in_place {
            // The error that matters has been returned; this one would only tell that the file is gone already.
            let _ = std::fs::remove_file(&self.temporary);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replaces_a_file_and_leaves_no_neighbour() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.txt");
        write(&path, b"old").expect("written");
        write(&path, b"new").expect("written again");
        assert_eq!(std::fs::read(&path).expect("readable"), b"new");
        let count = std::fs::read_dir(folder.path()).expect("listable").count();
        assert_eq!(count, 1, "a temporary file was left behind");
    }

    #[test]
    fn a_failed_write_names_the_file_and_leaves_nothing() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("missing").join("a.txt");
        let error = write(&path, b"x").expect_err("the folder is missing");
        assert!(error.to_string().contains("a.txt"), "{error}");
        // A folder stands where the file should go: the rename fails.
        let taken = folder.path().join("taken");
        std::fs::create_dir(&taken).expect("made");
        write(&taken, b"x").expect_err("a folder cannot be replaced");
        let count = std::fs::read_dir(folder.path()).expect("listable").count();
        assert_eq!(count, 1, "a temporary file was left behind");
    }

    #[test]
    fn a_file_that_is_given_up_leaves_the_old_one() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.txt");
        write(&path, b"old").expect("written");
        let mut part = PartFile::create(&path).expect("begun");
        part.file.write_all(b"ne").expect("written");
        drop(part);
        assert_eq!(std::fs::read(&path).expect("readable"), b"old");
        let count = std::fs::read_dir(folder.path()).expect("listable").count();
        assert_eq!(count, 1, "a temporary file was left behind");
    }
}
