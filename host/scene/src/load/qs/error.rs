//! What can be wrong with a QSplat file.

/// A QSplat file that cannot be read. Each message says where, what was expected, what was found, and what to do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum QsError {
    /// A fragment does not start as one does.
    #[error(
        "byte {byte}: expected 'QSplat11', found '{found}'; this is no QSplat file of version 11, or it is damaged: write it again"
    )]
    NotQSplat {
        /// Where the fragment starts.
        byte: u64,
        /// What stands there, shortened and escaped.
        found: String,
    },
    /// Something reaches beyond the end of its fragment, or of the file.
    #[error(
        "byte {byte}: {what} takes {length} bytes, found {found} to the end of {whole}; the file is truncated or damaged, copy it again"
    )]
    BeyondEnd {
        /// Where it starts.
        byte: u64,
        /// What.
        what: &'static str,
        /// Bytes that it takes at least.
        length: u64,
        /// Bytes that there are.
        found: u64,
        /// The file or the fragment.
        whole: &'static str,
    },
    /// A value that cannot be.
    #[error(
        "byte {byte}: {what}: expected {expected}, found {found}; the file is damaged, write it again"
    )]
    Value {
        /// Where it stands.
        byte: u64,
        /// Which value.
        what: &'static str,
        /// What would do.
        expected: String,
        /// What stands there.
        found: String,
    },
    /// No model has a leaf.
    #[error(
        "the file's models have no points, expected one or more; there is nothing to show, write it again"
    )]
    Nothing,
}
