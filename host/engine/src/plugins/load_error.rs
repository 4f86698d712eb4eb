//! Why a plugin's library cannot be used.

use super::elf::BrokenObject;
use pointstage_plugin_api::manifest::ManifestError;

/// Why a library cannot be used. The message is one sentence; [`LoadPluginError::detail`] has the long form.
#[derive(Debug, thiserror::Error)]
pub enum LoadPluginError {
    /// The file cannot be read.
    #[error("{file}: cannot be read: {source}")]
    Read {
        /// Name of the file.
        file: String,
        /// Why.
        #[source]
        source: std::io::Error,
    },
    /// The file is no whole library.
    #[error("{file}: {source}")]
    Broken {
        /// Name of the file.
        file: String,
        /// What is wrong.
        #[source]
        source: BrokenObject,
    },
    /// It is a library, but none of ours.
    #[error("{file}: the library has no Pointstage manifest; is it a plugin, made with `export!`?")]
    NoManifest {
        /// Name of the file.
        file: String,
    },
    /// The manifest is faulty.
    #[error("{file}: {source}")]
    Manifest {
        /// Name of the file.
        file: String,
        /// What is wrong.
        #[source]
        source: Box<ManifestError>,
    },
    /// The file is not the one that was checked.
    #[error("{file}: the file has changed since it was checked; look for plugins again")]
    Changed {
        /// Name of the file.
        file: String,
    },
    /// First contact found it unfit.
    #[error("{message}")]
    Refused {
        /// The verdict's message.
        message: String,
        /// The verdict's long form.
        detail: String,
    },
    /// No copy can be made.
    #[error("{file}: cannot be copied to the folder for temporary files: {source}")]
    Copy {
        /// Name of the file.
        file: String,
        /// Why.
        #[source]
        source: std::io::Error,
    },
    /// The system's loader refuses it.
    #[error("{file}: the system cannot load the library: {reason}")]
    Open {
        /// Name of the file.
        file: String,
        /// The loader's message.
        reason: String,
    },
    /// The plugin's entry symbol is missing.
    #[error("{file}: the library does not export a plugin; build it with `export!` as a cdylib")]
    NoHeader {
        /// Name of the file.
        file: String,
    },
    /// Built against another border.
    #[error("{file}: built for plugin interface {found}, this program has {ours}; {advice}")]
    Incompatible {
        /// Name of the file.
        file: String,
        /// The plugin's version of the border.
        found: String,
        /// The program's.
        ours: String,
        /// What to do.
        advice: &'static str,
        /// The layout check's report.
        detail: String,
    },
    /// The root module or the factories cannot be made.
    #[error("{file}: the plugin failed at its start: {reason}")]
    Start {
        /// Name of the file.
        file: String,
        /// What it said.
        reason: String,
    },
    /// The manifest promises what the library does not make.
    #[error("{file}: the manifest lists the {kind} '{id}', but the library does not make it")]
    NoFactory {
        /// Name of the file.
        file: String,
        /// Kind in the manifest.
        kind: String,
        /// Id in the manifest.
        id: String,
    },
}

impl LoadPluginError {
    /// The long form, for folding away; may be empty.
    pub fn detail(&self) -> &str {
        match self {
            Self::Incompatible { detail, .. } | Self::Refused { detail, .. } => detail,
            _ => "",
        }
    }
}
