//! The manifest of a library's file, read from its link section without running any code of the plugin.

use object::{Object as _, ObjectSection as _};
use pointstage_plugin_api::abi::{MANIFEST_SECTION, MANIFEST_SECTION_MACHO};
use pointstage_plugin_api::manifest::{Manifest, ManifestError};

/// The bytes of the manifest's section; none if the file has no such section or is no object file.
pub fn manifest_bytes(data: &[u8]) -> Option<&[u8]> {
    let file = object::File::parse(data).ok()?;
    // On macOS the name has a segment in front: '__DATA,__ptstage'.
    let macho = MANIFEST_SECTION_MACHO.rsplit(',').next()?;
    let section = file
        .section_by_name(MANIFEST_SECTION)
        .or_else(|| file.section_by_name(macho))?;
    section.data().ok()
}

/// The manifest in the object file `data`; none if it has no manifest section.
pub fn read_manifest(data: &[u8]) -> Option<Result<Manifest, ManifestError>> {
    manifest_bytes(data).map(Manifest::parse)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_without_the_section_has_no_manifest() {
        assert_eq!(read_manifest(b"#!/bin/sh\n"), None);
    }
}
