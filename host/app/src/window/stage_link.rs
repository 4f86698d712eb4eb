//! The window's side of the stage: requests go out, pictures, notices and lists come back. Nothing here waits.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use pointstage_engine::frame::legend::{Legend, legend};
use pointstage_engine::frame::targets::{TargetSpec, host_target_spec};
use pointstage_engine::stage::{
    Adapter, FrameRequest, FrameResult, Notice, PluginHoldings, Severity, Show, Stage,
    StageOptions, StageThread, ViewportId,
};
use pointstage_plugin_api::abi::Format;
use pointstage_scene::{Loaders, Scene};

use super::rows::{self, Rows};
use crate::file_loaders::loaders;

/// The stage on its thread, and what came from it.
pub(crate) struct StageLink {
    thread: StageThread,
    rows: (Sender<Rows>, Receiver<Rows>),
    /// What went wrong on errands.
    failures: (Sender<String>, Receiver<String>),
    /// Lists asked for that have not come yet.
    awaited_rows: usize,
}

/// What draws now, or why no device does.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct DrawnWith {
    adapter: Option<Adapter>,
    no_device: Option<String>,
}

impl StageLink {
    /// Opens the stage on a thread of its own, which calls `wake` whenever there is something new.
    pub(crate) fn start(
        options: StageOptions,
        wake: &Arc<dyn Fn() + Send + Sync>,
    ) -> std::io::Result<Self> {
        let wake = Arc::clone(wake);
        Ok(Self {
            thread: StageThread::spawn(options, move || wake())?,
            rows: channel(),
            failures: channel(),
            awaited_rows: 0,
        })
    }

    /// The loaders of the program and of its plugins, for threads that may wait until those are known.
    pub(crate) fn loaders(&self) -> Loaders {
        let handle = self.thread.registry_handle();
        loaders(move || handle.wait())
    }

    /// Whether plugins are known and pictures can be asked for.
    pub(crate) fn is_ready(&self) -> bool {
        self.thread.registry().is_some()
    }

    /// Whether all that was asked for has been answered. What came last may still have to be taken.
    pub(crate) fn is_idle(&self) -> bool {
        self.is_ready() && self.awaited_rows == 0 && !self.thread.status().busy
    }

    /// Asks for a picture; one that waits is replaced.
    pub(crate) fn submit(&self, request: FrameRequest) {
        self.thread.submit(request);
    }

    /// Does long work step by step when no picture waits.
    pub(crate) fn background(
        &self,
        step: impl FnMut(&mut Stage) -> ControlFlow<()> + Send + 'static,
    ) {
        self.thread.background(step);
    }

    /// A view's newest picture, if it is another one than `known`.
    pub(crate) fn new_picture(
        &self,
        viewport: ViewportId,
        known: Option<&Arc<FrameResult>>,
    ) -> Option<Arc<FrameResult>> {
        let latest = self.thread.latest(viewport)?;
        let is_known = known.is_some_and(|known| Arc::ptr_eq(known, &latest));
        (!is_known).then_some(latest)
    }

    /// A view has gone, or is hidden: what is held for it may go.
    pub(crate) fn close(&self, viewport: ViewportId) {
        self.thread.close_viewport(viewport);
    }

    /// Messages since the last call.
    pub(crate) fn take_notices(&self) -> Vec<Notice> {
        let mut notices = self.thread.take_notices();
        let failures = self.thread.take_error().into_iter();
        notices.extend(
            failures
                .chain(self.failures.1.try_iter())
                .map(|text| Notice {
                    severity: Severity::Error,
                    plugin: String::new(),
                    text,
                    detail: String::new(),
                }),
        );
        notices
    }

    /// Asks which renderers and plugins there are, and which fit `scene`.
    pub(crate) fn ask_for_rows(&mut self, scene: Arc<Scene>) {
        self.awaited_rows += 1;
        let answer = self.rows.0.clone();
        self.thread.errand(move |stage| {
            // The window has closed when nobody listens.
            let _ = answer.send(rows::of(stage, &scene));
        });
    }

