//! The render thread: frames asked for by a window are drawn here, never on the window's own thread.
//!
//! Errands come first, then frames, then background work, one step of it at a time.

use super::request::{FrameRequest, FrameResult, Notice, ViewportId};
use super::{Adapter, FrameError, Stage, StageOptions};
use crate::plugins::Registry;
use std::collections::{HashMap, HashSet, VecDeque};
use std::ops::ControlFlow;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// What the thread has to tell.
#[derive(Clone, Debug, Default)]
pub struct StageStatus {
    /// The device's adapter, once it is open; none on the CPU.
    pub adapter: Option<Adapter>,
    /// Why there is no device, if one was wanted.
    pub no_device: Option<String>,
    /// Whether a frame is being drawn or waits.
    pub busy: bool,
    /// Whether there is background work, which goes on when nothing else is to be done.
    pub background: bool,
    /// What plugins in use hold on the device, by id.
    pub holdings: Vec<PluginHoldings>,
}

/// What one plugin holds on the device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PluginHoldings {
    /// Its id.
    pub id: String,
    /// Buffers, textures, pipelines, …
    pub handle_count: usize,
    /// Their bytes.
    pub bytes: u64,
    /// How long its library took to load.
    pub load_time: Option<Duration>,
}

/// The stage on a thread of its own. Dropping it ends the thread after the frame in hand.
pub struct StageThread {
    shared: Arc<Shared>,
    worker: Option<JoinHandle<()>>,
}

struct Shared {
    state: Mutex<State>,
    wake: Condvar,
    /// Told when the plugins are known, or never will be.
    opened: Condvar,
}

/// The plugins of a stage's thread, for threads that may wait for them.
#[derive(Clone)]
pub struct RegistryHandle {
    shared: Arc<Shared>,
}

impl RegistryHandle {
    /// The plugins found last; waits until the stage is open. None if it never opens.
    pub fn wait(&self) -> Option<Arc<Registry>> {
        let mut state = self.shared.lock();
        while state.registry.is_none() && !state.ended {
            state = self
                .shared
                .opened
                .wait(state)
                .unwrap_or_else(PoisonError::into_inner);
        }
        state.registry.clone()
    }
}

#[derive(Default)]
struct State {
    /// Frames that wait, at most one a viewport, in the order in which the viewports asked.
    wanted: VecDeque<FrameRequest>,
    errands: VecDeque<Errand>,
    background: VecDeque<Background>,
    latest: HashMap<ViewportId, Arc<FrameResult>>,
    /// Viewports that nobody has asked a frame for since they were closed.
    closed: HashSet<ViewportId>,
    notices: Vec<Notice>,
    error: Option<String>,
    registry: Option<Arc<Registry>>,
    status: StageStatus,
    quit: bool,
    /// The thread has ended, or is going to without ever having opened its stage.
    ended: bool,
}

type Errand = Box<dyn FnOnce(&mut Stage) + Send>;
type Background = Box<dyn FnMut(&mut Stage) -> ControlFlow<()> + Send>;

impl StageThread {
    /// Opens the stage on a new thread. `repaint` is called there whenever there is something new to show.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn spawn(
        options: StageOptions,
        repaint: impl Fn() + Send + 'static,
    ) -> std::io::Result<Self> {
        let shared = Arc::new(Shared {
            state: Mutex::default(),
            wake: Condvar::new(),
            opened: Condvar::new(),
        });
        let for_worker = Arc::clone(&shared);
        let worker = std::thread::Builder::new()
            .name("render".into())
            .spawn(move || {
                let end = EndOfThread(for_worker);
                end.0.run(options, &repaint);
            })?;
        Ok(Self {
            shared,
            worker: Some(worker),
        })
    }

    /// Asks for a frame. One of the same viewport that still waits is replaced, keeping its actions and its turn: each
    /// viewport gets one frame before any gets another.
    pub fn submit(&self, mut request: FrameRequest) {
        let mut state = self.shared.lock();
        let mut waiting = state.wanted.iter_mut();
        match waiting.find(|waiting| waiting.viewport == request.viewport) {
            Some(waiting) => {
                let mut actions = std::mem::take(&mut waiting.actions);
                actions.append(&mut request.actions);
                request.actions = actions;
                *waiting = request;
            }
            None => state.wanted.push_back(request),
        }
        state.status.busy = true;
        self.shared.wake.notify_one();
    }

    /// Does something with the stage between frames: rescan plugins, try a failed one again.
    pub fn errand(&self, errand: impl FnOnce(&mut Stage) + Send + 'static) {
        self.shared.lock().errands.push_back(Box::new(errand));
        self.shared.wake.notify_one();
    }

    /// Does long work in steps, each only when no frame and no errand waits: drawing an image in tiles. It goes on until a
    /// step breaks off, or the thread ends; one such work after the other. A step should not take longer than a frame may
    /// be late.
    pub fn background(&self, step: impl FnMut(&mut Stage) -> ControlFlow<()> + Send + 'static) {
        let mut state = self.shared.lock();
        state.background.push_back(Box::new(step));
        state.status.background = true;
        self.shared.wake.notify_one();
    }

    /// A viewport's last frame.
    pub fn latest(&self, viewport: ViewportId) -> Option<Arc<FrameResult>> {
        self.shared.lock().latest.get(&viewport).cloned()
    }

    /// Forgets a viewport: its frames, and what the stage holds for it.
    pub fn close_viewport(&self, viewport: ViewportId) {
        let mut state = self.shared.lock();
        state.wanted.retain(|request| request.viewport != viewport);
        state.errands.push_back(Box::new(move |stage| {
            stage.close_viewport(viewport);
        }));
        state.latest.remove(&viewport);
        state.closed.insert(viewport);
        self.shared.wake.notify_one();
    }

    /// Takes the notices of all frames since the last call: a window may not see each frame.
    pub fn take_notices(&self) -> Vec<Notice> {
        std::mem::take(&mut self.shared.lock().notices)
    }

    /// Takes the error of the last frame, if it had one that left no picture.
    pub fn take_error(&self) -> Option<String> {
        self.shared.lock().error.take()
    }

    /// The plugins found, once the stage is open.
    pub fn registry(&self) -> Option<Arc<Registry>> {
        self.shared.lock().registry.clone()
    }

    /// The plugins, for a thread that may wait until they are known.
    pub fn registry_handle(&self) -> RegistryHandle {
        RegistryHandle {
            shared: Arc::clone(&self.shared),
        }
    }

    /// Device and state.
    pub fn status(&self) -> StageStatus {
        self.shared.lock().status.clone()
    }
}

