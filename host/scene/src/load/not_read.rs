//! Formats that are known and that nobody reads: a sentence with their name helps more than their first bytes.

use super::loader::FileStart;

/// The name of the file's format and what to do instead, if it is one that nobody reads.
///
/// Asked only about files that no loader claims, so a plugin that reads one of these comes first.
pub(super) fn not_read(start: &FileStart<'_>) -> Option<(&'static str, &'static str)> {
    let FileStart { bytes, .. } = start;
    let extension = start.extension();
    let text = bytes.trim_ascii_start();
    if text.starts_with(b"ISO-10303-21") {
        return Some((
            "a STEP file (surfaces of a CAD model)",
            "export a mesh from the CAD program, or have a plugin that reads STEP",
        ));
    }
    let is_gzip = bytes.starts_with(b"\x1f\x8b");
    if bytes.starts_with(b"NGSP") || (is_gzip && extension == "spz") {
        return Some((
            "an SPZ file (packed Gaussian splats)",
            "convert it to an uncompressed PLY",
        ));
    }
    match extension.as_str() {
        "splat" | "ksplat" => Some((
            "a SPLAT file (packed Gaussian splats)",
            "convert it to an uncompressed PLY",
        )),
        "sog" => Some((
            "a SOG file (packed Gaussian splats)",
            "convert it to an uncompressed PLY",
        )),
        _ if is_gzip || bytes.starts_with(b"PK\x03\x04") => {
            Some(("a compressed archive", "unpack it first"))
        }
        _ => None,
    }
}
