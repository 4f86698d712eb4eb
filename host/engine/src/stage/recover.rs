//! What is dropped after an error, and how a lost device is replaced.

use super::choose::user_of;
use super::instances::Instance;
use super::options::{FrameError, StageError};
use super::request::{FrameRequest, Severity};
use super::session::{OnDevice, Stage};
use super::upload::SceneOnDevice;
use super::viewport::Viewport;
use crate::device::GpuDevice;
use crate::frame::compose::Composer;
use crate::gpu::GpuService;
use crate::plugins::PluginInfo;
use pointstage_plugin_api::Error as PluginError;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Losses of the device that are mended within [`LOSS_WINDOW`]; after more, the stage stays on the CPU.
const MOST_LOSSES: usize = 3;
const LOSS_WINDOW: Duration = Duration::from_mins(1);

impl Stage {
    /// After an error: drops the plugin's views or selectors everywhere, and what the request drew with.
    pub(super) fn drop_plugin(
        &mut self,
        request: &FrameRequest,
        info: &PluginInfo,
        error: &FrameError,
    ) {
        let source = match error {
            FrameError::Plugin { source, .. } => source.clone(),
            other => PluginError::failed(other),
        };
        for viewport in self.viewports.values_mut() {
            viewport.views.remove(&info.id);
            viewport.selectors.remove(&info.id);
            viewport.last_good.take_if(|good| good.id == info.id);
        }
        let user = user_of(request);
        if let Some(instance) = self.renderers.get_mut(info) {
            instance.fail(user, &source);
        }
        if let Some(instance) = self.structures.get_mut(info) {
            instance.fail(user, &source);
        }
    }

    /// Cancels the preparation of a renderer or structure that is under way; whether there was one. It counts as failed for
    /// the scene and settings that it was for, and others draw, until [`Stage::retry`]. A [`Notice`] tells so.
    ///
    /// [`Notice`]: super::Notice
    pub fn cancel_preparation(&mut self, id: &str) -> bool {
        // Every build is asked: none may be left out once one was cancelled.
        let renderers = self.renderers.of_id_mut(id).map(Instance::cancel);
        let renderer = renderers.filter(|is_cancelled| *is_cancelled).count() > 0;
        let structures = self.structures.of_id_mut(id).map(Instance::cancel);
        let structure = structures.filter(|is_cancelled| *is_cancelled).count() > 0;
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