impl Drop for StageThread {
    fn drop(&mut self) {
        self.shared.lock().quit = true;
        self.shared.wake.notify_one();
        if let Some(worker) = self.worker.take() {
            // A panic of the render thread was reported when it happened.
            let _ = worker.join();
        }
    }
}

/// Says that the thread has ended, by a panic too.
struct EndOfThread(Arc<Shared>);

impl Drop for EndOfThread {
    fn drop(&mut self) {
        self.0.lock().ended = true;
        self.0.opened.notify_all();
    }
}

enum Work {
    Errand(Errand),
    Frame(Box<FrameRequest>),
    Background(Background),
    Quit,
}

impl Shared {
    fn lock(&self) -> std::sync::MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn run(&self, options: StageOptions, repaint: &impl Fn()) {
        let mut stage = match Stage::new(options) {
            Ok(stage) => stage,
            Err(error) => {
                self.lock().error = Some(error.to_string());
                return repaint();
            }
        };
        self.publish(&mut stage);
        repaint();
        loop {
            match self.next() {
                Work::Quit => return,
                Work::Errand(errand) => {
                    errand(&mut stage);
                    self.publish(&mut stage);
                }
                Work::Background(mut step) => {
                    let flow = step(&mut stage);
                    self.publish(&mut stage);
                    let mut state = self.lock();
                    if flow.is_continue() {
                        state.background.push_front(step);
                    }
                    state.status.background = !state.background.is_empty();
                }
                Work::Frame(request) => {
                    let outcome = stage.frame(&request);
                    self.publish(&mut stage);
                    self.store(request.viewport, outcome);
                }
            }
            repaint();
        }
    }

    fn next(&self) -> Work {
        let mut state = self.lock();
        loop {
            if state.quit {
                return Work::Quit;
            }
            if let Some(errand) = state.errands.pop_front() {
                return Work::Errand(errand);
            }
            if let Some(request) = state.wanted.pop_front() {
                state.closed.remove(&request.viewport);
                return Work::Frame(Box::new(request));
            }
            state.status.busy = false;
            if let Some(step) = state.background.pop_front() {
                return Work::Background(step);
            }
            state = self
                .wake
                .wait(state)
                .unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn publish(&self, stage: &mut Stage) {
        let holdings = stage.all_holdings();
        let mut state = self.lock();
        state.notices.append(&mut stage.notices);
        state.status.holdings = holdings;
        state.registry = Some(stage.registry());
        self.opened.notify_all();
        state.status.adapter = stage.adapter();
        state.status.no_device = stage.no_device().map(ToOwned::to_owned);
    }

    fn store(&self, viewport: ViewportId, outcome: Result<FrameResult, FrameError>) {
        let mut state = self.lock();
        match outcome {
            Ok(result) => {
                state.notices.extend(result.notices.iter().cloned());
                // One that was closed while its frame was drawn has no use for it.
                if !state.closed.contains(&viewport) {
                    state.latest.insert(viewport, Arc::new(result));
                }
                state.error = None;
            }
            Err(error) => state.error = Some(error.to_string()),
        }
        state.status.busy = !state.wanted.is_empty();
    }
}
