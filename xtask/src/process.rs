//! Running children, and saying what is being done.

use std::io::{BufRead as _, BufReader, Write as _};
use std::process::{Command, Stdio};

use crate::{Outcome, paths};

/// Announces a step on standard error, so that a command's own output stays clean.
pub(crate) fn say(what: &str) {
    eprintln!("==> {what}");
}

/// Cargo itself, to be run in the repository's root.
pub(crate) fn cargo(arguments: &[&str]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(arguments).current_dir(paths::root());
    command
}

/// Git, to be run in the repository's root.
pub(crate) fn git(arguments: &[&str]) -> Command {
    let mut command = Command::new("git");
    command.args(arguments).current_dir(paths::root());
    command
}

/// Runs `command` to its end with this terminal's input and output; `what` names it in the error.
pub(crate) fn run(what: &str, command: &mut Command) -> Outcome {
    let status = command
        .status()
        .map_err(|error| cannot_start(what, command, &error))?;
    if status.success() {
        Ok(())
    } else {
        Err(format!("{what} failed ({status}): {}", line(command)))
    }
}

/// Runs `command`, hands each line that it writes (both streams, in order) to `each`, and says whether it succeeded.
/// The lines also go to this terminal.
pub(crate) fn follow(
    what: &str,
    command: &mut Command,
    mut each: impl FnMut(&str),
) -> Outcome<bool> {
    let (reader, writer) = std::io::pipe().map_err(|error| format!("{what}: no pipe: {error}"))?;
    let second = writer
        .try_clone()
        .map_err(|error| format!("{what}: no pipe: {error}"))?;
    let mut child = command
        .stdin(Stdio::null())
        .stdout(second)
        .stderr(writer)
        .spawn()
        .map_err(|error| cannot_start(what, command, &error))?;
    // The command keeps the writing ends; they must go, or the reader below would wait for ever.
    command.stdout(Stdio::null()).stderr(Stdio::null());
    let mut out = std::io::stdout().lock();
    let mut reader = BufReader::new(reader);
    let mut bytes = Vec::new();
    while reader
        .read_until(b'\n', &mut bytes)
        .map_err(|error| format!("{what}: {error}"))?
        > 0
    {
        let text = String::from_utf8_lossy(&bytes);
        each(text.trim_end());
        // A closed terminal is no reason to stop counting.
        let _ = out.write_all(&bytes);
        bytes.clear();
    }
    let status = child.wait().map_err(|error| format!("{what}: {error}"))?;
    Ok(status.success())
}

/// Standard output of `command` when it succeeds; `None` when it fails or does not exist.
pub(crate) fn output(command: &mut Command) -> Option<String> {
    let output = command
        .stdin(Stdio::null())
        .stderr(Stdio::null())
        .output()
        .ok()?;
    output
        .status
        .success()
        .then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}

/// The command as one would type it.
pub(crate) fn line(command: &Command) -> String {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    words
        .map(|word| word.to_string_lossy())
        .collect::<Vec<_>>()
        .join(" ")
}

fn cannot_start(what: &str, command: &Command, error: &std::io::Error) -> String {
    format!(
        "{what}: cannot start {}: {error}",
        command.get_program().to_string_lossy()
    )
}
