//! Where plugins are looked for.

use super::found_in::FoundIn;
use super::probe::{ChildProgram, Examination};
use etcetera::BaseStrategy as _;
use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Environment variable with more folders and files, separated as in `PATH`.
pub const PLUGIN_PATH_VARIABLE: &str = "POINTSTAGE_PLUGIN_PATH";

/// Where to look for plugins, and how to examine them. The default looks nowhere and keeps nothing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DiscoverOptions {
    /// Files named by the user; whatever is wrong with them is told.
    pub files: Vec<PathBuf>,
    /// Folders, not searched deeper. The first has precedence where a name fits several plugins.
    pub folders: Vec<PathBuf>,
    /// How new and changed files are examined.
    pub examination: Examination,
    /// Folder for verdicts and the crash journal; none keeps nothing.
    pub state_folder: Option<PathBuf>,
}

impl DiscoverOptions {
    /// The usual folders, examination by this program as the child, and the user's state folder.
    pub fn standard() -> Self {
        let program = std::env::current_exe();
        Self {
            files: Vec::new(),
            folders: standard_folders(),
            examination: program.map_or(Examination::ManifestOnly, |program| {
                Examination::Child(ChildProgram::new(program))
            }),
            state_folder: Some(standard_state_folder()),
        }
    }
}

/// The entries of [`PLUGIN_PATH_VARIABLE`], the user's folder, the program's folder and `plugins` beneath it.
pub fn standard_folders() -> Vec<PathBuf> {
    let mut folders = variable_folders();
    folders.extend(user_folder());
    if let Some(folder) = program_folder() {
        folders.push(folder.clone());
        folders.push(folder.join("plugins"));
    }
    folders.retain(|folder| !folder.as_os_str().is_empty());
    folders
}

/// The entries of [`PLUGIN_PATH_VARIABLE`].
pub(super) fn variable_folders() -> Vec<PathBuf> {
    std::env::var_os(PLUGIN_PATH_VARIABLE)
        .map(|paths| std::env::split_paths(&paths).collect())
        .unwrap_or_default()
}

/// The user's own folder for plugins.
pub(super) fn user_folder() -> Option<PathBuf> {
    let base = etcetera::choose_base_strategy().ok()?;
    Some(base.data_dir().join("pointstage").join("plugins"))
}

/// The folder of this program.
pub(super) fn program_folder() -> Option<PathBuf> {
    let program = std::env::current_exe().ok()?;
    program.parent().map(Path::to_owned)
}

/// The user's folder for what Pointstage keeps between sessions.
pub fn standard_state_folder() -> PathBuf {
    let base = etcetera::choose_base_strategy().ok();
    let folder = base.map(|base| base.state_dir().unwrap_or_else(|| base.data_dir()));
    folder.unwrap_or_else(std::env::temp_dir).join("pointstage")
}

/// A file that may be a plugin.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Candidate {
    pub(super) path: PathBuf,
    /// Whether the user named it: then it is told whatever is wrong with it.
    pub(super) found_in: FoundIn,
}

/// All candidates: named files first, then each folder's libraries by name. Each path once.
pub(super) fn candidates(options: &DiscoverOptions) -> Vec<Candidate> {
    let mut seen = BTreeSet::new();
    let mut found = Vec::new();
    let mut add = |path: &Path, found_in: FoundIn| {
        // The same file under two names is one candidate; one that does not exist keeps its name.
        let path = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        if seen.insert(path.clone()) {
            found.push(Candidate { path, found_in });
        }
    };
    for file in &options.files {
        add(file, FoundIn::Named);
    }
    for folder in &options.folders {
        if folder.is_file() {
            add(folder, FoundIn::Named);
            continue;
        }
        let found_in = FoundIn::folder(folder);
        for path in libraries_in(folder) {
            add(&path, found_in.clone());
        }
    }
    found
}

/// Files in `folder` that are named like this system's libraries, by name. A folder that is not there has none.
fn libraries_in(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut paths: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| {
            path.extension() == Some(OsStr::new(std::env::consts::DLL_EXTENSION)) && path.is_file()
        })
        .collect();
    paths.sort();
    paths
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_libraries_are_candidates_by_name_and_once() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let library = |name: &str| {
            let path = folder
                .path()
                .join(name)
                .with_extension(std::env::consts::DLL_EXTENSION);
            std::fs::write(&path, b"x").expect("writable");
            std::fs::canonicalize(path).expect("just written")
        };
        let (b, a) = (library("b"), library("a"));
        std::fs::write(folder.path().join("notes.txt"), b"x").expect("writable");
        std::fs::create_dir(folder.path().join("deep")).expect("writable");
        let options = DiscoverOptions {
            files: vec![b.clone(), "/no/such/file.so".into()],
            folders: vec![folder.path().to_owned(), "/no/such/folder".into()],
            ..DiscoverOptions::default()
        };
        let found: Vec<_> = candidates(&options)
            .into_iter()
            .map(|c| (c.path, c.found_in))
            .collect();
        assert_eq!(
            found,
            [
                (b, FoundIn::Named),
                ("/no/such/file.so".into(), FoundIn::Named),
                (a, FoundIn::Folder(folder.path().to_owned()))
            ]
        );
    }
}