    /// The newest answer to [`ask_for_rows`](Self::ask_for_rows), once.
    pub(crate) fn take_rows(&mut self) -> Option<Rows> {
        let mut answers: Vec<Rows> = self.rows.1.try_iter().collect();
        self.awaited_rows -= answers.len();
        answers.pop()
    }

    /// Does something about plugin files on the stage's thread, tells what went wrong, and lists anew.
    pub(crate) fn manage_plugins<E: std::error::Error + 'static>(
        &mut self,
        scene: Arc<Scene>,
        act: impl FnOnce(&mut Stage) -> Result<(), E> + Send + 'static,
    ) {
        let failures = self.failures.0.clone();
        self.thread.errand(move |stage| {
            if let Err(error) = act(stage) {
                // The window has closed when nobody listens.
                let _ = failures.send(error.to_string());
            }
        });
        self.ask_for_rows(scene);
    }

    /// What plugins in use hold on the device.
    pub(crate) fn holdings(&self) -> Vec<PluginHoldings> {
        self.thread.status().holdings
    }

    /// Stops the preparation of a renderer or structure.
    pub(crate) fn cancel_preparation(&self, id: String) {
        self.thread.errand(move |stage| {
            stage.cancel_preparation(&id);
        });
    }

    /// Lets a renderer or structure that was cancelled or failed be prepared again.
    pub(crate) fn prepare_again(&self, id: String) {
        self.thread.errand(move |stage| stage.retry(&id));
    }

    /// Destroys the graphics device as a driver's crash would; the next picture is drawn with a new one.
    pub(crate) fn lose_device(&self) {
        self.thread.errand(|stage| {
            if let Some(device) = stage.device() {
                device.destroy();
            }
        });
    }

    /// What draws now.
    pub(crate) fn drawn_with(&self) -> DrawnWith {
        let status = self.thread.status();
        DrawnWith {
            adapter: status.adapter,
            no_device: status.no_device,
        }
    }

    /// Whether the CPU draws, by a device's driver or without one.
    pub(crate) fn draws_on_cpu(&self) -> bool {
        let adapter = self.thread.status().adapter;
        adapter.is_none_or(|adapter| adapter.is_software)
    }

    /// What draws, in a few words for the status bar.
    pub(crate) fn adapter(&self) -> String {
        let status = self.thread.status();
        match (status.adapter, status.no_device) {
            (Some(adapter), _) => format!("{} ({})", adapter.name, adapter.backend),
            (None, Some(_)) => "no graphics device".to_owned(),
            (None, None) if self.is_ready() => "CPU only".to_owned(),
            (None, None) => "opening the device".to_owned(),
        }
    }

    /// Why there is no device although one was wanted.
    pub(crate) fn no_device(&self) -> Option<String> {
        self.thread.status().no_device
    }

    /// Versions and adapter, for reports.
    pub(crate) fn facts(&self) -> Vec<(String, String)> {
        let status = self.thread.status();
        let mut facts = vec![
            (
                "Pointstage".to_owned(),
                env!("CARGO_PKG_VERSION").to_owned(),
            ),
            (
                "System".to_owned(),
                format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            ),
        ];
        if let Some(adapter) = status.adapter {
            facts.push(("Adapter".to_owned(), adapter.name));
            facts.push(("Interface".to_owned(), adapter.backend));
            facts.push(("Driver".to_owned(), adapter.driver));
        }
        if let Some(reason) = status.no_device {
            facts.push(("No device".to_owned(), reason));
        }
        facts
    }
}

/// The legend of what a picture shows; none for colours.
pub(crate) fn legend_of(show: &Show, range: Option<[f32; 2]>) -> Option<Legend> {
    let Show::Target(key) = show else { return None };
    if let Some(spec) = host_target_spec(key) {
        return Some(legend(spec, range));
    }
    // A target that a plugin declares is shown on a ramp.
    let spec = TargetSpec::declared(key, Format::R16_FLOAT, [0.0; 4], "").ok()?;
    Some(legend(&spec, range))
}
