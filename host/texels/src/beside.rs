//! Pictures beside the file that names them.

use std::path::{Component, Path, PathBuf};

/// Bytes of the largest picture file that is read.
const MOST_BYTES: u64 = 1 << 29;

/// Why a picture's file cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BesideError {
    /// There is no name.
    #[error("the file does not name it")]
    NoName,
    /// The system says no.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// It is a folder, or something else without an end.
    #[error("it is no regular file")]
    NotAFile,
    /// It is larger than any picture here.
    #[error("it has {0} bytes, expected at most {MOST_BYTES}")]
    TooLarge(u64),
}

/// Bytes of the picture `name`, as `file` names it.
///
/// Backslashes part folders too, and `<this>` stands for the file's own name without its extension, as MeshLab writes it. Of a
/// path that is absolute, or leads out of the file's folder, only the last part counts; that is tried as well where the path
/// leads nowhere.
///
/// # Errors
/// There is no such file, or it cannot be read.
pub fn read_beside(file: &Path, name: &str) -> Result<Vec<u8>, BesideError> {
    let path = place(file, name).ok_or(BesideError::NoName)?;
    match read(&path) {
        Err(BesideError::Io(error)) if error.kind() == std::io::ErrorKind::NotFound => {
            let alone = path.file_name().map(|name| file.with_file_name(name));
            match alone.filter(|alone| *alone != path) {
                Some(alone) => read(&alone),
                None => Err(error.into()),
            }
        }
        other => other,
    }
}

fn read(path: &Path) -> Result<Vec<u8>, BesideError> {
    let metadata = std::fs::metadata(path)?;
    if !metadata.is_file() {
        return Err(BesideError::NotAFile);
    }
    if metadata.len() > MOST_BYTES {
        return Err(BesideError::TooLarge(metadata.len()));
    }
    Ok(std::fs::read(path)?)
}

/// Where the picture is looked for.
fn place(file: &Path, name: &str) -> Option<PathBuf> {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let name = name.trim().trim_matches('"').replace('\\', "/");
    let name = name.replace("<this>", &stem);
    let has_drive = name.as_bytes().get(1) == Some(&b':');
    let path = Path::new(&name);
    let stays = path
        .components()
        .all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if stays && !has_drive {
        // What is empty, or '.', names no file.
        path.file_name()?;
        return Some(file.parent().unwrap_or(Path::new("")).join(path));
    }
    let last = name.rsplit(['/', ':']).next().unwrap_or_default();
    let last = Path::new(last).file_name()?;
    Some(file.with_file_name(last))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_no_further_than_the_folder_of_the_file() {
        let file = Path::new("/models/chair/chair.v2.obj");
        for (name, expected) in [
            ("wood.png", Some("/models/chair/wood.png")),
            (" \"my wood.png\" ", Some("/models/chair/my wood.png")),
            ("maps\\wood.png", Some("/models/chair/maps/wood.png")),
            ("./wood.png", Some("/models/chair/./wood.png")),
            ("<this>_A.png", Some("/models/chair/chair.v2_A.png")),
            ("../../etc/passwd", Some("/models/chair/passwd")),
            ("/etc/passwd", Some("/models/chair/passwd")),
            ("C:\\art\\wood.png", Some("/models/chair/wood.png")),
            ("a/../../b.png", Some("/models/chair/b.png")),
            ("", None),
            (".", None),
            ("..", None),
            ("/", None),
        ] {
            let found = place(file, name);
            assert_eq!(found.as_deref(), expected.map(Path::new), "{name:?}");
        }
    }

    #[test]
    fn a_file_that_is_not_where_it_should_be_is_looked_for_beside() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.obj");
        std::fs::write(folder.path().join("wood.png"), b"wood").unwrap();
        assert_eq!(read_beside(&file, "maps/wood.png").unwrap(), b"wood");
        assert_eq!(read_beside(&file, "wood.png").unwrap(), b"wood");
        let error = read_beside(&file, "maps/none.png").unwrap_err();
        assert!(matches!(error, BesideError::Io(_)), "{error}");
        std::fs::create_dir(folder.path().join("maps")).unwrap();
        let error = read_beside(&file, "maps").unwrap_err();
        assert!(matches!(error, BesideError::NotAFile), "{error}");
    }
}
