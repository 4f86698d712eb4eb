//! Loads a plugin library: the only unsafe code of the engine.
//!
//! The rules, each of which has a crash behind it:
//!
//! * A copy under a name that was never used before is opened. The system's loader returns the old library for a name
//!   that it knows, and overwriting a mapped file ends the process.
//! * A library is never closed, not even after a failed load: threads, thread-locals and layouts of it may be in use.
//! * Layouts are compared in both directions, each with fresh globals: a plugin may be older or newer than the host.
//!   `RootModule::load_from_*` would return the first plugin again, and would refuse every older one.

#![allow(
    unsafe_code,
    reason = "a library is opened and its header and root are taken as what they were checked to be"
)]

use super::elf::check_whole;
use super::load_error::LoadPluginError;
use super::manifest::manifest_bytes;
use abi_stable::abi_stability::abi_checking::{
    CheckingGlobals, check_layout_compatibility_with_globals,
};
use abi_stable::library::{AbiHeaderRef, LibHeader, RootModule as _};
use abi_stable::type_layout::TypeLayout;
use pointstage_plugin_api::Error;
use pointstage_plugin_api::abi::{
    FactoryBox, LoaderBox, PluginRootRef, ROOT_MODULE_LOADER_NAME_WITH_NUL,
};
use pointstage_plugin_api::manifest::Manifest;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// A library that was loaded and checked. Never unloaded.
pub struct LoadedLibrary {
    factories: Vec<FactoryBox>,
    manifest: Manifest,
    api: String,
    load_time: Duration,
}

impl std::fmt::Debug for LoadedLibrary {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LoadedLibrary")
            .field("api", &self.api)
            .field("plugins", &self.manifest.plugins.len())
            .finish_non_exhaustive()
    }
}

impl LoadedLibrary {
    /// The border version that it was built with.
    pub fn api(&self) -> &str {
        &self.api
    }

    /// Its manifest.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// The factory of the manifest's entry `id` of `kind`.
    pub(super) fn factory_index(&self, kind: &str, id: &str) -> Option<usize> {
        let fits =
            |factory: &FactoryBox| factory.kind().as_str() == kind && factory.id().as_str() == id;
        self.factories.iter().position(fits)
    }

    /// Its loaders, in the order of its factories.
    pub(super) fn loaders(&self) -> impl Iterator<Item = Result<LoaderBox, Error>> {
        let factories = self.factories.iter();
        factories
            .filter(|factory| factory.kind().as_str() == "loader")
            .map(|factory| factory.loader().into_result().map_err(Error::from))
    }

    pub(super) fn factory(&self, index: usize) -> &FactoryBox {
        &self.factories[index]
    }
}

/// One plugin of a loaded library: makes renderers, structures or loaders.
#[derive(Clone, Debug)]
pub struct Factory {
    library: Arc<LoadedLibrary>,
    index: usize,
}

impl Factory {
    pub(super) fn new(library: Arc<LoadedLibrary>, index: usize) -> Self {
        Self { library, index }
    }

    /// The plugin's side of the border.
    pub fn object(&self) -> &FactoryBox {
        self.library.factory(self.index)
    }
}

/// Content hash of a library's file.
pub type ContentHash = blake3::Hash;

/// The host's version of the border.
pub fn host_api() -> String {
    PluginRootRef::VERSION_STRINGS.version.as_str().to_owned()
}

/// Loads the library whose file has the content `data`, or returns it if this content was loaded before.
///
/// Runs code of the plugin: a faulty one may end the process. `file` is for messages.
pub fn load(data: &[u8], file: &Path) -> Result<Arc<LoadedLibrary>, LoadPluginError> {
    let hash = blake3::hash(data).to_hex().to_string();
    let mut loaded = loaded();
    if let Some(library) = loaded.get(&hash) {
        return Ok(Arc::clone(library));
    }
    let library = Arc::new(load_anew(data, file)?);
    loaded.insert(hash, Arc::clone(&library));
    Ok(library)
}

