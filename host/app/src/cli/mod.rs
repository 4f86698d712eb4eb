//! The command line: one file a command.
//!
//! [`Arguments`] is what clap reads; [`run`] hands it to the command. Results go to standard output, everything else to
//! standard error. Exit codes: 0 done, 1 failed, 2 used wrongly ([`failure`]).

mod bench;
mod compare;
mod convert;
mod drawing;
mod failure;
mod globals;
mod info;
mod load;
mod measuring;
mod named_plugins;
mod plugins;
mod render;
mod stdout;
mod sweep;
pub(crate) mod values;
mod views;

use std::io::IsTerminal as _;
use std::path::PathBuf;

use clap::{Parser, Subcommand};
use pointstage_plugin_api::nearest::{did_you_mean, nearest_names};

pub(crate) use failure::{Failure, Outcome};
pub(crate) use globals::Globals;
pub(crate) use stdout::write_out;

/// Show and render point clouds and meshes as surfels, with renderers that are plugins.
///
/// Without a command, opens FILEs in the window.
#[derive(Debug, Parser)]
#[command(name = "pointstage", version, after_help = EXAMPLES, args_conflicts_with_subcommands = false)]
pub(crate) struct Arguments {
    /// Files of points or meshes to open in the window, each as an object, or a session file
    #[arg(value_name = "FILE")]
    pub(crate) files: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) globals: Globals,
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

const EXAMPLES: &str = "\
Examples:
  pointstage scan.ply                                           look at a scan
  pointstage work.pointstage.toml                               go on with a saved session
  pointstage render scan.ply --renderer surfel --out scan.png   draw it without a window
  pointstage compare scan.ply --renderers points,hqss --reference surfel --out apart
                                                                how far renderers are from one of them
  pointstage bench scan.ply --renderers points,surfel,hqss      how fast they are
  pointstage sweep scan.ply --renderer hqss --set-range splat_scale=0.5:2:9 --reference ewa-reference --out sweep
                                                                what one setting does to quality and time
  pointstage convert scan.laz --out scan.ply                    another format
  pointstage info scan.ply                                      what is in the file
  pointstage plugins list                                       which renderers and loaders there are

Exit codes: 0 done, 1 failed, 2 used wrongly.
A file that is named like a command is opened as ./render.";

/// The commands' names.
const COMMANDS: [&str; 7] = [
    "render", "compare", "bench", "sweep", "convert", "info", "plugins",
];

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Draw files to pictures, without a window
    Render(Box<render::RenderArguments>),
    /// Draw files with several renderers, measure how far each is from a reference and how long it takes
    Compare(Box<compare::CompareArguments>),
    /// Time renderers on scenes along a path
    Bench(Box<bench::BenchArguments>),
    /// Draw with several values of one setting: quality against time
    Sweep(Box<sweep::SweepArguments>),
    /// Write files as PLY or SFL, with normals, radii and axes estimated
    Convert(Box<convert::ConvertArguments>),
    /// Say what is in files
    Info(info::InfoArguments),
    /// List or examine plugins
    #[command(subcommand)]
    Plugins(plugins::PluginsCommand),
}

/// Runs the command.
pub(crate) fn run(arguments: Arguments) -> Outcome {
    let Arguments {
        files,
        globals,
        command,
    } = arguments;
    match command {
        None => {
            check_for_misspelt_command(&files)?;
            crate::window::open(&globals, files)
        }
        Some(_) if !files.is_empty() => Err(Failure::usage(format!(
            "'{}' stands before a command; put files behind it",
            files[0].display()
        ))),
        Some(Command::Render(render)) => render::run(&globals, &render),
        Some(Command::Compare(compare)) => compare::run(&globals, &compare),
        Some(Command::Bench(bench)) => bench::run(&globals, &bench),
        Some(Command::Sweep(sweep)) => sweep::run(&globals, &sweep),
        Some(Command::Convert(convert)) => convert::run(&globals, &convert),
        Some(Command::Info(info)) => info::run(&globals, &info),
        Some(Command::Plugins(plugins)) => plugins::run(&globals, &plugins),
    }
}

