//! `cargo xtask bench`: the benchmarks.

use crate::{Outcome, build, process, setup};

/// Runs the benchmarks whose names contain one of `names`; all of them when there is none.
pub(crate) fn bench(names: &[String]) -> Outcome {
    setup::set_up(setup::Needs {
        window: false,
        tests: false,
    })?;
    build::release()?;
    process::say("running the benchmarks");
    let mut command = process::cargo(&["bench", "--workspace", "--benches"]);
    setup::prepare_environment(&mut command)?;
    if !names.is_empty() {
        command.arg("--").args(names);
    }
    process::run("the benchmarks", &mut command)
}
