//! Why a session file cannot be read or written.

use std::path::{Path, PathBuf};

use super::FORMAT;
use crate::output::whole_file::WriteError;
use crate::toml_form::Flaw;

/// A session that cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub(crate) enum SessionFileError {
    /// The file cannot be read at all.
    #[error("{}: the session cannot be read: {source}; check the path and its permissions", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The file says something that cannot be.
    #[error("{}, {flaw}; correct that place, or save the session anew from the window", path.display())]
    Flaw {
        /// The file.
        path: PathBuf,
        /// What and where.
        flaw: Flaw,
    },
    /// The file was written by another version of the program.
    #[error("{}: the session has format {found}, this program reads format {FORMAT}; open it with a program that knows format {found}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// Its number.
        found: u32,
    },
    /// The picture has no session in it.
    #[error("{}: the picture holds no session ({lacks}); expected a picture that Pointstage wrote, or a session file (NAME.pointstage.toml)", path.display())]
    NoSession {
        /// The picture.
        path: PathBuf,
        /// What was looked for.
        lacks: String,
    },
    /// Files that the session names are not there.
    #[error("{}", missing_text(session, files))]
    Missing {
        /// The session file.
        session: PathBuf,
        /// What it names.
        files: Vec<PathBuf>,
    },
    /// A path that text cannot hold.
    #[error("{}: the session cannot name this file, since its path is not Unicode; rename the file or its folder", path.display())]
    NotUnicode {
        /// The scene file.
        path: PathBuf,
    },
    /// A value without a form in TOML.
    #[error("the session cannot be written as TOML: {0}; please report this")]
    Encode(#[source] toml::ser::Error),
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// All missing files in one sentence.
fn missing_text(session: &Path, files: &[PathBuf]) -> String {
    let names: Vec<String> = files
        .iter()
        .map(|file| file.display().to_string())
        .collect();
    let (is, they) = if files.len() == 1 {
        ("scene file is not there", "it")
    } else {
        ("scene files are not there", "them")
    };
    format!(
        "{}: {} {is}: {}; put {they} there, or correct 'file' in the session",
        session.display(),
        files.len(),
        names.join(", ")
    )
}
