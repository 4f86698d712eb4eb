//! How far an act is, on standard error.

use std::io::{IsTerminal as _, Write as _};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use pointstage_scene::Job;

/// Time between two looks. What is done sooner says nothing.
const PAUSE: Duration = Duration::from_millis(250);

/// Runs `act` and says meanwhile how far it is: in one line of a terminal, or a line a stage elsewhere.
pub(super) fn with_progress<T>(name: &str, act: impl FnOnce(&Job) -> T) -> T {
    let job = Job::new();
    std::thread::scope(|scope| {
        let (done, ends) = channel::<()>();
        let seen = job.clone();
        scope.spawn(move || {
            let mut line = Line::new(name);
            while ends.recv_timeout(PAUSE) == Err(RecvTimeoutError::Timeout) {
                line.say(&seen.stage(), seen.progress());
            }
            line.clear();
        });
        let answer = act(&job);
        drop(done);
        answer
    })
}

/// The line that says it.
struct Line<'a> {
    name: &'a str,
    is_terminal: bool,
    stage: String,
    is_shown: bool,
}

impl<'a> Line<'a> {
    fn new(name: &'a str) -> Self {
        Self {
            name,
            is_terminal: std::io::stderr().is_terminal(),
            stage: String::new(),
            is_shown: false,
        }
    }

    fn say(&mut self, stage: &str, progress: f32) {
        let mut out = std::io::stderr().lock();
        // That nobody can be told how far it is does not stop the act.
        if self.is_terminal {
            let percent = (progress * 100.0).round();
            let _ = write!(out, "\r\x1b[K{}: {stage} {percent} %", self.name);
            let _ = out.flush();
            self.is_shown = true;
        } else if stage != self.stage {
            let _ = writeln!(out, "{}: {stage}", self.name);
        }
        stage.clone_into(&mut self.stage);
    }

    fn clear(&self) {
        if self.is_shown {
            let _ = write!(std::io::stderr().lock(), "\r\x1b[K");
        }
    }
}
