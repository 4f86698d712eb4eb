//! How a stage is opened, and what can go wrong.

use crate::device::{DeviceOptions, GpuError};
use crate::frame::compose::ComposeError;
use crate::plugins::{DiscoverOptions, LoadPluginError, UnknownPlugin};
use pointstage_plugin_api::Error as PluginError;
use pointstage_plugin_api::settings_schema::ValueError;
use std::time::Duration;

/// How a stage is opened.
#[derive(Clone, Debug)]
pub struct StageOptions {
    /// Which device.
    pub device: DeviceOptions,
    /// Whether to open one at all: without, CPU renderers and the fallback draw.
    pub use_device: bool,
    /// Where plugins are looked for.
    pub plugins: DiscoverOptions,
    /// How long [`Patience::Wait`](super::Patience::Wait) waits for a preparation.
    pub prepare_limit: Duration,
    /// Bytes that one plugin may hold on the device.
    pub plugin_quota_bytes: u64,
    /// Threads that a plugin may keep busy; 0 for all.
    pub thread_count: usize,
}

impl Default for StageOptions {
    fn default() -> Self {
        Self {
            device: DeviceOptions::default(),
            use_device: true,
            plugins: DiscoverOptions::default(),
            prepare_limit: Duration::from_mins(10),
            plugin_quota_bytes: 4 << 30,
            thread_count: 0,
        }
    }
}

/// Why a stage cannot be opened.
#[derive(Debug, thiserror::Error)]
pub enum StageError {
    /// The device was there, but what the engine itself needs could not be made on it.
    #[error("the graphics device cannot hold what Pointstage needs: {0}")]
    Device(#[from] GpuError),
}

/// Why a frame has no picture.
#[derive(Debug, thiserror::Error)]
pub enum FrameError {
    /// No plugin of this name.
    #[error(transparent)]
    UnknownPlugin(#[from] UnknownPlugin),
    /// The library does not load.
    #[error(transparent)]
    Load(#[from] LoadPluginError),
    /// The scene or the device does not have what the renderer needs.
    #[error("renderer '{renderer}' cannot draw this: {reason}")]
    Unsuitable {
        /// Its id.
        renderer: String,
        /// What is missing.
        reason: String,
    },
    /// A setting's value does not fit.
    #[error(transparent)]
    Setting(#[from] ValueError),
    /// The plugin failed.
    #[error("{plugin}: {source}")]
    Plugin {
        /// Its id.
        plugin: String,
        /// What it said.
        source: PluginError,
    },
    /// The device failed.
    #[error(transparent)]
    Device(#[from] GpuError),
    /// The composition failed.
    #[error(transparent)]
    Compose(#[from] ComposeError),
    /// The picture has no pixels, or more than the device can hold.
    #[error("a picture of {width}×{height} pixels: {what}")]
    Size {
        /// px.
        width: u32,
        /// px.
        height: u32,
        /// What is wrong with it, and what to do.
        what: String,
    },
    /// What is to be shown is not a target of the renderer.
    #[error("renderer '{renderer}' gives no target '{key}'; it gives {given}")]
    NoTarget {
        /// Its id.
        renderer: String,
        /// The key.
        key: String,
        /// Keys that it gives.
        given: String,
    },
}

impl FrameError {
    /// Whether it is this plugin's.
    pub(super) fn is_of(&self, id: &str) -> bool {
        matches!(self, Self::Plugin { plugin, .. } if plugin == id)
    }

    /// The long form; may be empty.
    pub fn detail(&self) -> &str {
        match self {
            Self::Plugin { source, .. } => &source.detail,
            Self::Device(error) => error.detail(),
            _ => "",
        }
    }
}
