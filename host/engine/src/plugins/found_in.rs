//! Where a plugin's file was found, in words.

use super::discover::{program_folder, user_folder, variable_folders};
use std::path::{Path, PathBuf};

/// Where a plugin's file was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FoundIn {
    /// The user named the file itself.
    Named,
    /// In a folder of the environment variable for plugins.
    Variable(PathBuf),
    /// In the user's own folder for plugins.
    UserFolder(PathBuf),
    /// In the program's folder, or `plugins` beneath it.
    BesideProgram(PathBuf),
    /// In another folder, which the user added.
    Folder(PathBuf),
}

impl FoundIn {
    /// What kind of folder this is.
    pub fn folder(folder: &Path) -> Self {
        let path = folder.to_owned();
        let same = |other: &PathBuf| *other == path;
        if user_folder().as_ref().is_some_and(same) {
            return Self::UserFolder(path);
        }
        if variable_folders().iter().any(same) {
            return Self::Variable(path);
        }
        let is_beside = program_folder()
            .is_some_and(|program| same(&program) || same(&program.join("plugins")));
        if is_beside {
            return Self::BesideProgram(path);
        }
        Self::Folder(path)
    }

    /// The folder; none if the file was named.
    pub fn path(&self) -> Option<&Path> {
        match self {
            Self::Named => None,
            Self::Variable(path)
            | Self::UserFolder(path)
            | Self::BesideProgram(path)
            | Self::Folder(path) => Some(path),
        }
    }

    /// A few words for lists; the folder is told beside them.
    pub fn in_words(&self) -> &'static str {
        match self {
            Self::Named => "named by you",
            Self::Variable(_) => "folder in POINTSTAGE_PLUGIN_PATH",
            Self::UserFolder(_) => "your plugin folder",
            Self::BesideProgram(_) => "beside the program",
            Self::Folder(_) => "folder added by you",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_programs_own_folder_is_told_from_one_that_was_added() {
        let program = program_folder().expect("tests are programs");
        let beside = program.join("plugins");
        assert_eq!(
            FoundIn::folder(&beside),
            FoundIn::BesideProgram(beside.clone())
        );
        let other = FoundIn::folder(Path::new("/elsewhere"));
        assert_eq!(other.in_words(), "folder added by you");
        assert_eq!(other.path(), Some(Path::new("/elsewhere")));
    }
}
