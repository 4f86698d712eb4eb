//! Stands in for the program as the child that examines plugins: tests of the engine need no window toolkit.

use std::process::ExitCode;

fn main() -> ExitCode {
    pointstage_engine::plugins::probe::child_main(std::env::args_os()).unwrap_or(ExitCode::from(2))
}
