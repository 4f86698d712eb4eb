//! The folder that a command writes its findings into.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::{Outcome, paths, process, setup};

/// A folder that is there.
pub(crate) struct OutFolder {
    path: PathBuf,
}

impl OutFolder {
    /// The folder at `path`, made if need be. It is kept as an absolute path: children are run inside it.
    pub(crate) fn make(path: &Path) -> Outcome<Self> {
        let error = |error| format!("{}: {error}", paths::shown(path));
        let path = std::path::absolute(path).map_err(error)?;
        std::fs::create_dir_all(&path).map_err(error)?;
        Ok(Self { path })
    }

    /// The only argument of a command, where it is to write; the folder of this name in the target folder if there is none.
    pub(crate) fn path_of(arguments: &[String], name: &str) -> Outcome<PathBuf> {
        match arguments {
            [] => Ok(paths::target().join(name)),
            [path] => Ok(PathBuf::from(path)),
            [_, second, ..] => Err(format!(
                "'{second}' was not expected here; see `cargo xtask help`"
            )),
        }
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// A folder inside it, made if need be.
    pub(crate) fn folder(&self, name: &str) -> Outcome<Self> {
        Self::make(&self.path.join(name))
    }

    /// A command of the program, to be run in the folder.
    pub(crate) fn command(&self, program: &Path, name: &str) -> Outcome<Command> {
        let mut command = Command::new(program);
        command.arg(name).current_dir(&self.path);
        setup::prepare_environment(&mut command)?;
        Ok(command)
    }

    /// Writes the file of this name; returns its path.
    pub(crate) fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> Outcome<PathBuf> {
        let path = self.path.join(name);
        std::fs::write(&path, bytes)
            .map_err(|error| format!("{}: {error}", paths::shown(&path)))?;
        Ok(path)
    }
}

/// The commit that is checked out, for what is written; `-dirty` if files differ from it.
pub(crate) fn commit() -> String {
    let commit = process::output(&mut process::git(&["describe", "--always", "--dirty"]));
    commit.map_or_else(
        || "an unknown commit".to_owned(),
        |commit| commit.trim().to_owned(),
    )
}
