//! What can be wrong with an SFL file.

/// An SFL file that cannot be read. Each message says where, what was expected, what was found, and what to do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SflError {
    /// The file does not start as an SFL file does.
    #[error("byte {byte}: expected '{expected}', found '{found}'; this is not an SFL file")]
    NotSfl {
        /// Offset.
        byte: u64,
        /// The four bytes that should stand there.
        expected: &'static str,
        /// What stands there, escaped.
        found: String,
    },
    /// A version that this reader does not know.
    #[error(
        "byte {byte}: expected {what} with a major number of 0, found {found:#010x}; the file is newer than this program or damaged, export it again"
    )]
    Version {
        /// Offset of the number or of its tag.
        byte: u64,
        /// Which version.
        what: &'static str,
        /// The number.
        found: u32,
    },
    /// Something that the file names lies beyond its end.
    #[error(
        "byte {byte}: {what} takes {length} bytes from byte {start} on, found a file of {found} bytes; the file is truncated or damaged, copy or export it again"
    )]
    BeyondEnd {
        /// Where it is named.
        byte: u64,
        /// What.
        what: String,
        /// Where it starts.
        start: u64,
        /// Bytes that it takes at least.
        length: u64,
        /// Length of the file.
        found: u64,
    },
    /// A directory that the file leads to twice.
    #[error(
        "byte {byte}: expected a directory that was not read before, found it for the second time; the file's directories run in a circle or overlap: it is damaged, export it again"
    )]
    Cycle {
        /// Where the directory starts.
        byte: u64,
    },
    /// Sets whose records add up to more than the file.
    #[error(
        "byte {byte}: expected records of its own for the set of this directory, found that the sets' records together are longer than the file: they overlap; the file is damaged, export it again"
    )]
    Overlap {
        /// Where the directory of the set starts.
        byte: u64,
    },
    /// A tag that is not there.
    #[error(
        "byte {byte}: expected tag {tag} in the directory of {what}, found none; the file is damaged, export it again"
    )]
    MissingTag {
        /// Where the directory starts.
        byte: u64,
        /// Name and number.
        tag: String,
        /// Whose directory.
        what: &'static str,
    },
    /// A value that cannot be.
    #[error(
        "byte {byte}: {what}: expected {expected}, found {found}; the file is damaged, export it again"
    )]
    Value {
        /// Where its tag stands.
        byte: u64,
        /// Which value.
        what: String,
        /// What would do.
        expected: String,
        /// What stands there.
        found: String,
    },
    /// A form of a property that nobody ever wrote.
    #[error(
        "byte {byte}: {what} is stored as {found}, which is not read; write the file with {advice}"
    )]
    Unsupported {
        /// Where the property mask's tag stands.
        byte: u64,
        /// The property.
        what: &'static str,
        /// The form.
        found: String,
        /// What to choose instead.
        advice: &'static str,
    },
    /// No surfel can be placed.
    #[error(
        "all {count} surfels have NaN or infinite coordinates, expected finite numbers; there is nothing to show, export the file again"
    )]
    NothingFinite {
        /// How many there were.
        count: u64,
    },
}
