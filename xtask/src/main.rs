//! The repository's own commands: `cargo xtask run`, `test`, `bless`, `pictures`, `sample`, `bench`,
//! `quality`, `pop`, `side-by-side`, `fuzz`.
//!
//! Each command is a file of its own. They share [`setup`] (what the machine must have), [`build`] (the program and
//! its plugins), [`process`] (running children and saying so) and [`paths`]. Nothing here depends on a crate but `pointstage-plot`, which depends on none, so that
//! `cargo xtask run` on a fresh clone speaks after a second and not after the whole dependency tree.

use std::process::ExitCode;

mod bench;
mod bless;
mod build;
mod draw_anew;
mod fuzz;
mod json;
mod markdown;
mod out;
mod paths;
mod pictures;
mod ply;
mod pop;
mod process;
mod quality;
mod run;
mod sample;
mod setup;
mod side_by_side;
mod test;
mod test_log;

/// What a step returns: nothing, or one message for the person at the terminal.
type Outcome<T = ()> = Result<T, String>;

const USAGE: &str = "\
Usage: cargo xtask COMMAND

  run [FILE...] [-- ARGUMENTS]   set the machine up, build everything in release, and open the sample (or FILE) in the
                                 window; without a display, draw it with every renderer into target/pictures/.
                                 ARGUMENTS go to the program as they are.
  test [--long]                  the same set-up, then every check; --long adds the slow sweeps
  bless                          draw the golden images anew; look at the difference before you commit it
  pictures                       make the user guide's pictures anew, in the real window on a virtual display
  sample [--surfels N] [--out FILE]
                                 make the procedural sample anew
  bench [NAME...] [-- ARGUMENTS] run the benchmarks (all, or those of these names); ARGUMENTS go to them
  quality [OUT]                  compare the renderers with exact pictures on many scenes; a table and all pictures go to OUT,
                                 target/quality unless given
  pop [OUT] [--with PROGRAM]     measure the renderer pop as a diploma thesis on POP measured its own, and set both side by
                                 side; tables and plots go to OUT, target/pop unless given. PROGRAM is the benchmark 'pop',
                                 built before; without it, all is built first
  side-by-side [OUT]             reports of all renderers on a small and a large scan, and the tables of a thesis on HQSS
                                 measured again; they go to OUT, target/side-by-side unless given
  fuzz [READER...] [--seconds N] wrong files for every reader (or these: ply, las, …), a minute each unless told otherwise
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some((command, rest)) = arguments.split_first() else {
        eprint!("{USAGE}");
        return ExitCode::from(2);
    };
    let outcome = match command.as_str() {
        "run" => run::run(rest),
        "test" => test::test(rest),
        "bless" => bless::bless(rest),
        "pictures" => pictures::pictures(rest),
        "sample" => sample::sample(rest),
        "bench" => bench::bench(rest),
        "quality" => quality::quality(rest),
        "pop" => pop::pop(rest),
        "fuzz" => fuzz::fuzz(rest),
        "side-by-side" => side_by_side::side_by_side(rest),
        "help" | "--help" | "-h" => {
            print!("{USAGE}");
            return ExitCode::SUCCESS;
        }
        other => {
            eprint!("xtask: there is no command '{other}'\n\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("xtask {command}: {message}");
            ExitCode::FAILURE
        }
    }
}

/// Refuses arguments to a command that has none.
fn no_arguments(arguments: &[String]) -> Outcome {
    match arguments.first() {
        None => Ok(()),
        Some(first) => Err(format!(
            "'{first}' was not expected here; see `cargo xtask help`"
        )),
    }
}
