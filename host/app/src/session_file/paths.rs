//! Paths of scene files, relative to the session file where that helps.

use std::path::{Component, Path, PathBuf};

/// The folder of a session file, absolute and free of links and dots where it exists.
pub(crate) fn folder_of(path: &Path) -> PathBuf {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    resolved_folder(folder)
}

/// `file`, as a session in `folder` names it, absolute.
pub(crate) fn absolute(file: &Path, folder: &Path) -> PathBuf {
    without_dots(&folder.join(file))
}

/// `file` as seen from `folder`, with `/` between names, if both have a folder in common; else the absolute path.
///
/// Links in the path of `file`'s folder are followed, so that `..` means the same to everybody; its own name stays, also
/// where it is a link.
pub(crate) fn relative(file: &Path, folder: &Path) -> PathBuf {
    let file = match (file.parent(), file.file_name()) {
        (Some(parent), Some(name)) => resolved_folder(parent).join(name),
        _ => file.to_path_buf(),
    };
    let folder = without_dots(folder);
    let from: Vec<Component<'_>> = folder.components().collect();
    let to: Vec<Component<'_>> = file.components().collect();
    let common = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    let shares_a_name = from[..common]
        .iter()
        .any(|component| matches!(component, Component::Normal(_)));
    // Two files that share the root alone are not moved together.
    if !shares_a_name {
        return file;
    }
    let mut names = vec![".."; from.len() - common];
    for component in &to[common..] {
        let Some(name) = component.as_os_str().to_str() else {
            return file;
        };
        names.push(name);
    }
    PathBuf::from(names.join("/"))
}

fn resolved_folder(folder: &Path) -> PathBuf {
    std::fs::canonicalize(folder)
        .or_else(|_| std::path::absolute(folder))
        .map_or_else(|_| folder.to_path_buf(), |folder| without_dots(&folder))
}

/// The path with `.` left out and each `..` taking its folder along.
fn without_dots(path: &Path) -> PathBuf {
    let mut clean = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            // At the root there is nothing to take along.
            Component::ParentDir => {
                clean.pop();
            }
            other => clean.push(other),
        }
    }
    clean
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_beside_below_and_above_are_relative() {
        for (file, expected) in [
            ("/no/sessions/a.ply", "a.ply"),
            ("/no/sessions/deep/er/a.ply", "deep/er/a.ply"),
            ("/no/scans/a.ply", "../scans/a.ply"),
            ("/elsewhere/a.ply", "/elsewhere/a.ply"),
        ] {
            let found = relative(Path::new(file), Path::new("/no/sessions"));
            assert_eq!(found, Path::new(expected), "{file}");
            assert_eq!(absolute(&found, Path::new("/no/sessions")), Path::new(file));
        }
    }

    #[test]
    #[cfg(unix)]
    fn a_link_to_the_folder_does_not_break_the_way_up() {
        let home = tempfile::tempdir().expect("a temporary folder");
        let home = std::fs::canonicalize(home.path()).expect("it is there");
        for folder in ["deep/sessions", "deep/scans"] {
            std::fs::create_dir_all(home.join(folder)).expect("made");
        }
        std::os::unix::fs::symlink(home.join("deep/sessions"), home.join("link")).expect("linked");
        let folder = folder_of(&home.join("link/a.pointstage.toml"));
        let file = home.join("deep/scans/a.ply");
        let found = relative(&file, &folder);
        assert_eq!(found, Path::new("../scans/a.ply"));
        assert_eq!(absolute(&found, &folder), file);
    }
}
