//! A first look at a file that may be a plugin: whole, with a good manifest, for this border. Runs none of its code.

use super::cache::FileKey;
use super::discover::Candidate;
use super::elf::{BrokenObject, check_whole};
use super::found_in::FoundIn;
use super::library::{self, host_api, name_of};
use super::load_error::LoadPluginError;
use super::manifest::read_manifest;
use super::verdict::Verdict;
use pointstage_plugin_api::manifest::Manifest;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// A longer file is no plugin: the largest one seen, with debug information, had 0.1 GB.
const LARGEST_FILE: u64 = 2 << 30;

/// A plugin's file, and what came of looking at it.
#[derive(Clone, Debug, PartialEq)]
pub struct PluginFile {
    /// The file.
    pub path: PathBuf,
    /// Named by the user, not found in a folder.
    pub named: bool,
    /// Where it was found.
    pub found_in: FoundIn,
    /// Length, bytes.
    pub size: u64,
    /// Time of change.
    pub modified: Option<SystemTime>,
    /// Hash of the content, hexadecimal; empty if it cannot be read.
    pub hash: String,
    /// What it says of itself, if that is readable.
    pub manifest: Option<Manifest>,
    /// Border version: of the loaded library, or what the manifest asks for.
    pub api: Option<String>,
    /// Whether it may be used.
    pub verdict: Verdict,
    /// Whether the verdict is of an earlier session.
    pub from_cache: bool,
    /// How long the examination in a child took; zero if an earlier session did it.
    pub examination_time: Duration,
}

impl PluginFile {
    /// Whether it says that it holds the plugin `id`.
    pub fn has(&self, id: &str) -> bool {
        let mut plugins = self.manifest.iter().flat_map(|manifest| &manifest.plugins);
        plugins.any(|plugin| plugin.id == id)
    }

    /// How long loading it into this process took; none if it was not loaded yet. Once loaded it stays, also when nothing
    /// of it is in use.
    pub fn load_time(&self) -> Option<Duration> {
        library::load_time_of(&self.hash)
    }

    /// What a verdict on it holds for.
    pub(super) fn key(&self, host: &str) -> FileKey {
        FileKey {
            path: self.path.clone(),
            size: self.size,
            modified_ns: nanoseconds(self.modified),
            hash: self.hash.clone(),
            host: host.to_owned(),
        }
    }
}

/// The file, with a verdict as far as it can be known without loading it; none if it is a library of somebody else.
pub(super) fn look_at(candidate: &Candidate) -> Option<PluginFile> {
    let Candidate { path, found_in } = candidate;
    let named = *found_in == FoundIn::Named;
    let metadata = std::fs::metadata(path).ok();
    let mut file = PluginFile {
        path: path.clone(),
        named,
        found_in: found_in.clone(),
        size: metadata.as_ref().map_or(0, std::fs::Metadata::len),
        modified: metadata.and_then(|metadata| metadata.modified().ok()),
        hash: String::new(),
        manifest: None,
        api: None,
        verdict: Verdict::ok(),
        from_cache: false,
        examination_time: Duration::ZERO,
    };
    let name = name_of(path);
    match examine(&mut file, &name) {
        Ok(()) => Some(file),
        // In a folder, a good library without a manifest is somebody else's; so is one for another system.
        Err(
            LoadPluginError::NoManifest { .. }
            | LoadPluginError::Broken {
                source: BrokenObject::Foreign { .. },
                ..
            },
        ) if !named => {
            tracing::debug!("{}: no plugin", path.display());
            None
        }
        Err(error) => {
            file.verdict = Verdict::rejected(error.to_string()).with_detail(error.detail());
            Some(file)
        }
    }
}

fn examine(file: &mut PluginFile, name: &str) -> Result<(), LoadPluginError> {
    let name = || name.to_owned();
    if file.size > LARGEST_FILE {
        let source = std::io::Error::other("the file is too large for a plugin");
        return Err(LoadPluginError::Read {
            file: name(),
            source,
        });
    }
    let data = std::fs::read(&file.path).map_err(|source| LoadPluginError::Read {
        file: name(),
        source,
    })?;
    file.hash = blake3::hash(&data).to_hex().to_string();
    check_whole(&data).map_err(|source| LoadPluginError::Broken {
        file: name(),
        source,
    })?;
    let manifest = read_manifest(&data)
        .ok_or_else(|| LoadPluginError::NoManifest { file: name() })?
        .map_err(|source| LoadPluginError::Manifest {
            file: name(),
            source: Box::new(source),
        })?;
    let api = manifest.api;
    file.api = Some(api.to_string());
    file.manifest = Some(manifest);
    let ours = host_api();
    let our_major: Option<u32> = ours.split('.').next().and_then(|major| major.parse().ok());
    if our_major == Some(api.major) {
        return Ok(());
    }
    Err(LoadPluginError::Incompatible {
        file: name(),
        found: api.to_string(),
        ours,
        advice: if our_major < Some(api.major) {
            "update the program"
        } else {
            "build the plugin again with this program's plugin-api"
        },
        detail: String::new(),
    })
}

/// Names a build of the program: its version, and size and time of its file.
pub(super) fn host_build(program: &Path) -> String {
    let metadata = std::fs::metadata(program).ok();
    let size = metadata.as_ref().map_or(0, std::fs::Metadata::len);
    let modified = nanoseconds(metadata.and_then(|metadata| metadata.modified().ok()));
    format!("{} {size} {modified}", env!("CARGO_PKG_VERSION"))
}

fn nanoseconds(time: Option<SystemTime>) -> u64 {
    let since = time
        .and_then(|time| time.duration_since(UNIX_EPOCH).ok())
        .unwrap_or_default();
    u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)
}
