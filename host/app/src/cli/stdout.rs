//! Standard output of commands.

use std::io::{ErrorKind, Write as _};

use super::Outcome;

/// Writes a command's result and ends its last line. A reader that has seen enough (`… | head`) is no error.
pub(crate) fn write_out(text: &str) -> Outcome {
    let mut out = std::io::stdout().lock();
    let written = writeln!(out, "{}", text.trim_end()).and_then(|()| out.flush());
    match written {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}
