//! Preparing renderers and structures on worker threads, while the last good ones go on drawing.

use super::records::with_scene_record;
use super::selection::{OwnBlock, own_blocks};
use super::upload::SceneOnDevice;
use crate::plugins::{CallState, Factory};
use abi_stable::std_types::{RResult, RSlice, RStr};
use pointstage_plugin_api::abi::{
    ChangeKind, ChangeRecord, ErrorRecord, Handle, HostRef, PrepareRecord, RendererBox,
    SettingRecord, StructureBox, ValueKind,
};
use pointstage_plugin_api::settings_schema::{SettingValue, SettingValues};
use pointstage_plugin_api::{Error, ErrorCode};
use pointstage_scene::{Changes, ColumnChangeKind, Revision, Scene};
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError, channel};
use std::sync::{Arc, OnceLock};
use std::time::Duration;

/// What is prepared: a renderer or a structure.
pub(super) trait Product: Send + Sync + Sized + 'static {
    fn first(factory: &Factory, call: &PrepareRecord<'_>) -> RResult<Self, ErrorRecord>;
    fn next(&self, call: &PrepareRecord<'_>) -> RResult<Self, ErrorRecord>;
}

impl Product for RendererBox {
    fn first(factory: &Factory, call: &PrepareRecord<'_>) -> RResult<Self, ErrorRecord> {
        factory.object().prepare_renderer(call)
    }

    fn next(&self, call: &PrepareRecord<'_>) -> RResult<Self, ErrorRecord> {
        self.prepare_next(call)
    }
}

impl Product for StructureBox {
    fn first(factory: &Factory, call: &PrepareRecord<'_>) -> RResult<Self, ErrorRecord> {
        factory.object().prepare_structure(call)
    }

    fn next(&self, call: &PrepareRecord<'_>) -> RResult<Self, ErrorRecord> {
        self.prepare_next(call)
    }
}

/// The state that a preparation is for. If it differs, another one is due.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PrepareKey {
    pub scene: Revision,
    /// Values of the settings whose cost is 'prepare'.
    pub settings: SettingValues,
    /// Generation of the device; 0 without one.
    pub device: u64,
}

/// What a preparation works on.
pub(super) struct Inputs {
    pub key: PrepareKey,
    pub factory: Arc<Factory>,
    pub host: HostRef,
    pub scene: Arc<Scene>,
    /// All settings' values.
    pub settings: SettingValues,
    pub on_device: Option<Arc<SceneOnDevice>>,
}

/// A prepared renderer or structure.
pub(super) struct Ready<P> {
    pub product: P,
    pub key: PrepareKey,
    scene: Arc<Scene>,
    /// A structure's own blocks, copied when they are first asked for.
    own_blocks: OnceLock<Result<Vec<OwnBlock>, Error>>,
}

impl<P> Ready<P> {
    /// The scene that it was prepared for.
    pub(super) fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }
}

impl Ready<StructureBox> {
    /// The structure's own blocks.
    pub(super) fn own_blocks(&self) -> Result<&[OwnBlock], Error> {
        match self.own_blocks.get_or_init(|| own_blocks(&self.product)) {
            Ok(blocks) => Ok(blocks),
            Err(error) => Err(error.clone()),
        }
    }
}

/// How long a frame waits for a preparation.
#[derive(Clone, Copy, Debug)]
pub(super) enum Wait {
    /// A moment; it goes on afterwards.
    Grace(Duration),
    /// Until it is done; past the limit it is cancelled.
    Until(Duration),
}

struct Running<P> {
    key: PrepareKey,
    call: Arc<CallState>,
    result: Receiver<Result<Ready<P>, Error>>,
}

/// One plugin's preparations: the last good one, the one under way, and why the last one failed.
pub(super) struct Slot<P> {
    ready: Option<Arc<Ready<P>>>,
    running: Option<Running<P>>,
    failed: Option<(PrepareKey, Error)>,
}

/// How things stand for a key.
pub(super) enum Standing<P> {
    /// Prepared for just this.
    Ready(Arc<Ready<P>>),
    /// Under way: fraction and stage.
    Preparing(f32, String),
    /// It failed for just this.
    Failed(Error),
}

impl<P: Product> Slot<P> {
    /// An empty one that has what was prepared for another, to go on from and to draw with until then.
    pub(super) fn starting_from(ready: Option<Arc<Ready<P>>>) -> Self {
        Self {
            ready,
            running: None,
            failed: None,
        }
    }

