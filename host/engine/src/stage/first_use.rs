//! Before a plugin is used for the first time on a device: one frame in a child process, whose crash costs nothing.

use super::options::FrameError;
use super::session::Stage;
use crate::device::DeviceOptions;
use crate::plugins::{LoadPluginError, PluginInfo, TrialRequest, Verdict};
use pointstage_plugin_api::manifest::DeviceKind;

impl Stage {
    /// Tries a plugin in a child process before its first use on this device.
    pub(super) fn try_first(&self, info: &PluginInfo) -> Result<(), FrameError> {
        let DeviceOptions { backend, adapter } = self.options.device.clone();
        let on_device = self
            .adapter()
            .filter(|_| info.entry.needs.device == DeviceKind::Gpu);
        let request = TrialRequest {
            backend: backend.map(|backend| backend.name().to_owned()),
            adapter,
            use_device: on_device.is_some(),
            plugin: None,
        };
        let name = on_device.map_or("no device".to_owned(), |summary| {
            format!("{} {} {}", summary.backend, summary.name, summary.driver)
        });
        let verdict = self.registry.try_out(info, &request, &name);
        if verdict.is_usable() {
            return Ok(());
        }
        let Verdict {
            message, detail, ..
        } = verdict;
        Err(LoadPluginError::Refused { message, detail }.into())
    }
}
