//! The one error of the plugin interface.

use crate::abi::{ErrorCode, ErrorRecord};
use abi_stable::std_types::RResult;
use std::fmt;

/// What went wrong, with a code for the host and words for people.
///
/// Anything with a message converts: `Err("the scene has no mesh".into())`, or `?` on a standard error by
/// [`Error::failed`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error {
    /// What kind of failure.
    pub code: ErrorCode,
    /// One or two sentences: where, expected, found, what to do.
    pub message: String,
    /// The long form; may be empty.
    pub detail: String,
}

/// Result of everything that can fail here.
pub type Result<T, E = Error> = std::result::Result<T, E>;

impl Error {
    /// An error with a code.
    pub fn new(code: ErrorCode, message: impl Into<String>) -> Self {
        Self {
            code,
            message: message.into(),
            detail: String::new(),
        }
    }

    /// The plugin's own failure, [`ErrorCode::FAILED`].
    pub fn failed(message: impl fmt::Display) -> Self {
        Self::new(ErrorCode::FAILED, message.to_string())
    }

    /// The call was cancelled.
    pub fn cancelled() -> Self {
        Self::new(ErrorCode::CANCELLED, "cancelled")
    }

    /// Adds the long form.
    #[must_use]
    pub fn with_detail(mut self, detail: impl Into<String>) -> Self {
        self.detail = detail.into();
        self
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Error {}

impl From<&str> for Error {
    fn from(message: &str) -> Self {
        Self::failed(message)
    }
}

impl From<String> for Error {
    fn from(message: String) -> Self {
        Self::failed(message)
    }
}

impl From<ErrorRecord> for Error {
    fn from(record: ErrorRecord) -> Self {
        Self {
            code: record.code,
            message: record.message.into(),
            detail: record.detail.into(),
        }
    }
}

impl From<Error> for ErrorRecord {
    fn from(error: Error) -> Self {
        Self {
            code: error.code,
            message: error.message.into(),
            detail: error.detail.into(),
        }
    }
}

/// A border result as a Rust one.
pub(crate) fn from_border<T>(result: RResult<T, ErrorRecord>) -> Result<T> {
    result.into_result().map_err(Error::from)
}
