//! The host, as a plugin sees it: log, device, threads, folder; and the progress of a call.

use crate::abi::{self, CallRef, ErrorCode, ExtensionBox, LogLevel, VersionRecord};
use crate::error::{Error, Result};
use crate::gpu::Gpu;
use abi_stable::std_types::{ROption, RStr};
use std::path::PathBuf;
use std::sync::Arc;

/// The host. Cheap to clone; may be kept and used from any thread.
#[derive(Clone)]
pub struct Host {
    inner: Arc<Inner>,
}

struct Inner {
    object: abi::HostRef,
    gpu: Option<Gpu>,
}

impl Host {
    /// Wraps the border's object.
    pub(crate) fn new(object: abi::HostRef) -> Self {
        let gpu = object.gpu().into_option().map(Gpu::new);
        Self {
            inner: Arc::new(Inner { object, gpu }),
        }
    }

    /// The GPU service.
    ///
    /// # Errors
    /// [`ErrorCode::UNSUPPORTED`] if the session has no device. A plugin whose manifest needs a GPU is never asked to
    /// prepare without one.
    pub fn gpu(&self) -> Result<&Gpu> {
        let missing = || {
            Error::new(
                ErrorCode::UNSUPPORTED,
                "this session has no GPU device; use a CPU renderer",
            )
        };
        self.inner.gpu.as_ref().ok_or_else(missing)
    }

    /// The border version that the host was built with.
    pub fn api_version(&self) -> VersionRecord {
        self.inner.object.api_version()
    }

    /// Writes a line to the host's log, under the plugin's id.
    pub fn log(&self, level: LogLevel, text: &str) {
        self.inner.object.log(level, RStr::from_str(text));
    }

    /// Logs something for the user to know.
    pub fn info(&self, text: &str) {
        self.log(LogLevel::INFO, text);
    }

    /// Logs something that was done, but not as asked.
    pub fn warn(&self, text: &str) {
        self.log(LogLevel::WARN, text);
    }

    /// Logs why something is slower than it could be.
    pub fn performance_warning(&self, text: &str) {
        self.log(LogLevel::PERFORMANCE, text);
    }

    /// How many threads the plugin may keep busy. Its threads join before its `Drop` returns.
    pub fn thread_count(&self) -> usize {
        self.inner.object.thread_count().max(1) as usize
    }

    /// The folder of the plugin's file (which is loaded from a copy): for files that the plugin ships beside it.
    pub fn plugin_folder(&self) -> PathBuf {
        PathBuf::from(self.inner.object.plugin_folder().as_str())
    }

    /// An extension of the host, if it has one of this name.
    pub fn extension(&self, name: &str) -> Option<ExtensionBox> {
        self.inner
            .object
            .extension(RStr::from_str(name))
            .into_option()
    }
}

/// Cancel and progress of a running call.
///
/// Ask [`Progress::check`] in every long loop: a cancelled call has to return within 200 ms.
pub struct Progress<'a> {
    call: &'a dyn Call,
}

/// What [`Progress`] needs of the border's object; hides its lifetime.
pub(crate) trait Call {
    fn stop(&self) -> bool;
    fn report(&self, fraction: f32, stage: &str);
}

impl Call for CallRef<'_> {
    fn stop(&self) -> bool {
        self.should_stop() != 0
    }

    fn report(&self, fraction: f32, stage: &str) {
        self.progress(fraction, RStr::from_str(stage));
    }
}

impl<'a> Progress<'a> {
    pub(crate) fn new(call: &'a dyn Call) -> Self {
        Self { call }
    }

    /// Tells how far the call is, 0 to 1, and what it does.
    pub fn set(&self, fraction: f32, stage: &str) {
        self.call.report(fraction.clamp(0.0, 1.0), stage);
    }

    /// Whether the result is no longer wanted.
    pub fn is_cancelled(&self) -> bool {
        self.call.stop()
    }

    /// `Err` if the call was cancelled; for `?`.
    pub fn check(&self) -> Result<()> {
        if self.is_cancelled() {
            Err(Error::cancelled())
        } else {
            Ok(())
        }
    }
}

/// Turns an optional extension into the border's option.
pub(crate) fn no_extension() -> ROption<ExtensionBox> {
    ROption::RNone
}
