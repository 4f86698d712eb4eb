//! Pointstage: a stage on which point-based renderers perform. This binary is the window and the command line.
//!
//! [`cli`] reads the command line and runs one command; [`window`] is the command that runs when none is named;
//! [`output`] writes what commands make. What outlives the program stands in [`preferences`] and in a [`session_file`], both
//! TOML ([`toml_form`]); [`host_log`] keeps the last log lines for bug reports.

mod camera_path;
mod cli;
mod file_loaders;
mod host_log;
mod output;
mod preferences;
mod session_file;
mod toml_form;
mod window;

use std::process::ExitCode;

use clap::Parser as _;

fn main() -> ExitCode {
    // First contact with a plugin happens in a child process, which is this program under a hidden name.
    if let Some(code) = pointstage_engine::plugins::probe::child_main(std::env::args_os()) {
        return code;
    }
    let arguments = cli::Arguments::parse();
    cli::start_log(arguments.globals.verbose);
    match cli::run(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
