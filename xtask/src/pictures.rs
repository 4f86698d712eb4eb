//! `cargo xtask pictures`: the user guide's pictures anew.

use crate::draw_anew::draw_anew;
use crate::{Outcome, no_arguments, process};

/// Walks through the user guide in the real window on a virtual display, and writes what it shows.
pub(crate) fn pictures(arguments: &[String]) -> Outcome {
    no_arguments(arguments)?;
    let what = "walking through the user guide";
    draw_anew(what, "window", "guide::", "POINTSTAGE_PICTURES")?;
    let what = "opening a report in a browser";
    draw_anew(what, "cli", "page::", "POINTSTAGE_PICTURES")?;
    process::say("done; look at what changed under docs/pictures/ before you commit it");
    Ok(())
}
