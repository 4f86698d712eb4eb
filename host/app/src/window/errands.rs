//! Short work with files off the window's thread, that waits for no other and needs no progress.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;

/// What came of an errand.
#[derive(Debug)]
pub(crate) enum Done {
    /// A session was written, or why not.
    Saved(PathBuf, Result<(), String>),
    /// Which of the recent files are not there.
    Missing(Vec<PathBuf>),
}

/// Errands under way. Dropping it waits for them: what the user saved is saved.
pub(crate) struct Errands {
    answer: Sender<Done>,
    answers: Receiver<Done>,
    threads: Vec<JoinHandle<()>>,
    wake: Arc<dyn Fn() + Send + Sync>,
}

impl Errands {
    /// None yet. `wake` is called from the thread of each that ends.
    pub(crate) fn new(wake: Arc<dyn Fn() + Send + Sync>) -> Self {
        let (answer, answers) = channel();
        Self {
            answer,
            answers,
            threads: Vec::new(),
            wake,
        }
    }

    /// Sends somebody off to do `work`.
    fn run(&mut self, work: impl FnOnce() -> Done + Send + 'static) {
        self.threads.retain(|thread| !thread.is_finished());
        let (answer, wake) = (self.answer.clone(), self.wake.clone());
        let spawned = std::thread::Builder::new()
            .name("pointstage-errand".to_owned())
            .spawn(move || {
                // Nobody listens once the window has closed.
                let _ = answer.send(work());
                wake();
            });
        match spawned {
            Ok(thread) => self.threads.push(thread),
            Err(error) => tracing::error!("no thread for work with files: {error}"),
        }
    }

    /// Writes a session by `write`.
    pub(crate) fn save(
        &mut self,
        path: PathBuf,
        write: impl FnOnce(&Path) -> Result<(), String> + Send + 'static,
    ) {
        self.run(move || {
            let result = write(&path);
            Done::Saved(path, result)
        });
    }

    /// Looks which of `paths` are not there.
    pub(crate) fn look_for(&mut self, mut paths: Vec<PathBuf>) {
        self.run(move || {
            paths.retain(|path| !path.exists());
            Done::Missing(paths)
        });
    }

    /// What was done since the last call.
    pub(crate) fn take(&self) -> Vec<Done> {
        self.answers.try_iter().collect()
    }
}

impl Drop for Errands {
    fn drop(&mut self) {
        for thread in self.threads.drain(..) {
            // A panic was reported by the panic hook.
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_saved_is_there_when_the_window_closes() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.toml");
        let mut errands = Errands::new(Arc::new(|| ()));
        errands.save(path.clone(), |path| {
            std::thread::yield_now();
            std::fs::write(path, "x").map_err(|error| error.to_string())
        });
        errands.look_for(vec![folder.path().to_path_buf(), "/no/such.ply".into()]);
        drop(errands);
        assert!(path.is_file());
    }
}
