//! The host as one plugin sees it: log, GPU service, threads and folder. No panic leaves here.

use super::log_book::LogBook;
use super::registry::PluginInfo;
use abi_stable::sabi_trait::TD_Opaque;
use abi_stable::std_types::{RArc, ROption, RStr, RString};
use pointstage_plugin_api::abi::{
    ExtensionBox, GpuObject_TO, GpuRef, HostObject, HostObject_TO, HostRef, LogLevel, VersionRecord,
};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;

/// What the host offers to one instance of a plugin.
pub struct HostInstance {
    plugin: String,
    folder: String,
    gpu: Option<GpuRef>,
    thread_count: u32,
    log: Arc<LogBook>,
}

impl HostInstance {
    /// The host for an instance of the plugin `info`. `gpu` is none in a session without a device.
    pub fn border(
        info: &PluginInfo,
        gpu: Option<GpuRef>,
        thread_count: usize,
        log: Arc<LogBook>,
    ) -> HostRef {
        let folder = info.path.parent().unwrap_or(Path::new(""));
        let instance = Self {
            plugin: info.id.clone(),
            folder: folder.to_string_lossy().into_owned(),
            gpu,
            thread_count: u32::try_from(thread_count.max(1)).unwrap_or(u32::MAX),
            log,
        };
        HostObject_TO::from_ptr(RArc::new(instance), TD_Opaque)
    }

    /// Runs `act`; a panic becomes `otherwise`, and a line in the log.
    fn guarded<T>(&self, what: &str, otherwise: T, act: impl FnOnce() -> T) -> T {
        catch_unwind(AssertUnwindSafe(act)).unwrap_or_else(|_| {
            tracing::error!(
                plugin = self.plugin,
                "the host panicked in {what}; this is a fault of Pointstage"
            );
            otherwise
        })
    }
}

impl HostObject for HostInstance {
    fn api_version(&self) -> VersionRecord {
        self.guarded(
            "api_version",
            VersionRecord {
                major: 1,
                minor: 0,
                patch: 0,
            },
            api_version,
        )
    }

    fn log(&self, level: LogLevel, text: RStr<'_>) {
        self.guarded("log", (), || {
            self.log.add(&self.plugin, level, text.as_str());
        });
    }

    fn gpu(&self) -> ROption<GpuRef> {
        let share = |gpu: &GpuRef| GpuObject_TO::from_sabi(gpu.obj.shallow_clone());
        self.guarded("gpu", ROption::RNone, || {
            self.gpu.as_ref().map(share).into()
        })
    }

    fn thread_count(&self) -> u32 {
        self.thread_count
    }

    fn plugin_folder(&self) -> RString {
        self.guarded("plugin_folder", RString::new(), || {
            self.folder.as_str().into()
        })
    }

    fn extension(&self, _name: RStr<'_>) -> ROption<ExtensionBox> {
        ROption::RNone
    }
}

/// The border version that this program was built with.
fn api_version() -> VersionRecord {
    let text = super::library::host_api();
    let mut parts = text.split('.').map(|part| part.parse().unwrap_or(0));
    let mut next = || parts.next().unwrap_or(0);
    VersionRecord {
        major: next(),
        minor: next(),
        patch: next(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plugins::registry::tests::info;

    #[test]
    fn a_plugin_sees_its_own_folder_and_logs_under_its_id() {
        let log = Arc::new(LogBook::default());
        let host = HostInstance::border(
            &info("org.example.dots", "1.0.0"),
            None,
            3,
            Arc::clone(&log),
        );
        host.log(LogLevel::WARN, "three surfels have no colour".into());
        assert_eq!(log.lines()[0].plugin, "org.example.dots");
        assert_eq!(host.plugin_folder().as_str(), "/plugins");
        assert_eq!(host.thread_count(), 3);
        assert_eq!(host.api_version().major, 1);
        assert!(host.gpu().is_none());
    }
}
