//! Long work, each with progress and cancel: one after the other on a worker thread, or wherever else it is done.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;

use pointstage_scene::Job;

/// Identity of a task in this process.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct TaskId(u64);

/// One task that waits or runs.
#[derive(Clone, Debug)]
pub(crate) struct TaskState {
    /// Names it.
    pub(crate) id: TaskId,
    /// What it is, for people.
    pub(crate) title: String,
    /// Progress, stage and cancel.
    pub(crate) job: Job,
}

/// The queue and its worker. Results of type `T` come back through [`take_finished`](Self::take_finished).
pub(crate) struct Tasks<T> {
    open: Vec<TaskState>,
    next: u64,
    work: Option<Sender<Assignment<T>>>,
    results: Receiver<(TaskId, T)>,
    /// For tasks that run elsewhere.
    answer: Sender<(TaskId, T)>,
    wake: Arc<dyn Fn() + Send + Sync>,
    worker: Option<JoinHandle<()>>,
}

/// A task that runs elsewhere than on the worker. Dropping it unfinished gives the result that it was made with.
pub(crate) struct Elsewhere<T> {
    id: TaskId,
    job: Job,
    answer: Sender<(TaskId, T)>,
    wake: Arc<dyn Fn() + Send + Sync>,
    /// None once it is finished.
    lost: Option<T>,
}

impl<T> Elsewhere<T> {
    /// Progress, stage and cancel.
    pub(crate) fn job(&self) -> &Job {
        &self.job
    }

    /// Ends it with this result.
    pub(crate) fn finish(mut self, result: T) {
        self.lost = Some(result);
    }
}

impl<T> Drop for Elsewhere<T> {
    fn drop(&mut self) {
        if let Some(result) = self.lost.take() {
            // The window is gone when nobody listens.
            let _ = self.answer.send((self.id, result));
            (self.wake)();
        }
    }
}

type Work<T> = Box<dyn FnOnce(&Job) -> T + Send>;

struct Assignment<T> {
    id: TaskId,
    job: Job,
    work: Work<T>,
}

impl<T: Send + 'static> Tasks<T> {
    /// Starts the worker. `wake` is called from it whenever a task ends.
    pub(crate) fn new(wake: Arc<dyn Fn() + Send + Sync>) -> std::io::Result<Self> {
        let (work, assignments) = channel::<Assignment<T>>();
        let (answer, results) = channel();
        let (for_worker, wake_worker) = (answer.clone(), wake.clone());
        let worker = std::thread::Builder::new()
            .name("pointstage-tasks".to_owned())
            .spawn(move || {
                for Assignment { id, job, work } in assignments {
                    // The window is gone when nobody listens; the queue is gone then too.
                    if for_worker.send((id, work(&job))).is_err() {
                        return;
                    }
                    wake_worker();
                }
            })?;
        Ok(Self {
            open: Vec::new(),
            next: 0,
            work: Some(work),
            results,
            answer,
            wake,
            worker: Some(worker),
        })
    }

    /// Puts work at the queue's end. It has to return soon after its job is cancelled, also if that came first.
    pub(crate) fn push(
        &mut self,
        title: impl Into<String>,
        work: impl FnOnce(&Job) -> T + Send + 'static,
    ) -> TaskId {
        let (id, job) = self.open_new(title.into());
        let assignment = Assignment {
            id,
            job,
            work: Box::new(work),
        };
        if let Some(sender) = &self.work {
            // The worker ends only with the queue, whatever the work does: see `guarded` where work is made.
            let _ = sender.send(assignment);
        }
        id
    }

    /// Shows work that is done elsewhere, until it is finished; `lost` is its result if it never is.
    pub(crate) fn push_elsewhere(&mut self, title: impl Into<String>, lost: T) -> Elsewhere<T> {
        let (id, job) = self.open_new(title.into());
        Elsewhere {
            id,
            job,
            answer: self.answer.clone(),
            wake: self.wake.clone(),
            lost: Some(lost),
        }
    }

    fn open_new(&mut self, title: String) -> (TaskId, Job) {
        let id = TaskId(self.next);
        self.next += 1;
        let job = Job::new();
        self.open.push(TaskState {
            id,
            title,
            job: job.clone(),
        });
        (id, job)
    }

    /// Tasks that run or wait, in order. The first of the worker's runs; those elsewhere go their own way.
    pub(crate) fn open(&self) -> &[TaskState] {
        &self.open
    }

    /// Asks a task to stop; it ends with its own answer for that.
    pub(crate) fn cancel(&self, id: TaskId) {
        if let Some(task) = self.open.iter().find(|task| task.id == id) {
            task.job.cancel();
        }
    }

    /// What ended since the last call, in order.
    pub(crate) fn take_finished(&mut self) -> Vec<T> {
        let finished: Vec<(TaskId, T)> = self.results.try_iter().collect();
        self.open
            .retain(|task| finished.iter().all(|(id, _)| *id != task.id));
        finished.into_iter().map(|(_, result)| result).collect()
    }
}

