//! Work shared among threads, watched by the thread that asked for it.
//!
//! The asking thread alone reports progress: it wakes every [`PULSE`] while the others work, and a report that says no stops
//! them at their next task.

use core::time::Duration;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Time between reports; a tenth of a second is what a cancelled build may still take.
const PULSE: Duration = Duration::from_millis(20);

/// Below so many items, to start threads takes longer than to do the work.
const WORTH_THREADS: usize = 8192;

/// A report said not to go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Cancelled;

/// Threads, and what the progress of their work is told to.
pub(crate) struct Crew<'r> {
    thread_count: usize,
    progress: Progress,
    /// Units of all work to come.
    total: u64,
    report: &'r mut dyn FnMut(f32, &str) -> bool,
}

/// What the threads share with the one that reports.
#[derive(Default)]
struct Progress {
    done: AtomicU64,
    cancelled: AtomicBool,
}

impl<'r> Crew<'r> {
    /// A crew of at least one thread, for `total` units of work.
    pub(crate) fn new(
        thread_count: usize,
        total: u64,
        report: &'r mut dyn FnMut(f32, &str) -> bool,
    ) -> Self {
        Self {
            thread_count: thread_count.max(1),
            progress: Progress::default(),
            total: total.max(1),
            report,
        }
    }

    /// Does the tasks, in any order; `items` says how much there is to do, in nodes or triangles.
    pub(crate) fn run<T: Send>(
        &mut self,
        stage: &str,
        items: usize,
        tasks: Vec<T>,
        work: impl Fn(T, &Hand<'_, T>) + Sync,
    ) -> Result<(), Cancelled> {
        let queue = Queue::new(tasks);
        let hand = Hand {
            queue: &queue,
            progress: &self.progress,
        };
        if items < WORTH_THREADS {
            hand.work_off(&work);
            return self.tell(stage);
        }
        std::thread::scope(|scope| {
            // Nothing is sent: the channel closes when the last thread ends.
            let (sender, ended) = channel::<()>();
            for _ in 0..self.thread_count {
                let (sender, hand, work) = (sender.clone(), hand, &work);
                scope.spawn(move || {
                    hand.work_off(work);
                    drop(sender);
                });
            }
            drop(sender);
            while ended.recv_timeout(PULSE) == Err(RecvTimeoutError::Timeout) {
                let fraction = self.progress.fraction(self.total);
                if !self.progress.is_cancelled() && !(self.report)(fraction, stage) {
                    self.progress.cancelled.store(true, Ordering::Relaxed);
                }
            }
        });
        self.tell(stage)
    }

    /// Reports where the work stands.
    pub(crate) fn tell(&mut self, stage: &str) -> Result<(), Cancelled> {
        let go_on = !self.progress.is_cancelled()
            && (self.report)(self.progress.fraction(self.total), stage);
        if go_on { Ok(()) } else { Err(Cancelled) }
    }
}

impl Progress {
    fn fraction(&self, total: u64) -> f32 {
        (self.done.load(Ordering::Relaxed) as f64 / total as f64).min(1.0) as f32
    }

    fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
}

/// What a task has of the crew.
pub(crate) struct Hand<'q, T> {
    queue: &'q Queue<T>,
    progress: &'q Progress,
}

impl<T> Clone for Hand<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Hand<'_, T> {}

impl<T> Hand<'_, T> {
    /// Adds a task that whichever thread is free may do.
    pub(crate) fn push(&self, task: T) {
        self.queue.push(task);
    }

    /// Says that units of work are done.
    pub(crate) fn advance(&self, units: u64) {
        self.progress.done.fetch_add(units, Ordering::Relaxed);
    }

    /// Whether a task in progress may as well stop.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.progress.is_cancelled()
    }

    /// Does tasks until there are none left and none that could add one.
    fn work_off(&self, work: &impl Fn(T, &Hand<'_, T>)) {
        while let Some((task, _running)) = self.queue.pop() {
            if !self.is_cancelled() {
                work(task, self);
            }
        }
    }
}

/// Tasks to do, and how many are being done.
struct Queue<T> {
    state: Mutex<State<T>>,
    changed: Condvar,
}

struct State<T> {
    waiting: Vec<T>,
    running: usize,
}

impl<T> Queue<T> {
    fn new(mut tasks: Vec<T>) -> Self {
        // Taken from the end: so the first task is the first done, and memory is walked upwards.
        tasks.reverse();
        Self {
            state: Mutex::new(State {
                waiting: tasks,
                running: 0,
            }),
            changed: Condvar::new(),
        }
    }

    fn lock(&self) -> MutexGuard<'_, State<T>> {
        // No code that could panic runs under the lock.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn push(&self, task: T) {
        self.lock().waiting.push(task);
        self.changed.notify_one();
    }

    /// A task, and what to drop once it is done; none when all are done.
    fn pop(&self) -> Option<(T, Running<'_, T>)> {
        let mut state = self.lock();
        loop {
            if let Some(task) = state.waiting.pop() {
                state.running += 1;
                return Some((task, Running(self)));
            }
            if state.running == 0 {
                return None;
            }
            state = self
                .changed
                .wait(state)
                .unwrap_or_else(PoisonError::into_inner);
        }
    }
}

/// A task in progress. It counts as done even if it panics, or the other threads would wait for ever.
struct Running<'q, T>(&'q Queue<T>);

impl<T> Drop for Running<'_, T> {
    fn drop(&mut self) {
        let mut state = self.0.lock();
        state.running -= 1;
        if state.running == 0 && state.waiting.is_empty() {
            self.0.changed.notify_all();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Cancelled, Crew, WORTH_THREADS};
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn tasks_that_add_tasks_are_all_done() {
        for (threads, items) in [(0, 1), (1, WORTH_THREADS), (3, WORTH_THREADS)] {
            let done = AtomicUsize::new(0);
            let mut report = |_: f32, _: &str| true;
            let mut crew = Crew::new(threads, 1, &mut report);
            let ended = crew.run("halving", items, vec![64_usize, 32], |count, hand| {
                if count == 1 {
                    done.fetch_add(1, Ordering::Relaxed);
                } else {
                    hand.push(count / 2);
                    hand.push(count / 2);
                }
            });
            assert_eq!((ended, done.into_inner()), (Ok(()), 96));
        }
    }

    #[test]
    fn only_the_asking_thread_reports_and_its_no_ends_the_work() {
        let asking = std::thread::current().id();
        let mut report = |_: f32, stage: &str| {
            assert_eq!((std::thread::current().id(), stage), (asking, "waiting"));
            false
        };
        let mut crew = Crew::new(2, 1, &mut report);
        let ended = crew.run("waiting", WORTH_THREADS, vec![()], |(), hand| {
            while !hand.is_cancelled() {
                std::thread::yield_now();
            }
        });
        assert_eq!(ended, Err(Cancelled));
    }

    #[test]
    #[should_panic(expected = "a scoped thread panicked")]
    fn a_panic_reaches_the_asking_thread() {
        let mut report = |_: f32, _: &str| true;
        let _ = Crew::new(3, 1, &mut report).run(
            "panicking",
            WORTH_THREADS,
            vec![1, 2, 3],
            |task, _| {
                assert_ne!(task, 2);
            },
        );
    }
}
