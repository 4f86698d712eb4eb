//! `cargo xtask bless`: the golden images anew.

use crate::{Outcome, no_arguments, process, setup};

/// Runs the golden tests so that they write their images instead of comparing.
pub(crate) fn bless(arguments: &[String]) -> Outcome {
    no_arguments(arguments)?;
    setup::set_up(setup::Needs {
        window: false,
        tests: true,
    })?;
    process::say("building");
    process::run(
        "the build",
        &mut process::cargo(&["build", "--workspace", "--lib", "--bins"]),
    )?;
    process::say("drawing the golden images");
    let mut command = process::cargo(&["test", "--workspace", "--test", "golden"]);
    command.env("POINTSTAGE_BLESS", "1");
    setup::prepare_environment(&mut command)?;
    setup::hold_to_software_driver(&mut command);
    process::run("drawing the golden images", &mut command)?;
    process::say("done; look at what changed under tests/golden/ before you commit it");
    Ok(())
}
