//! Jobs on all cores, within a time, until somebody says stop.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

use pointstage_plugin_api::{Error, Frame, Result};

/// How often the host is asked whether to stop.
const LOOK: Duration = Duration::from_millis(5);

/// Does jobs `0..count`, in order of their beginning, on the frame's threads; `take` gets what they give, in the order of their
/// ends. After `until` no job begins, but each thread does one; when the host says stop, jobs see it in their second
/// argument and give none.
///
/// # Errors
/// If no thread can be had.
pub(crate) fn run<T: Send>(
    frame: &Frame<'_>,
    count: usize,
    until: Instant,
    work: impl Fn(usize, &AtomicBool) -> Option<T> + Sync,
    mut take: impl FnMut(usize, T),
) -> Result<()> {
    let (stop, next) = (AtomicBool::new(false), AtomicUsize::new(0));
    let (sender, receiver) = channel();
    thread::scope(|scope| {
        let mut spawned = Ok(());
        for number in 0..frame.thread_count().min(count) {
            let (sender, work, stop, next) = (sender.clone(), &work, &stop, &next);
            let worker = move || {
                loop {
                    let job = next.fetch_add(1, Ordering::Relaxed);
                    if job >= count || stop.load(Ordering::Relaxed) {
                        return;
                    }
                    if let Some(found) = work(job, stop) {
                        // The receiver lives until all workers are done.
                        let _ = sender.send((job, found));
                    }
                    if Instant::now() >= until {
                        return;
                    }
                }
            };
            let name = "ewa-reference".to_owned();
            match thread::Builder::new()
                .name(name)
                .spawn_scoped(scope, worker)
            {
                // Fewer threads than wished for do, too.
                Err(error) if number == 0 => {
                    spawned = Err(Error::failed(format!("no thread to draw on: {error}")));
                }
                Ok(_) | Err(_) => {}
            }
        }
        drop(sender);
        loop {
            match receiver.recv_timeout(LOOK) {
                Ok((job, found)) => take(job, found),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return spawned,
            }
            if frame.should_stop() {
                stop.store(true, Ordering::Relaxed);
            }
        }
    })
}
