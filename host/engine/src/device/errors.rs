//! What goes wrong with a device, as values.

use pointstage_plugin_api::abi::{ErrorCode, ErrorRecord};
use std::error::Error as _;
use std::fmt::Write as _;
use std::pin::pin;
use std::task::{Context, Poll, Waker};

/// Why no device could be opened.
#[derive(Debug, thiserror::Error)]
pub enum OpenDeviceError {
    /// Not one adapter on this machine, or none of that interface.
    #[error(
        "no graphics adapter found{of_backend}; install a Vulkan driver (on Debian and Ubuntu: mesa-vulkan-drivers, \
         which also draws without a GPU), or go on without a device"
    )]
    NoAdapter {
        /// ' for vulkan', or empty.
        of_backend: String,
    },
    /// None is called so.
    #[error("no graphics adapter '{wanted}'; there are: {existing}")]
    UnknownAdapter {
        /// What was asked for.
        wanted: String,
        /// Numbers and names.
        existing: String,
    },
    /// The adapter cannot run Pointstage's shaders.
    #[error(
        "the graphics adapter '{adapter}' lacks {lacks}; choose another one, or install a Vulkan driver (on Debian \
         and Ubuntu: mesa-vulkan-drivers)"
    )]
    Unsuitable {
        /// Its name.
        adapter: String,
        /// What it lacks.
        lacks: String,
    },
    /// The driver would not.
    #[error(
        "the graphics adapter '{adapter}' gives no device: {source}; choose another adapter, or update its driver"
    )]
    Refused {
        /// Its name.
        adapter: String,
        /// wgpu's reason.
        #[source]
        source: Box<wgpu::RequestDeviceError>,
    },
}

/// Why the device or the GPU service did not do what it was asked.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GpuError {
    /// A descriptor, command or shader was refused.
    #[error("{message}")]
    Validation {
        /// One or two sentences.
        message: String,
        /// The long form; may be empty.
        detail: String,
    },
    /// A handle is stale, of another owner or of another kind.
    #[error("{0}")]
    BadHandle(String),
    /// The device's memory or the owner's quota is used up.
    #[error("{0}")]
    OutOfMemory(String),
    /// Neither this host nor this device can do it, or it was not asked for in the manifest.
    #[error("{0}")]
    Unsupported(String),
    /// The device is gone.
    #[error("{0}")]
    DeviceLost(String),
    /// The service itself panicked: a bug in Pointstage or in wgpu.
    #[error("{0}")]
    Panicked(String),
    /// Anything else.
    #[error("{0}")]
    Failed(String),
}

impl GpuError {
    /// A refusal in one sentence.
    pub fn validation(message: impl Into<String>) -> Self {
        Self::Validation {
            message: message.into(),
            detail: String::new(),
        }
    }

    /// The code by which plugins tell errors apart.
    pub fn code(&self) -> ErrorCode {
        match self {
            Self::Validation { .. } => ErrorCode::VALIDATION,
            Self::BadHandle(_) => ErrorCode::BAD_HANDLE,
            Self::OutOfMemory(_) => ErrorCode::OUT_OF_MEMORY,
            Self::Unsupported(_) => ErrorCode::UNSUPPORTED,
            Self::DeviceLost(_) => ErrorCode::DEVICE_LOST,
            Self::Panicked(_) => ErrorCode::PANICKED,
            Self::Failed(_) => ErrorCode::FAILED,
        }
    }

    /// The long form, or nothing.
    pub fn detail(&self) -> &str {
        match self {
            Self::Validation { detail, .. } => detail,
            _ => "",
        }
    }

    /// The same error with the place before its message: `place: message`.
    #[must_use]
    pub fn at(mut self, place: impl std::fmt::Display) -> Self {
        match &mut self {
            Self::Validation { message, .. } => *message = format!("{place}: {message}"),
            // The whole device is at fault, not the place.
            Self::DeviceLost(_) => {}
            Self::BadHandle(text)
            | Self::OutOfMemory(text)
            | Self::Unsupported(text)
            | Self::Panicked(text)
            | Self::Failed(text) => *text = format!("{place}: {text}"),
        }
        self
    }

    pub(super) fn from_wgpu(error: &wgpu::Error) -> Self {
        match error {
            wgpu::Error::OutOfMemory { source } => Self::OutOfMemory(format!(
                "the device's memory is used up ({source}); close other programs, or load less"
            )),
            wgpu::Error::Validation { description, .. } => Self::Validation {
                message: in_one_line(description),
                detail: description.clone(),
            },
            wgpu::Error::Internal { description, .. } => Self::Failed(format!(
                "the graphics driver failed: {}",
                in_one_line(description)
            )),
        }
    }
}

impl From<GpuError> for ErrorRecord {
    fn from(error: GpuError) -> Self {
        Self {
            code: error.code(),
            message: error.to_string().into(),
            detail: error.detail().into(),
        }
    }
}

/// wgpu's indented tree of causes as one line. Its headings ('Validation Error', 'Caused by:') say nothing.
fn in_one_line(description: &str) -> String {
    description
        .lines()
        .map(str::trim)
        .filter(|line| !line.is_empty() && !matches!(*line, "Validation Error" | "Caused by:"))
        .collect::<Vec<_>>()
        .join(": ")
}

/// The error and its causes as one line, for errors whose own text leaves the causes out.
pub(super) fn with_causes(error: &wgpu::Error) -> String {
    let mut text = in_one_line(&error.to_string());
    let mut source = error.source();
    // A validation error's text has its causes already.
    while let (Some(cause), wgpu::Error::OutOfMemory { .. }) = (source, error) {
        write!(text, ": {cause}").ok();
        source = cause.source();
    }
    text
}

/// What the scope caught. On all native interfaces the answer is there at once.
pub(super) fn popped(scope: wgpu::ErrorScopeGuard) -> Option<wgpu::Error> {
    match pin!(scope.pop()).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(error) => error,
        Poll::Pending => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tree_of_causes_becomes_one_line() {
        let description = "Validation Error\n\nCaused by:\n  In Device::create_buffer, label = 'x'\n    too big\n";
        assert_eq!(
            in_one_line(description),
            "In Device::create_buffer, label = 'x': too big"
        );
    }

    #[test]
    fn a_place_stands_before_the_message() {
        let error = GpuError::validation("no pass is open").at("command 3 (Draw)");
        assert_eq!(error.to_string(), "command 3 (Draw): no pass is open");
        assert_eq!(error.code(), ErrorCode::VALIDATION);
    }
}