    /// Starts what is due and tells how things stand.
    pub(super) fn standing(&mut self, inputs: Inputs, wait: Wait) -> Standing<P> {
        let key = inputs.key.clone();
        self.collect(None);
        if let Some(ready) = self.ready.as_ref().filter(|ready| ready.key == key) {
            return Standing::Ready(Arc::clone(ready));
        }
        if let Some((_, error)) = self.failed.as_ref().filter(|(failed, _)| *failed == key) {
            return Standing::Failed(error.clone());
        }
        let fresh = self
            .running
            .as_ref()
            .is_none_or(|running| running.key != key);
        if fresh {
            self.start(inputs);
        }
        match wait {
            // The grace is for what has just been started; later frames only look.
            Wait::Grace(grace) => self.collect(fresh.then_some(grace)),
            Wait::Until(limit) => self.collect_or_cancel(limit),
        }
        match (&self.ready, &self.failed, &self.running) {
            (Some(ready), _, _) if ready.key == key => Standing::Ready(Arc::clone(ready)),
            (_, Some((failed, error)), _) if *failed == key => Standing::Failed(error.clone()),
            (_, _, Some(running)) => {
                let (fraction, stage) = running.call.progress();
                Standing::Preparing(fraction, stage)
            }
            _ => Standing::Failed(Error::failed("prepare ended without a result")),
        }
    }

    fn collect_or_cancel(&mut self, limit: Duration) {
        self.collect(Some(limit));
        if let Some(running) = self.running.take() {
            // A plugin that ignores the cancel keeps its thread; its result is no longer wanted.
            running.call.cancel();
            let message = format!(
                "prepare did not end within {} s and was cancelled",
                limit.as_secs_f32()
            );
            self.failed = Some((running.key, Error::new(ErrorCode::CANCELLED, message)));
        }
    }

    /// The last good one, whatever it was prepared for.
    pub(super) fn last_good(&self) -> Option<&Arc<Ready<P>>> {
        self.ready.as_ref()
    }

    /// Marks the present preparation as failed: a view of it did.
    pub(super) fn fail(&mut self, error: Error) {
        if let Some(ready) = self.ready.take() {
            self.failed = Some((ready.key.clone(), error));
        }
    }

    /// Forgets a failure, so that the next frame tries again.
    pub(super) fn retry(&mut self) {
        self.failed = None;
    }

    /// Cancels what is under way: it has failed for its key then. Its error, if there was anything to cancel.
    pub(super) fn cancel(&mut self) -> Option<Error> {
        // What has just ended is kept rather than thrown away.
        self.collect(None);
        let running = self.running.take()?;
        // A plugin that ignores the cancel keeps its thread; its result is no longer wanted.
        running.call.cancel();
        let error = Error::new(ErrorCode::CANCELLED, "its preparation was cancelled");
        self.failed = Some((running.key, error.clone()));
        Some(error)
    }

    fn start(&mut self, inputs: Inputs) {
        if let Some(running) = self.running.take() {
            running.call.cancel();
        }
        let call = Arc::new(CallState::new());
        let previous = self.ready.clone();
        let (sender, result) = channel();
        let (key, worker_call) = (inputs.key.clone(), Arc::clone(&call));
        let work = move || {
            // The receiver is gone when the result is no longer wanted: then it is dropped here.
            let _ = sender.send(prepare(inputs, previous.as_deref(), &worker_call));
        };
        match std::thread::Builder::new()
            .name("prepare".into())
            .spawn(work)
        {
            Ok(_) => self.running = Some(Running { key, call, result }),
            Err(error) => {
                self.failed = Some((
                    key,
                    Error::failed(format!("no thread to prepare on: {error}")),
                ));
            }
        }
    }

    /// Takes a finished result; with a limit, waits for it.
    fn collect(&mut self, wait: Option<Duration>) {
        let Some(running) = &self.running else { return };
        let result = match wait {
            Some(limit) => running
                .result
                .recv_timeout(limit)
                .map_err(|e| e == RecvTimeoutError::Timeout),
            None => running
                .result
                .try_recv()
                .map_err(|e| e == TryRecvError::Empty),
        };
        let outcome = match result {
            Err(true) => return,
            Err(false) => Err(Error::failed(
                "the thread that prepared it ended without a word",
            )),
            Ok(outcome) => outcome,
        };
        let key = running.key.clone();
        self.running = None;
        match outcome {
            Ok(ready) => {
                self.failed = None;
                self.ready = Some(Arc::new(ready));
            }
            Err(error) => self.failed = Some((key, error)),
        }
    }
}

impl<P> Drop for Slot<P> {
    fn drop(&mut self) {
        if let Some(running) = &self.running {
            running.call.cancel();
        }
    }
}

