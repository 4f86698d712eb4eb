//! A loader that takes every file to be long.
#![forbid(unsafe_code)]

use pointstage_plugin_api::loading::{Claim, FileStart, Loader, Output, SourceFile};
use pointstage_plugin_api::prelude::*;

pointstage_plugin_api::export! { "plugin.json", loaders: [Panicky] }

struct Panicky;

impl Loader for Panicky {
    fn claims(start: &FileStart<'_>) -> Claim {
        if start.bytes[100] == 7 { Claim::Certain } else { Claim::No }
    }

    fn load(_: &Host, _: &SourceFile<'_>, _: Settings<'_>, _: &mut Output<'_>, _: &Progress<'_>) -> Result<()> {
        Ok(())
    }
}
