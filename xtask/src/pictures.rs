//! `cargo xtask pictures`: the user guide's pictures anew.

use crate::{Outcome, no_arguments, process, setup};

/// Walks through the user guide in the real window on a virtual display, and writes what it shows.
pub(crate) fn pictures(arguments: &[String]) -> Outcome {
    no_arguments(arguments)?;
    setup::set_up(setup::Needs {
        window: true,
        tests: true,
    })?;
    process::say("building");
    process::run(
        "the build",
        &mut process::cargo(&["build", "--workspace", "--lib", "--bins"]),
    )?;
    process::say("walking through the user guide");
    let mut command = process::cargo(&["test", "--workspace", "--test", "window", "guide::"]);
    command.env("POINTSTAGE_PICTURES", "1");
    setup::prepare_environment(&mut command)?;
    setup::hold_to_software_driver(&mut command);
    process::run("walking through the user guide", &mut command)?;
    process::say("done; look at what changed under docs/pictures/ before you commit it");
    Ok(())
}
