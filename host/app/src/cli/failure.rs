//! How a command ends when it does not succeed.

use std::process::ExitCode;

/// Why a command stopped; the two kinds have different exit codes.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The command line asks for something that cannot be: exit code 2.
    Usage(anyhow::Error),
    /// The command was understood, but could not be done: exit code 1.
    Failed(anyhow::Error),
}

/// What a command returns.
pub(crate) type Outcome<T = ()> = Result<T, Failure>;

impl Failure {
    /// A usage failure, said in words.
    pub(crate) fn usage(message: impl std::fmt::Display) -> Self {
        Self::Usage(anyhow::anyhow!("{message}"))
    }

    /// A usage failure with its causes.
    pub(crate) fn usage_from(error: impl Into<anyhow::Error>) -> Self {
        Self::Usage(error.into())
    }

    /// Tells standard error what went wrong, and says which exit code that is.
    pub(crate) fn report(&self) -> ExitCode {
        let (error, code) = match self {
            Self::Usage(error) => (error, 2),
            Self::Failed(error) => (error, 1),
        };
        eprintln!("error: {}", in_one_line(error));
        if code == 2 {
            eprintln!("For all options, try 'pointstage --help' or 'pointstage COMMAND --help'.");
        }
        ExitCode::from(code)
    }
}

/// The error and its causes, each said once: many errors already quote their source.
fn in_one_line(error: &anyhow::Error) -> String {
    let mut text = String::new();
    for cause in error.chain().map(ToString::to_string) {
        if text.is_empty() {
            text = cause;
        } else if !text.contains(&cause) {
            text = format!("{text}: {cause}");
        }
    }
    text
}

impl<E: Into<anyhow::Error>> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::Failed(error.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cause_that_is_already_quoted_is_not_said_again() {
        let inner = anyhow::anyhow!("no such file");
        let quoted = inner.context("a.ply: cannot be read: no such file");
        assert_eq!(in_one_line(&quoted), "a.ply: cannot be read: no such file");
        let unquoted = anyhow::anyhow!("disk is full").context("x.png: cannot be written");
        assert_eq!(
            in_one_line(&unquoted),
            "x.png: cannot be written: disk is full"
        );
    }
}
