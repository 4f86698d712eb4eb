//! What is dropped after an error, and how a lost device is replaced.

use super::options::{FrameError, StageError};
use super::prepare::Product;
use super::request::Severity;
use super::session::{Instance, OnDevice, Stage};
use super::upload::SceneOnDevice;
use super::viewport::Viewport;
use crate::device::GpuDevice;
use crate::frame::compose::Composer;
use crate::gpu::GpuService;
use pointstage_plugin_api::Error as PluginError;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Losses of the device that are mended within [`LOSS_WINDOW`]; after more, the stage stays on the CPU.
const MOST_LOSSES: usize = 3;
const LOSS_WINDOW: Duration = Duration::from_mins(1);

impl Stage {
    /// After an error: drops the plugin's views or selectors everywhere, and its preparation.
    pub(super) fn drop_plugin(&mut self, id: &str, error: &FrameError) {
        let source = match error {
            FrameError::Plugin { source, .. } => source.clone(),
            other => PluginError::failed(other),
        };
        for viewport in self.viewports.values_mut() {
            viewport.views.remove(id);
            viewport.selectors.remove(id);
            viewport.last_good.take_if(|good| good == id);
        }
        if let Some(instance) = self.renderers.get_mut(id) {
            instance.fail(source.clone());
        }
        if let Some(instance) = self.structures.get_mut(id) {
            instance.fail(source);
        }
    }

    /// Cancels the preparation of a renderer or structure that is under way; whether there was one. It counts as failed for
    /// the scene and settings that it was for, and others draw, until [`Stage::retry`]. A [`Notice`] tells so.
    ///
    /// [`Notice`]: super::Notice
    pub fn cancel_preparation(&mut self, id: &str) -> bool {
        let renderer = self.renderers.get_mut(id);
        let renderer = renderer.is_some_and(Instance::cancel);
        let structure = self.structures.get_mut(id);
        let structure = structure.is_some_and(Instance::cancel);
        if !renderer && !structure {
            return false;
        }
        let text = if renderer {
            "its preparation was cancelled; another renderer goes on drawing until you try it again"
        } else {
            "its preparation was cancelled; all surfels are drawn until you try it again"
        };
        self.tell(Severity::Info, id, format!("{id}: {text}"), String::new());
        true
    }

    /// Opens the device, or notes why not.
    pub(super) fn open_device(&mut self) -> Result<(), StageError> {
        match GpuDevice::open(&self.options.device) {
            Ok(device) => {
                let service = GpuService::new(Arc::clone(&device));
                let scene = Arc::new(SceneOnDevice::new(&device, &service)?);
                let composer = Composer::new(Arc::clone(&device))?;
                self.gpu = Some(OnDevice {
                    device,
                    service,
                    scene,
                    composer,
                });
                self.no_device = None;
            }
            Err(error) => {
                self.tell(
                    Severity::Warning,
                    "",
                    format!("no graphics device: {error}; drawing on the CPU"),
                    String::new(),
                );
                self.no_device = Some(error.to_string());
            }
        }
        Ok(())
    }

    /// If the device is lost: forgets all that was on it and opens another one, at most three times in a minute.
    pub(super) fn mend_device(&mut self) {
        let Some(gpu) = &self.gpu else { return };
        for error in gpu.device.take_errors() {
            self.tell(
                Severity::Error,
                "",
                format!("the graphics device reports: {error}"),
                String::new(),
            );
        }
        if !self.gpu.as_ref().is_some_and(|gpu| gpu.device.is_lost()) {
            return;
        }
        self.viewports
            .values_mut()
            .for_each(Viewport::forget_device);
        self.forget_plugins();
        self.gpu = None;
        let now = Instant::now();
        self.losses
            .retain(|loss| now.duration_since(*loss) < LOSS_WINDOW);
        self.losses.push(now);
        if self.losses.len() > MOST_LOSSES {
            let text = "the graphics device was lost again; drawing on the CPU from now on. Restart the program to try it again";
            self.no_device = Some("it was lost more than three times in a minute".into());
            self.tell(Severity::Error, "", text.into(), String::new());
            return;
        }
        self.tell(
            Severity::Warning,
            "",
            "the graphics device was lost; a new one was opened".into(),
            String::new(),
        );
        if let Err(error) = self.open_device() {
            self.no_device = Some(error.to_string());
            self.tell(Severity::Error, "", error.to_string(), String::new());
        }
    }

    /// Drops all that plugins made: views first.
    pub(super) fn forget_plugins(&mut self) {
        for viewport in self.viewports.values_mut() {
            viewport.views.clear();
            viewport.selectors.clear();
        }
        self.renderers.clear();
        self.structures.clear();
    }
}

impl<P: Product> Instance<P> {
    /// Marks the preparation as failed, as the user is told.
    fn fail(&mut self, error: PluginError) {
        self.told = Some(error.clone());
        self.slot.fail(error);
        self.watch = None;
    }

    /// Notes that the preparation failed in a way that was survived; whether that is still to be told.
    pub(super) fn note_failure(&mut self, error: &PluginError) -> bool {
        self.watch = None;
        self.told.replace(error.clone()).as_ref() != Some(error)
    }

    /// Cancels the preparation under way; whether there was one. The user asked for it, so it is not told as a failure.
    fn cancel(&mut self) -> bool {
        let error = self.slot.cancel();
        let is_cancelled = error.is_some();
        if is_cancelled {
            self.told = error;
            self.watch = None;
        }
        is_cancelled
    }

    /// Forgets a failure, so that the next frame tries again.
    pub(super) fn retry(&mut self) {
        self.slot.retry();
        self.told = None;
    }
}
