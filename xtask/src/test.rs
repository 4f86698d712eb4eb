//! `cargo xtask test`: the gate.

use std::process::Command;
use std::time::Instant;

use crate::test_log::TestLog;
use crate::{Outcome, paths, process, setup};

/// Sets the machine up and runs every check; stops at the first that fails and names it.
pub(crate) fn test(arguments: &[String]) -> Outcome {
    let long = match arguments {
        [] => false,
        [only] if only == "--long" => true,
        [first, ..] => {
            return Err(format!(
                "'{first}' was not expected here; see `cargo xtask help`"
            ));
        }
    };
    let started = Instant::now();
    setup::set_up(setup::Needs {
        window: false,
        tests: true,
    })?;

    step("formatting", process::cargo(&["fmt", "--all", "--check"]))?;
    step(
        "lints",
        process::cargo(&[
            "clippy",
            "--workspace",
            "--all-targets",
            "--quiet",
            "--",
            "-D",
            "warnings",
        ]),
    )?;
    // Named target by target: this is what `cargo test` uses, and the plugins' libraries, which it would not build.
    step(
        "build",
        process::cargo(&[
            "build",
            "--workspace",
            "--lib",
            "--bins",
            "--tests",
            "--examples",
        ]),
    )?;
    run_tests(long)?;
    let mut doc = process::cargo(&["doc", "--workspace", "--no-deps"]);
    doc.env("RUSTDOCFLAGS", "-D warnings");
    step("documentation", doc)?;

    process::say(&format!(
        "every check passed in {} s",
        started.elapsed().as_secs()
    ));
    Ok(())
}

fn step(name: &str, mut command: Command) -> Outcome {
    process::say(name);
    let started = Instant::now();
    process::run(&format!("the step '{name}'"), &mut command)?;
    process::say(&format!(
        "{name}: passed in {} s",
        started.elapsed().as_secs()
    ));
    Ok(())
}

/// All tests, doctests included; the whole log is kept in `target/test-output/tests.log`.
fn run_tests(long: bool) -> Outcome {
    process::say(if long {
        "tests, with the slow sweeps"
    } else {
        "tests"
    });
    let folder = paths::target().join("test-output");
    let mut log = TestLog::create(&folder)?;
    // `--nocapture` because a skip is a line that a passing test prints.
    let mut command =
        process::cargo(&["test", "--workspace", "--no-fail-fast", "--", "--nocapture"]);
    setup::prepare_environment(&mut command)?;
    setup::hold_to_software_driver(&mut command);
    if long {
        command.env("POINTSTAGE_LONG", "1");
    }
    let succeeded = process::follow("the step 'tests'", &mut command, |line| log.take(line))?;
    process::say(&log.summary());
    if succeeded {
        Ok(())
    } else {
        Err(format!(
            "the step 'tests' failed; the log is {}",
            log.path().display()
        ))
    }
}