/// How long loading the library of this content (hexadecimal hash) took; none if it is not loaded.
pub(super) fn load_time_of(hash: &str) -> Option<Duration> {
    loaded().get(hash).map(|library| library.load_time)
}

/// All libraries loaded so far, by the hexadecimal hash of their content.
fn loaded() -> MutexGuard<'static, BTreeMap<String, Arc<LoadedLibrary>>> {
    static LOADED: Mutex<BTreeMap<String, Arc<LoadedLibrary>>> = Mutex::new(BTreeMap::new());
    LOADED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Name of a file for messages.
pub(super) fn name_of(file: &Path) -> String {
    file.file_name()
        .unwrap_or(file.as_os_str())
        .to_string_lossy()
        .into_owned()
}

fn load_anew(data: &[u8], path: &Path) -> Result<LoadedLibrary, LoadPluginError> {
    let began = Instant::now();
    let file = name_of(path);
    check_whole(data).map_err(|source| LoadPluginError::Broken {
        file: file.clone(),
        source,
    })?;
    let bytes =
        manifest_bytes(data).ok_or_else(|| LoadPluginError::NoManifest { file: file.clone() })?;
    let manifest = Manifest::parse(bytes).map_err(|source| LoadPluginError::Manifest {
        file: file.clone(),
        source: Box::new(source),
    })?;
    let header = open(data, &file)?;
    check_layouts(header, &file)?;
    let version = header.version_strings();
    // SAFETY: `header` is the header of a library that was just checked: `check_layouts` compared the layout of its
    // root module with ours and one contains the other, so its prefix fields are those declared in `PluginRoot`. The
    // library is leaked right after opening, so everything that the root points to lives as long as the process.
    let root = unsafe { header.unchecked_layout::<PluginRootRef>() };
    let start = |reason: String| LoadPluginError::Start {
        file: file.clone(),
        reason,
    };
    let root = root.map_err(|error| start(error.to_string()))?;
    let factories = (root.factories())()
        .into_result()
        .map_err(|error| start(error.message.into_string()))?
        .into_vec();
    let library = LoadedLibrary {
        factories,
        manifest,
        api: version.version.as_str().to_owned(),
        load_time: began.elapsed(),
    };
    for plugin in &library.manifest.plugins {
        let known = matches!(plugin.kind.as_str(), "renderer" | "structure" | "loader");
        if known && library.factory_index(&plugin.kind, &plugin.id).is_none() {
            let (kind, id) = (plugin.kind.clone(), plugin.id.clone());
            return Err(LoadPluginError::NoFactory { file, kind, id });
        }
    }
    Ok(library)
}

/// Opens a fresh copy and fetches its header. The library stays open for good.
fn open(data: &[u8], file: &str) -> Result<&'static LibHeader, LoadPluginError> {
    let copy_failed = |source| LoadPluginError::Copy {
        file: file.to_owned(),
        source,
    };
    // The folder's name is new with every attempt. It goes at the end of this function; on Unix the mapping survives
    // that, on Windows the folder stays until the user's temporary files are cleaned.
    let folder = tempfile::Builder::new()
        .prefix("pointstage-plugin-")
        .tempdir()
        .map_err(copy_failed)?;
    let copy = folder.path().join(file);
    std::fs::write(&copy, data).map_err(copy_failed)?;
    let library = open_library(&copy).map_err(|error| LoadPluginError::Open {
        file: file.to_owned(),
        reason: loader_message(&error, &copy),
    })?;
    let library: &'static libloading::Library = Box::leak(Box::new(library));
    // SAFETY: the symbol's name is abi_stable's own, and its value has the type `AbiHeaderRef` in every version of
    // abi_stable; `upgrade` compares a magic string and the version behind it before anything else is read.
    let header =
        unsafe { library.get::<AbiHeaderRef>(ROOT_MODULE_LOADER_NAME_WITH_NUL.as_bytes()) };
    let header: AbiHeaderRef = *header.map_err(|_| LoadPluginError::NoHeader {
        file: file.to_owned(),
    })?;
    header
        .upgrade()
        .map_err(|error| LoadPluginError::Incompatible {
            file: file.to_owned(),
            found: "of another kind".to_owned(),
            ours: host_api(),
            advice: "build the plugin again with this program's plugin-api",
            detail: error.to_string(),
        })
}

