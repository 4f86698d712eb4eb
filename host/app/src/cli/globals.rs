//! Options that every command takes: where to draw, which plugins, where state lives.

use std::path::PathBuf;

use clap::{ArgAction, Args, ValueEnum};
use pointstage_engine::device::{Backend, DeviceOptions};
use pointstage_engine::plugins::{DiscoverOptions, standard_state_folder};
use pointstage_engine::stage::StageOptions;

use crate::preferences::plugin_folders;

/// Options of every command.
#[derive(Clone, Debug, Args)]
pub(crate) struct Globals {
    /// Graphics interface to draw with [default: the best there is]
    #[arg(long, global = true, value_name = "NAME", help_heading = "Device")]
    pub(crate) backend: Option<BackendName>,
    /// Adapter to draw with: a part of its name, or its number
    #[arg(long, global = true, value_name = "NAME|N", help_heading = "Device")]
    pub(crate) adapter: Option<String>,
    /// Use no graphics device at all; renderers that run on the CPU draw
    #[arg(long, global = true, conflicts_with_all = ["backend", "adapter"], help_heading = "Device")]
    pub(crate) no_device: bool,
    /// A plugin's library, beside those found in the plugin folders; may be given several times
    #[arg(
        long = "plugin",
        global = true,
        value_name = "FILE",
        help_heading = "Plugins"
    )]
    pub(crate) plugins: Vec<PathBuf>,
    /// Folder for caches, quarantine and the window's layout [default: the user's state folder]
    #[arg(long, global = true, value_name = "DIR", help_heading = "Plugins")]
    pub(crate) state_folder: Option<PathBuf>,
    /// Say what happens on standard error; twice for every act
    #[arg(short, long, global = true, action = ArgAction::Count)]
    pub(crate) verbose: u8,
}

/// A graphics interface's name on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum BackendName {
    /// Vulkan
    Vulkan,
    /// Direct3D 12 (Windows)
    Dx12,
    /// Metal (macOS)
    Metal,
    /// OpenGL 4.3 or OpenGL ES 3.1, for graphics cards without Vulkan
    Gl,
}

impl BackendName {
    fn backend(self) -> Backend {
        match self {
            Self::Vulkan => Backend::Vulkan,
            Self::Dx12 => Backend::Dx12,
            Self::Metal => Backend::Metal,
            Self::Gl => Backend::Gl,
        }
    }
}

impl Globals {
    /// How to make the stage.
    pub(crate) fn stage_options(&self) -> StageOptions {
        StageOptions {
            device: DeviceOptions {
                backend: self.backend.map(BackendName::backend),
                adapter: self.adapter.clone(),
            },
            use_device: !self.no_device,
            plugins: self.discover_options(),
            ..StageOptions::default()
        }
    }

    /// Where to look for plugins: the usual places, the folders that the user added in the window, and the files named.
    pub(crate) fn discover_options(&self) -> DiscoverOptions {
        let state_folder = self.state_folder();
        let mut options = DiscoverOptions {
            files: self.plugins.clone(),
            ..DiscoverOptions::standard()
        };
        options.folders.extend(plugin_folders(&state_folder));
        options.state_folder = Some(state_folder);
        options
    }

    /// Where caches, quarantine and the window's layout are kept.
    pub(crate) fn state_folder(&self) -> PathBuf {
        self.state_folder
            .clone()
            .unwrap_or_else(standard_state_folder)
    }

    /// The interface that the window's toolkit draws with, if one was named.
    pub(crate) fn toolkit_backends(&self) -> Option<wgpu::Backends> {
        Some(match self.backend? {
            BackendName::Vulkan => wgpu::Backends::VULKAN,
            BackendName::Dx12 => wgpu::Backends::DX12,
            BackendName::Metal => wgpu::Backends::METAL,
            BackendName::Gl => wgpu::Backends::GL,
        })
    }
}
