//! What can be wrong with a PLY file.

pub(super) use pointstage_plugin_api::lines::excerpt;

pub(super) use crate::load::error::Place;

/// A PLY file that cannot be read. Each message says where, what was expected, what was found, and what to do.
///
/// Rows count from 1 in messages.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PlyError {
    /// The first line is not `ply`.
    #[error("line 1: expected 'ply', found '{found}'; this is not a PLY file")]
    NotPly {
        /// What stands there, shortened and escaped.
        found: String,
    },
    /// A header line that says nothing that PLY knows.
    #[error(
        "line {line}: expected {expected}, found '{found}'; the header is damaged or of another dialect, export the file again"
    )]
    HeaderLine {
        /// Line, from 1.
        line: u64,
        /// What would do.
        expected: &'static str,
        /// What stands there, shortened and escaped.
        found: String,
    },
    /// The header never ends.
    #[error(
        "line {line}: expected 'end_header', found the end of the file after {bytes} bytes; the file is truncated, copy it again"
    )]
    NoEndHeader {
        /// Last line, from 1.
        line: u64,
        /// Length of the file, bytes.
        bytes: u64,
    },
    /// The file is too short for the rows that the header promises.
    #[error(
        "{place}: element '{element}' has {rows} rows by the header, which take at least {expected} bytes, found {found} bytes; the file is truncated or its header lies, copy or export it again"
    )]
    TooShort {
        /// Where the element starts.
        place: Place,
        /// The element.
        element: String,
        /// Rows promised.
        rows: u64,
        /// Least bytes that these rows take.
        expected: u64,
        /// Bytes left in the file.
        found: u64,
    },
    /// The file ends inside a row.
    #[error(
        "{place}: row {row} of {rows} of element '{element}' ends inside property '{property}' (the file is {missing} bytes short at least); the file is truncated, copy it again"
    )]
    Truncated {
        /// Where the file ends.
        place: Place,
        /// The element.
        element: String,
        /// Row, from 1.
        row: u64,
        /// Rows promised.
        rows: u64,
        /// Property in which the file ends.
        property: String,
        /// Bytes that this element lacks at least.
        missing: u64,
    },
    /// A text file has fewer lines than rows.
    #[error(
        "{place}: expected row {row} of {rows} of element '{element}', found the end of the file; the file is truncated, copy it again"
    )]
    MissingRows {
        /// Last line of the file.
        place: Place,
        /// The element.
        element: String,
        /// First row that is missing, from 1.
        row: u64,
        /// Rows promised.
        rows: u64,
    },
    /// A list with a length that cannot be.
    #[error(
        "{place}: row {row} of element '{element}': list '{property}' has length {found}, expected 0 or more, and no more than the file holds; the file is damaged, export it again"
    )]
    ListLength {
        /// Where the length stands.
        place: Place,
        /// The element.
        element: String,
        /// Row, from 1.
        row: u64,
        /// The list.
        property: String,
        /// The length.
        found: i64,
    },
    /// A word that is no number.
    #[error(
        "{place}: row {row} of element '{element}': expected a number for '{property}', found '{found}'; correct that line or export the file again"
    )]
    Number {
        /// The line.
        place: Place,
        /// The element.
        element: String,
        /// Row, from 1.
        row: u64,
        /// The property.
        property: String,
        /// The word, shortened and escaped.
        found: String,
    },
    /// A line that ends before its row does.
    #[error(
        "{place}: row {row} of element '{element}' ends before '{property}'; expected one line a row with all properties, correct that line or export the file again"
    )]
    ShortLine {
        /// The line.
        place: Place,
        /// The element.
        element: String,
        /// Row, from 1.
        row: u64,
        /// First property without a word.
        property: String,
    },
    /// No element holds positions.
    #[error(
        "header: expected an element 'vertex' with properties x and y, found {found}; there is nothing to show, export the file with its vertices"
    )]
    NoPositions {
        /// The elements of the file, or `no elements`.
        found: String,
    },
    /// A Gaussian splat file in the compressed form.
    #[error(
        "header: expected properties x and y, found 'packed_position': this is a compressed Gaussian splat file, which is not read; convert it to an uncompressed PLY"
    )]
    CompressedSplat,
    /// The vertex element has no rows.
    #[error(
        "header: element '{element}' has 0 rows, expected 1 or more; there is nothing to show, export the file with its vertices"
    )]
    NoVertices {
        /// The element.
        element: String,
    },
    /// Elements that hold one vertex's properties together differ in length.
    #[error(
        "header: element '{element}' has {found} rows, expected {expected} as '{first}' has; the file is damaged, export it again"
    )]
    SplitRows {
        /// The first of the elements.
        first: String,
        /// Its rows.
        expected: u64,
        /// The one that differs.
        element: String,
        /// Its rows.
        found: u64,
    },
    /// No vertex can be placed.
    #[error(
        "all {count} vertices have NaN or infinite coordinates, expected finite numbers; there is nothing to show, export the file again"
    )]
    NothingFinite {
        /// How many there were.
        count: u64,
    },
    /// More vertices than an index can name.
    #[error(
        "header: element '{element}' has {rows} rows, expected at most 4294967280; split the file"
    )]
    TooManyVertices {
        /// The element.
        element: String,
        /// Rows promised.
        rows: u64,
    },
}
