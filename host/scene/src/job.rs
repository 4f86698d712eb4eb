//! A running act, seen from two threads: the worker reports, the owner looks and may cancel.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Progress (0..1), stage text and cancel flag of one act; clones are the same job.
#[derive(Clone, Debug, Default)]
pub struct Job {
    state: Arc<State>,
}

#[derive(Debug, Default)]
struct State {
    /// Bits of an f32: one store, no lock, from any thread.
    progress: AtomicU32,
    cancelled: AtomicBool,
    stage: Mutex<Cow<'static, str>>,
    /// Looks at the cancel flag until it sets itself; 0 for never.
    #[cfg(test)]
    checks_left: std::sync::atomic::AtomicU64,
}

/// The act was cancelled by its owner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

impl Job {
    /// A job at 0, not cancelled.
    pub fn new() -> Self {
        Self::default()
    }

    /// A job that is cancelled when a worker looks for the `check`-th time, from 0.
    #[cfg(test)]
    pub(crate) fn cancelled_at_check(check: u64) -> Self {
        let job = Self::new();
        job.state.checks_left.store(check + 1, Ordering::Relaxed);
        job
    }

    /// Progress, 0..1.
    pub fn progress(&self) -> f32 {
        f32::from_bits(self.state.progress.load(Ordering::Relaxed))
    }

    /// Reports progress, 0..1; values outside are clamped, NaN is ignored.
    pub fn set_progress(&self, progress: f32) {
        if !progress.is_nan() {
            self.state
                .progress
                .store(progress.clamp(0.0, 1.0).to_bits(), Ordering::Relaxed);
        }
    }

    /// Reports progress inside a part of the job: `done` of `total` through `part`.
    pub fn set_progress_within(&self, part: &Range<f32>, done: usize, total: usize) {
        let fraction = if total == 0 {
            1.0
        } else {
            done as f32 / total as f32
        };
        self.set_progress(part.start + (part.end - part.start) * fraction);
    }

    /// What is being done, for people.
    pub fn stage(&self) -> String {
        self.state
            .stage
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .to_string()
    }

    /// Says what is being done.
    pub fn set_stage(&self, stage: impl Into<Cow<'static, str>>) {
        *self
            .state
            .stage
            .lock()
            .unwrap_or_else(PoisonError::into_inner) = stage.into();
    }

    /// Asks the worker to stop; it does so at its next [`check`](Self::check).
    pub fn cancel(&self) {
        self.state.cancelled.store(true, Ordering::Relaxed);
    }

    /// True after [`cancel`](Self::cancel).
    pub fn is_cancelled(&self) -> bool {
        self.state.cancelled.load(Ordering::Relaxed)
    }

    /// Workers call this between pieces of work.
    ///
    /// # Errors
    /// [`Cancelled`] once the owner has cancelled.
    pub fn check(&self) -> Result<(), Cancelled> {
        #[cfg(test)]
        if self
            .state
            .checks_left
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| {
                left.checked_sub(1)
            })
            == Ok(1)
        {
            self.cancel();
        }
        if self.is_cancelled() {
            Err(Cancelled)
        } else {
            Ok(())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clones_share_progress_and_cancel() {
        let job = Job::new();
        let worker = job.clone();
        worker.set_progress_within(&(0.5..1.0), 1, 2);
        worker.set_stage("sorting");
        job.cancel();
        assert_eq!(
            (job.progress(), job.stage().as_str(), worker.check()),
            (0.75, "sorting", Err(Cancelled))
        );
    }

    #[test]
    fn progress_stays_in_range() {
        let job = Job::new();
        job.set_progress(7.0);
        job.set_progress(f32::NAN);
        assert_eq!(job.progress(), 1.0);
    }
}
