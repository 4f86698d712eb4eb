#![no_main]

use std::sync::LazyLock;

use pointstage_fuzz::{MESH_FORMATS, Reader};

static READER: LazyLock<Reader> =
    LazyLock::new(|| Reader::linked::<pointstage_mesh_formats::StlLoader>(MESH_FORMATS, "stl"));

libfuzzer_sys::fuzz_target!(|content: &[u8]| READER.read(content));