impl<T> Drop for Tasks<T> {
    /// Cancels what is open and waits for the worker, so that no thread outlives the window.
    fn drop(&mut self) {
        for task in &self.open {
            task.job.cancel();
        }
        self.work = None;
        if let Some(worker) = self.worker.take() {
            // A panic of the worker was reported by the panic hook.
            let _ = worker.join();
        }
    }
}

/// `work`'s answer, or `failed` with the panic's message: a defect in a loader must not end the queue.
pub(crate) fn guarded<T>(work: impl FnOnce() -> T, failed: impl FnOnce(String) -> T) -> T {
    match std::panic::catch_unwind(std::panic::AssertUnwindSafe(work)) {
        Ok(answer) => answer,
        Err(panic) => {
            let text = panic
                .downcast_ref::<String>()
                .cloned()
                .or_else(|| panic.downcast_ref::<&str>().map(|&text| text.to_owned()))
                .unwrap_or_else(|| "a panic without a message".to_owned());
            failed(text)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tasks, and a receiver that hears of every end.
    fn tasks() -> (Tasks<&'static str>, Receiver<()>) {
        let (heard, ends) = channel();
        let wake = Arc::new(move || {
            let _ = heard.send(());
        });
        (Tasks::new(wake).expect("a thread"), ends)
    }

    #[test]
    fn tasks_run_in_order_and_leave_the_list() {
        let (mut tasks, ends) = tasks();
        tasks.push("first", |_| "1");
        tasks.push("second", |_| "2");
        assert_eq!(tasks.open().len(), 2);
        for _ in 0..2 {
            ends.recv().expect("the worker lives");
        }
        assert_eq!(tasks.take_finished(), ["1", "2"]);
        assert!(tasks.open().is_empty());
    }

    #[test]
    fn a_cancelled_task_learns_of_it_while_it_runs() {
        let (mut tasks, ends) = tasks();
        let id = tasks.push("endless", |job| {
            while job.check().is_ok() {
                std::thread::yield_now();
            }
            "stopped"
        });
        tasks.cancel(id);
        ends.recv().expect("the worker lives");
        assert_eq!(tasks.take_finished(), ["stopped"]);
    }

    #[test]
    fn work_elsewhere_is_shown_until_it_is_finished_or_lost() {
        let (mut tasks, _ends) = tasks();
        let first = tasks.push_elsewhere("first", "lost");
        let second = tasks.push_elsewhere("second", "lost");
        first.job().set_progress(0.5);
        assert_eq!(tasks.open()[0].job.progress(), 0.5);
        tasks.cancel(tasks.open()[1].id);
        assert!(second.job().is_cancelled());
        first.finish("done");
        drop(second);
        assert_eq!(tasks.take_finished(), ["done", "lost"]);
        assert!(tasks.open().is_empty());
    }

    #[test]
    fn dropping_the_queue_stops_what_runs() {
        let (mut tasks, _ends) = tasks();
        for _ in 0..3 {
            tasks.push("endless", |job| {
                while job.check().is_ok() {
                    std::thread::yield_now();
                }
                "stopped"
            });
        }
        drop(tasks);
    }

    #[test]
    fn a_panic_becomes_an_answer() {
        let answer = guarded(|| panic!("broken loader"), |text| text);
        assert_eq!(answer, "broken loader");
    }
}
