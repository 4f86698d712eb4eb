//! What can go wrong while a file is loaded.

use std::error::Error;
use std::fmt;
use std::path::PathBuf;

use super::assemble::AssembleError;
use super::loader::LoaderInfo;
use super::loaders::UnknownLoader;
use crate::job::Cancelled;

/// A file that cannot be loaded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// The file cannot be read.
    #[error("{}: cannot be read: {source}; check the path and its permissions", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// No loader knows the file.
    #[error(
        "{}: starts with {found}, which no loader knows; this program reads {readable}: convert the file, or name a loader that fits", path.display()
    )]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// Its first bytes, escaped.
        found: String,
        /// The formats that can be read, with their extensions.
        readable: String,
    },
    /// The format is known, but nothing here reads it.
    #[error("{}: this is {format}, which is not read; {advice}", path.display())]
    NotRead {
        /// The file.
        path: PathBuf,
        /// The format's name, with its article.
        format: &'static str,
        /// What to do instead.
        advice: &'static str,
    },
    /// There is no loader of the name asked for.
    #[error("{}: {source}", path.display())]
    NoLoader {
        /// The file.
        path: PathBuf,
        /// What was asked for, and what there is.
        source: UnknownLoader,
    },
    /// The file says something that cannot be, or holds what its loader cannot read.
    #[error("{}, {source}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// Id of the loader that says so.
        loader: String,
        /// What, and where in the file.
        source: Box<dyn Error + Send + Sync>,
    },
    /// The owner cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Why a loader stopped.
#[derive(Debug)]
#[non_exhaustive]
pub enum LoadStop {
    /// The file cannot be read as this format; the message says where, what was expected, what was found, what to do.
    Format(Box<dyn Error + Send + Sync>),
    /// The owner cancelled.
    Cancelled,
}

/// An error of a format, with its place in the file; for loaders that need no type of their own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FormatError {
    /// Where, if it is at one place.
    pub place: Option<Place>,
    /// What was expected, what was found, what to do.
    pub message: String,
}

impl FormatError {
    /// An error of the file as a whole.
    pub fn new(message: impl Into<String>) -> Self {
        Self {
            place: None,
            message: message.into(),
        }
    }

    /// An error at one place.
    pub fn at(place: Place, message: impl Into<String>) -> Self {
        Self {
            place: Some(place),
            message: message.into(),
        }
    }
}

impl fmt::Display for FormatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.place {
            Some(place) => write!(f, "{place}: {}", self.message),
            None => f.write_str(&self.message),
        }
    }
}

impl Error for FormatError {}

impl<E: Error + Send + Sync + 'static> From<E> for LoadStop {
    fn from(error: E) -> Self {
        let error: Box<dyn Error + Send + Sync> = Box::new(error);
        if error.is::<Cancelled>()
            || matches!(error.downcast_ref(), Some(AssembleError::Cancelled(_)))
        {
            return Self::Cancelled;
        }
        Self::Format(error)
    }
}

impl LoadStop {
    /// The same as an error of the whole.
    pub(super) fn of_file(self, path: PathBuf, loader: &LoaderInfo) -> LoadError {
        match self {
            Self::Format(source) => LoadError::Format {
                path,
                loader: loader.id.clone(),
                source,
            },
            Self::Cancelled => LoadError::Cancelled(Cancelled),
        }
    }
}

/// A place in a file: a byte of a binary body, or a line of text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Offset from the start of the file.
    Byte(u64),
    /// Line of the file, from 1.
    Line(u64),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Byte(byte) => write!(f, "byte {byte}"),
            Self::Line(line) => write!(f, "line {line}"),
        }
    }
}
