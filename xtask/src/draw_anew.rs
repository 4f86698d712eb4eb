//! What `bless` and `pictures` have in common: a test that writes its images instead of comparing them.

use crate::{Outcome, process, setup};

/// Builds everything and runs the test target `test` (its tests whose names contain `filter`) with `variable` set to 1, on the
/// software driver whose images are kept.
pub(crate) fn draw_anew(what: &str, test: &str, filter: &str, variable: &str) -> Outcome {
    setup::set_up(setup::Needs {
        window: test == "window",
        tests: true,
    })?;
    process::say("building");
    process::run(
        "the build",
        &mut process::cargo(&["build", "--workspace", "--lib", "--bins"]),
    )?;
    process::say(what);
    let mut command = process::cargo(&["test", "--workspace", "--test", test, filter]);
    command.env(variable, "1");
    setup::prepare_environment(&mut command)?;
    setup::hold_to_software_driver(&mut command);
    process::run(what, &mut command)
}
