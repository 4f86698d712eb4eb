//! `cargo xtask bless`: the golden images anew.

use crate::draw_anew::draw_anew;
use crate::{Outcome, no_arguments, process};

/// Runs the golden tests so that they write their images instead of comparing.
pub(crate) fn bless(arguments: &[String]) -> Outcome {
    no_arguments(arguments)?;
    draw_anew(
        "drawing the golden images",
        "golden",
        "",
        "POINTSTAGE_BLESS",
    )?;
    process::say("done; look at what changed under tests/golden/ before you commit it");
    Ok(())
}