/// Runs on the worker.
fn prepare<P: Product>(
    inputs: Inputs,
    previous: Option<&Ready<P>>,
    call: &Arc<CallState>,
) -> Result<Ready<P>, Error> {
    let Inputs {
        key,
        factory,
        host,
        scene,
        settings,
        on_device,
    } = inputs;
    let changes = previous
        .map(|previous| changes(previous, &key, &scene))
        .unwrap_or_default();
    let changes: Vec<ChangeRecord<'_>> = changes
        .iter()
        .map(|(kind, object, name)| ChangeRecord {
            kind: *kind,
            object: *object,
            name: RStr::from_str(name),
        })
        .collect();
    let settings = setting_records(&settings);
    let lookup = |content: *const u8| {
        on_device
            .as_ref()
            .map_or(Handle::NONE, |on_device| on_device.handle(content))
    };
    let outcome = with_scene_record(&scene, &lookup, |scene| {
        let record = PrepareRecord {
            host,
            scene,
            changes: RSlice::from_slice(&changes),
            settings: RSlice::from_slice(&settings),
            call: call.border(),
        };
        match previous {
            Some(previous) => previous.product.next(&record),
            None => P::first(&factory, &record),
        }
    });
    let product = outcome.into_result().map_err(Error::from)?;
    Ok(Ready {
        product,
        key,
        scene: Arc::clone(&scene),
        own_blocks: OnceLock::new(),
    })
}

/// What changed since the previous preparation.
fn changes<P>(
    previous: &Ready<P>,
    key: &PrepareKey,
    scene: &Scene,
) -> Vec<(ChangeKind, u64, String)> {
    let between = Changes::between(&previous.scene, scene);
    let mut list: Vec<(ChangeKind, u64, String)> = Vec::new();
    list.extend(
        between
            .added
            .iter()
            .map(|id| (ChangeKind::OBJECT_ADDED, id.0, String::new())),
    );
    list.extend(
        between
            .removed
            .iter()
            .map(|id| (ChangeKind::OBJECT_REMOVED, id.0, String::new())),
    );
    for change in &between.changed {
        for (changed, kind) in [
            (change.moved, ChangeKind::OBJECT_MOVED),
            (change.material, ChangeKind::MATERIAL),
            (change.flags, ChangeKind::FLAGS),
        ] {
            if changed {
                list.push((kind, change.id.0, String::new()));
            }
        }
        list.extend(change.columns.iter().map(|column| {
            let kind = match column.kind {
                ColumnChangeKind::Added => ChangeKind::COLUMN_ADDED,
                ColumnChangeKind::Changed => ChangeKind::COLUMN_CHANGED,
                ColumnChangeKind::Removed => ChangeKind::COLUMN_REMOVED,
            };
            (kind, change.id.0, column.name.clone())
        }));
    }
    let settings = key
        .settings
        .iter()
        .filter(|(id, value)| previous.key.settings.get(*id) != Some(value));
    list.extend(settings.map(|(id, _)| (ChangeKind::SETTING, 0, id.clone())));
    if previous.key.device != key.device {
        list.push((ChangeKind::DEVICE, 0, String::new()));
    }
    list
}

/// Values as border records.
pub(crate) fn setting_records(values: &SettingValues) -> Vec<SettingRecord<'_>> {
    values.iter().map(setting_record).collect()
}

fn setting_record<'a>((id, value): (&'a String, &'a SettingValue)) -> SettingRecord<'a> {
    let empty = SettingRecord {
        id: RStr::from_str(id),
        kind: ValueKind::BOOL,
        integer: 0,
        numbers: [0.0; 4],
        text: RStr::from_str(""),
    };
    match value {
        SettingValue::Bool(on) => SettingRecord {
            integer: (*on).into(),
            ..empty
        },
        SettingValue::Int(number) => SettingRecord {
            kind: ValueKind::INT,
            integer: *number,
            ..empty
        },
        SettingValue::Float(number) => SettingRecord {
            kind: ValueKind::FLOAT,
            numbers: [*number, 0.0, 0.0, 0.0],
            ..empty
        },
        SettingValue::Choice(text) => SettingRecord {
            kind: ValueKind::CHOICE,
            text: RStr::from_str(text),
            ..empty
        },
        SettingValue::Colour(numbers) => SettingRecord {
            kind: ValueKind::COLOUR,
            numbers: *numbers,
            ..empty
        },
        SettingValue::Text(text) => SettingRecord {
            kind: ValueKind::TEXT,
            text: RStr::from_str(text),
            ..empty
        },
    }
}
