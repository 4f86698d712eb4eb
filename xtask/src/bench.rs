//! `cargo xtask bench`: the benchmarks.

use crate::{Outcome, build, process, setup};

/// Runs the benchmarks of these names, all of them when there is none; what follows `--` goes to them.
pub(crate) fn bench(arguments: &[String]) -> Outcome {
    let mut parts = arguments.splitn(2, |argument| argument == "--");
    let names = parts.next().unwrap_or_default();
    let passed_on = parts.next().unwrap_or_default();
    setup::set_up(setup::Needs::NONE)?;
    build::release()?;
    process::say("running the benchmarks");
    let mut command = process::cargo(&["bench", "--workspace"]);
    setup::prepare_environment(&mut command)?;
    if names.is_empty() {
        command.arg("--benches");
    }
    for name in names {
        command.args(["--bench", name]);
    }
    command.arg("--").args(passed_on);
    process::run("the benchmarks", &mut command)
}
