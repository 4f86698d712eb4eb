//! How values stand in the program's TOML files, and how a flaw in such a file is told.
//!
//! The settings file and session files share these types. Every field is checked while it is read, so that an error names
//! the line and column of the value ([`Flaw`]); what is absent takes its default.

mod checked;
mod flaw;
mod look;
mod mark_runs;
mod views;

pub(crate) use checked::{lights, material, positive, transform, view};
pub(crate) use flaw::Flaw;
pub(crate) use look::{DEFAULT_BACKGROUND, Look, show_from_key, show_key};
pub(crate) use mark_runs::MarkRuns;
pub(crate) use views::{NumberOrigin, StoredView};

use std::path::Path;

/// The largest file that is read, bytes: a thousand times what a full one has.
const MOST_BYTES: u64 = 16 << 20;

/// Reads a file that is known to be small.
///
/// # Errors
/// The file cannot be read, or is larger than any that this program writes.
pub(crate) fn read_small(path: &Path) -> std::io::Result<Vec<u8>> {
    use std::io::Read as _;
    let mut bytes = Vec::new();
    std::fs::File::open(path)?
        .take(MOST_BYTES + 1)
        .read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err(std::io::Error::other(format!(
            "the file is larger than {} MiB",
            MOST_BYTES >> 20
        )));
    }
    Ok(bytes)
}
