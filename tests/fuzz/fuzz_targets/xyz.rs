#![no_main]

use std::sync::LazyLock;

use pointstage_fuzz::{POINT_FORMATS, Reader};

static READER: LazyLock<Reader> =
    LazyLock::new(|| Reader::linked::<pointstage_point_formats::XyzLoader>(POINT_FORMATS, "xyz"));

libfuzzer_sys::fuzz_target!(|content: &[u8]| READER.read(content));
