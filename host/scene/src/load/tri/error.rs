//! What can be wrong with a TRI file.

/// A TRI file that cannot be read. Each message says where, what was expected, what was found, and what to do.
///
/// Rows count from 1 in messages, without blank lines and comments.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TriError {
    /// There is no section of vertices, or nothing in it.
    #[error(
        "line {line}: expected a section 'Vertices' with rows, found the end of the file; there is nothing to show, export the file again"
    )]
    NoVertices {
        /// Last line of the file, from 1.
        line: u64,
    },
    /// A section for the second time.
    #[error(
        "line {line}: section '{section}' begins for the second time, expected it once; put its rows together, or in files of their own"
    )]
    Twice {
        /// The second head, from 1.
        line: u64,
        /// The section.
        section: &'static str,
    },
    /// A row with too few numbers.
    #[error(
        "line {line}: row {row} of section '{section}' has {found} numbers, expected 3; correct that line or export the file again"
    )]
    ShortRow {
        /// Line, from 1.
        line: u64,
        /// The section.
        section: &'static str,
        /// Row, from 1.
        row: u64,
        /// Numbers that it has.
        found: usize,
    },
    /// A word that is no number, or none that can be used.
    #[error(
        "line {line}: row {row} of section '{section}': expected a number between -1e18 and 1e18, found '{found}'; correct that line or export the file again"
    )]
    Number {
        /// Line, from 1.
        line: u64,
        /// The section.
        section: &'static str,
        /// Row, from 1.
        row: u64,
        /// The word, shortened and escaped.
        found: String,
    },
    /// A section with another number of rows than it says.
    #[error(
        "line {line}: expected {expected} rows of section '{section}' as it says, found {found}; the file is truncated or damaged, copy or export it again"
    )]
    RowCount {
        /// Where the rows end, or go on.
        line: u64,
        /// The section.
        section: &'static str,
        /// Rows by its count.
        expected: u64,
        /// Rows that there are; one more than expected if there are more.
        found: u64,
    },
    /// A corner that is no vertex.
    #[error(
        "row {row} of section 'Triangles' (from line {line} on): expected whole numbers that are indices of {vertices} vertices, found {found}; the file is damaged, export it again"
    )]
    Corner {
        /// Head of the section, from 1.
        line: u64,
        /// Row, from 1.
        row: u64,
        /// Vertices.
        vertices: u64,
        /// The corner, as it stands there.
        found: String,
    },
}