#[cfg(unix)]
fn open_library(path: &Path) -> Result<libloading::Library, libloading::Error> {
    use libloading::os::unix::{Library, RTLD_LOCAL, RTLD_NOW};
    // SAFETY: this runs the library's initialisers, whatever they do. The file is whole (`check_whole`) and passed
    // first contact in a child process, or this is that child. RTLD_NOW finds missing symbols here, not in a frame.
    unsafe { Library::open(Some(path), RTLD_NOW | RTLD_LOCAL) }.map(Into::into)
}

#[cfg(not(unix))]
fn open_library(path: &Path) -> Result<libloading::Library, libloading::Error> {
    // SAFETY: as on Unix.
    unsafe { libloading::Library::new(path) }
}

/// The loader's own words, without the copy's path and without NUL bytes.
fn loader_message(error: &libloading::Error, copy: &Path) -> String {
    let source = std::error::Error::source(error).map(ToString::to_string);
    let text = source
        .unwrap_or_else(|| error.to_string())
        .replace('\0', "");
    text.replace(&format!("{}: ", copy.display()), "")
}

/// Compares the plugin's root module with ours: the same major version, and the layout of one within the other's.
fn check_layouts(header: &LibHeader, file: &str) -> Result<(), LoadPluginError> {
    let (found, ours) = (header.version_strings(), PluginRootRef::VERSION_STRINGS);
    let incompatible = |advice, detail| LoadPluginError::Incompatible {
        file: file.to_owned(),
        found: found.version.as_str().to_owned(),
        ours: host_api(),
        advice,
        detail,
    };
    let major = |version: &str| {
        version
            .split('.')
            .next()
            .and_then(|part| part.parse::<u32>().ok())
    };
    let (plugin_major, our_major) = (major(found.version.as_str()), major(ours.version.as_str()));
    if plugin_major != our_major {
        let advice = if plugin_major > our_major {
            "update the program"
        } else {
            "build the plugin again with this program's plugin-api"
        };
        return Err(incompatible(advice, String::new()));
    }
    let Some(plugin_layout) = header.root_mod_consts().layout().into_option() else {
        return Err(incompatible(
            "the plugin hides its layout: build it with `export!`",
            String::new(),
        ));
    };
    let our_layout = <PluginRootRef as abi_stable::StableAbi>::LAYOUT;
    let forward = compare(our_layout, plugin_layout);
    let Err(first) = forward else { return Ok(()) };
    if compare(plugin_layout, our_layout).is_ok() {
        return Ok(());
    }
    Err(incompatible(
        "the two differ in layout although both call themselves the same: build the plugin again with this \
         program's plugin-api",
        first,
    ))
}

/// Fresh globals: with the process's own the outcome would depend on which plugin was loaded first.
fn compare(
    interface: &'static TypeLayout,
    implementation: &'static TypeLayout,
) -> Result<(), String> {
    check_layout_compatibility_with_globals(interface, implementation, &CheckingGlobals::new())
        .map_err(|errors| {
            // The full text is up to 60 kB; the first few places say enough.
            let places = errors.errors.iter().take(4).map(|error| {
                let place = error
                    .stack_trace
                    .last()
                    .map_or_else(|| "root".to_owned(), |field| field.found.to_string());
                let kinds: Vec<String> = error
                    .errs
                    .iter()
                    .take(3)
                    .map(|kind| first_word(&format!("{kind:?}")))
                    .collect();
                format!("{} at {place}", kinds.join(", "))
            });
            places.collect::<Vec<_>>().join("\n")
        })
}

fn first_word(text: &str) -> String {
    text.chars()
        .take_while(char::is_ascii_alphanumeric)
        .collect()
}
