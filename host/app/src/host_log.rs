//! The last lines of the program's own log, kept for bug reports whatever standard error is told.

use std::collections::VecDeque;
use std::io::Write;
use std::sync::{Mutex, PoisonError};

use tracing::Subscriber;
use tracing_subscriber::fmt::MakeWriter;
use tracing_subscriber::registry::LookupSpan;
use tracing_subscriber::{EnvFilter, Layer};

/// The most lines kept: a session's last minutes.
const MOST: usize = 200;

static LINES: Lines = Lines(Mutex::new(VecDeque::new()));

struct Lines(Mutex<VecDeque<String>>);

impl Lines {
    fn add(&self, text: &str) {
        let mut lines = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        for line in text.lines().filter(|line| !line.is_empty()) {
            if lines.len() == MOST {
                lines.pop_front();
            }
            lines.push_back(line.to_owned());
        }
    }

    fn all(&self) -> Vec<String> {
        let lines = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        lines.iter().cloned().collect()
    }
}

/// The part of the subscriber that keeps lines: what our crates say happens, and what others warn of.
pub(crate) fn layer<S: Subscriber + for<'a> LookupSpan<'a>>() -> impl Layer<S> {
    tracing_subscriber::fmt::layer()
        .with_writer(Keep)
        .with_ansi(false)
        .with_target(false)
        .with_filter(EnvFilter::new(
            "warn,pointstage=info,pointstage_engine=info,pointstage_scene=info",
        ))
}

/// The last lines, oldest first.
pub(crate) fn lines() -> Vec<String> {
    LINES.all()
}

/// Writes to the lines kept. An event comes as one write.
struct Keep;

impl Write for Keep {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        LINES.add(&String::from_utf8_lossy(bytes));
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl<'a> MakeWriter<'a> for Keep {
    type Writer = Self;

    fn make_writer(&'a self) -> Self {
        Self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_lines_are_kept_and_no_more() {
        let lines = Lines(Mutex::new(VecDeque::new()));
        for number in 0..2 * MOST {
            lines.add(&format!("line {number}\n"));
        }
        let all = lines.all();
        assert_eq!(all.len(), MOST);
        assert_eq!(all[0], format!("line {MOST}"));
    }
}
