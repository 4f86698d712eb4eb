#![no_main]

use std::sync::LazyLock;

use pointstage_fuzz::Reader;

static READER: LazyLock<Reader> = LazyLock::new(|| Reader::built_in("sfl"));

libfuzzer_sys::fuzz_target!(|content: &[u8]| READER.read(content));
