//! Writes the settings after changes, off the window's thread.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::file::write;
use super::{Opened, Preferences};

/// Changes are written this long after the first of them: a slider that is dragged gives one file, not a hundred.
const DELAY: Duration = Duration::from_secs(2);

/// Watches the settings and writes them. What is unwritten when it is dropped is written then.
#[derive(Debug)]
pub(crate) struct Keeper {
    /// As they are now.
    now: Preferences,
    /// As the file has them, or will.
    filed: Preferences,
    /// When the first unwritten change came.
    changed: Option<Instant>,
    writer: Option<Writer>,
}

#[derive(Debug)]
struct Writer {
    work: Option<Sender<Preferences>>,
    failures: Receiver<String>,
    thread: Option<JoinHandle<()>>,
}

impl Keeper {
    /// Keeps what was opened. Without a file (`None`) it remembers as long as it lives.
    ///
    /// # Errors
    /// The system gives no thread.
    pub(crate) fn new(opened: Option<Opened>) -> std::io::Result<Self> {
        let writer = match &opened {
            Some(opened) if opened.may_write => Some(Writer::start(opened.path.clone())?),
            _ => None,
        };
        let now = opened.map(|opened| opened.preferences).unwrap_or_default();
        Ok(Self {
            filed: now.clone(),
            now,
            changed: None,
            writer,
        })
    }

    /// The settings as they are now.
    pub(crate) fn preferences(&self) -> &Preferences {
        &self.now
    }

    /// Takes over the settings as they are at `now`, and has them written when it is time. Returns how long until then.
    pub(crate) fn keep(&mut self, preferences: Preferences, now: Instant) -> Option<Duration> {
        self.now = preferences;
        if self.now == self.filed {
            self.changed = None;
            return None;
        }
        let waited = now.duration_since(*self.changed.get_or_insert(now));
        if let Some(left) = DELAY.checked_sub(waited).filter(|left| !left.is_zero()) {
            return Some(left);
        }
        self.file();
        None
    }

    /// Why writing failed since the last call.
    pub(crate) fn take_failures(&self) -> Vec<String> {
        let failures = self
            .writer
            .iter()
            .flat_map(|writer| writer.failures.try_iter());
        failures.collect()
    }

    fn file(&mut self) {
        self.changed = None;
        self.filed = self.now.clone();
        if let Some(work) = self.writer.as_ref().and_then(|writer| writer.work.as_ref()) {
            // The writer ends only with the keeper.
            let _ = work.send(self.now.clone());
        }
    }
}

impl Drop for Keeper {
    fn drop(&mut self) {
        if self.now != self.filed {
            self.file();
        }
        // Dropping the writer waits until all is on the disk.
        self.writer = None;
    }
}

impl Writer {
    fn start(path: PathBuf) -> std::io::Result<Self> {
        let (work, orders) = channel::<Preferences>();
        let (failed, failures) = channel();
        let thread = std::thread::Builder::new()
            .name("pointstage-settings".to_owned())
            .spawn(move || {
                while let Ok(mut preferences) = orders.recv() {
                    // Only the newest counts.
                    while let Ok(newer) = orders.try_recv() {
                        preferences = newer;
                    }
                    if let Err(reason) = write(&path, &preferences) {
                        tracing::error!("{reason}");
                        // Nobody listens while the window closes; the log above has it.
                        let _ = failed.send(reason);
                    }
                }
            })?;
        Ok(Self {
            work: Some(work),
            failures,
            thread: Some(thread),
        })
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        self.work = None;
        if let Some(thread) = self.thread.take() {
            // A panic of the writer was reported by the panic hook.
            let _ = thread.join();
        }
    }
}