/// Refuses a word that is no file but resembles a command: it would open a window that cannot read it.
fn check_for_misspelt_command(files: &[PathBuf]) -> Outcome {
    for file in files {
        let Some(word) = file.to_str() else { continue };
        if word.contains(['.', '/', '\\']) || file.exists() {
            continue;
        }
        let near = nearest_names(word, COMMANDS);
        if COMMANDS.contains(&word) {
            return Err(Failure::usage(format!(
                "the command '{word}' stands behind a file; it comes first"
            )));
        }
        if !near.is_empty() {
            return Err(Failure::usage(format!(
                "there is no file and no command '{word}'{}",
                did_you_mean(&near)
            )));
        }
    }
    Ok(())
}

/// Sends the program's log to standard error: warnings, with `-v` what happens, with `-vv` every act.
///
/// `RUST_LOG` overrides the choice.
pub(crate) fn start_log(verbose: u8) {
    use tracing_subscriber::layer::SubscriberExt as _;
    use tracing_subscriber::util::SubscriberInitExt as _;
    use tracing_subscriber::{EnvFilter, Layer as _};
    let (ours, others) = match verbose {
        0 => ("warn", "error"),
        1 => ("info", "error"),
        _ => ("debug", "warn"),
    };
    // Looking for adapters asks every interface; that one has none is no error, and if none has any we say so ourselves, as
    // we say why no window opens.
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| {
        EnvFilter::new(format!(
            "{others},pointstage={ours},pointstage_engine={ours},pointstage_scene={ours},wgpu_hal::gles=off,wgpu_hal::vulkan::instance=off,eframe=off"
        ))
    });
    let is_coloured = std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
    let said = tracing_subscriber::fmt::layer()
        .with_writer(std::io::stderr)
        .with_ansi(is_coloured)
        .with_target(false)
        .with_filter(filter);
    tracing_subscriber::registry()
        .with(said)
        .with(crate::host_log::layer())
        .init();
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory as _;

    #[test]
    fn the_definition_is_sound() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn files_alone_open_the_window() {
        let arguments =
            Arguments::try_parse_from(["pointstage", "a.ply", "b.ply", "--backend", "vulkan"])
                .expect("parses");
        assert_eq!(arguments.files.len(), 2);
        assert!(arguments.command.is_none());
    }

    #[test]
    fn a_misspelt_command_is_not_opened_as_a_file() {
        let failure = |words: &[&str]| {
            let files: Vec<PathBuf> = words.iter().map(PathBuf::from).collect();
            match check_for_misspelt_command(&files) {
                Err(Failure::Usage(error)) => error.to_string(),
                other => panic!("{words:?}: {other:?}"),
            }
        };
        assert!(failure(&["rendre"]).contains("did you mean 'render'?"));
        assert!(failure(&["a.ply", "info"]).contains("comes first"));
        for fine in ["a.ply", "./rendre", "model"] {
            check_for_misspelt_command(&[fine.into()]).expect("a file's name");
        }
    }

    #[test]
    fn the_list_of_commands_is_complete() {
        let names: Vec<String> = Arguments::command()
            .get_subcommands()
            .map(|command| command.get_name().to_owned())
            .collect();
        assert_eq!(names, COMMANDS);
    }

    #[test]
    fn global_options_stand_before_or_behind_the_command() {
        for line in [
            ["pointstage", "--no-device", "info", "a.ply"],
            ["pointstage", "info", "a.ply", "--no-device"],
        ] {
            let arguments = Arguments::try_parse_from(line).expect("parses");
            assert!(arguments.globals.no_device);
        }
    }

    #[test]
    fn every_command_has_examples_in_its_help() {
        let mut command = Arguments::command();
        command.build();
        for name in COMMANDS {
            let help = command
                .find_subcommand_mut(name)
                .expect("there is such a command")
                .render_long_help()
                .to_string();
            assert!(
                help.contains("Example"),
                "no example in the help of '{name}'"
            );
        }
    }
}
