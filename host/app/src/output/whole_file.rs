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

/// Writes `bytes` to `path`, replacing what is there.
///
/// The bytes go to a neighbour with a name of this process and take the file's place by renaming, so a reader sees the old
/// file or the new one, and an interrupted write leaves neither half a file nor a damaged one.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    write_by(path, bytes, File::sync_all)
}

/// The same for a file that is written many times a second and worth nothing after a crash: it is not forced to the disk.
pub(crate) fn replace(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    write_by(path, bytes, |_| Ok(()))
}

fn write_by(
    path: &Path,
    bytes: &[u8],
    sync: impl FnOnce(&File) -> std::io::Result<()>,
) -> Result<(), WriteError> {
    let at = |source| WriteError {
        path: path.to_path_buf(),
        source,
    };
    let name = path
        .file_name()
        .ok_or_else(|| at(std::io::ErrorKind::IsADirectory.into()))?;
    let mut temporary_name = std::ffi::OsString::from(".");
    temporary_name.push(name);
    temporary_name.push(format!(".{}.part", std::process::id()));
    let temporary = path.with_file_name(temporary_name);
    let written = File::create(&temporary)
        .and_then(|mut file| {
            file.write_all(bytes)?;
            sync(&file)
        })
        .and_then(|()| std::fs::rename(&temporary, path))
        .map_err(at);
    if written.is_err() {
        // The error that matters is the one above; a neighbour that was never made cannot be removed either.
        let _ = std::fs::remove_file(&temporary);
    }
    written
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
}
