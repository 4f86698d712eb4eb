//! The plugins of a session: every file with its verdict, every renderer, structure and loader by its names.

use super::cache::{FileKey, TrialKey, VerdictCache};
use super::child::TrialRequest;
use super::discover::{Candidate, DiscoverOptions, candidates};
use super::examine::{PluginFile, host_build, look_at};
use super::journal::{Act, Culprit, Journal, Watch};
use super::library::{self, Factory, LoadedLibrary};
use super::load_error::LoadPluginError;
use super::log_book::LogBook;
use super::names::{UnknownPlugin, find};
use super::probe::{Examination, check_file, try_plugin};
use super::verdict::{Verdict, VerdictClass};
use pointstage_plugin_api::manifest::{Needs, PluginEntry};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// One renderer, structure or loader that may be used.
#[derive(Clone, Debug, PartialEq)]
pub struct PluginInfo {
    /// Reverse-domain id.
    pub id: String,
    /// Its entry of the manifest: names, needs, gives, settings.
    pub entry: PluginEntry,
    /// Its library.
    pub path: PathBuf,
    /// Content hash of the library, hexadecimal.
    pub hash: String,
}

/// The plugins found.
#[derive(Debug)]
pub struct Registry {
    files: Vec<PluginFile>,
    renderers: Vec<Arc<PluginInfo>>,
    structures: Vec<Arc<PluginInfo>>,
    loaders: Vec<Arc<PluginInfo>>,
    options: DiscoverOptions,
    cache: Mutex<VerdictCache>,
    /// Outcomes of control runs, by adapter.
    controls: Mutex<BTreeMap<String, Verdict>>,
    journal: Arc<Journal>,
    culprits: Vec<Culprit>,
    log: Arc<LogBook>,
}

/// A folder that cannot be searched for plugins.
#[derive(Debug, thiserror::Error)]
#[error("{}: plugins cannot be looked for here: {source}; choose a folder that exists and may be read", path.display())]
pub struct PluginFolderError {
    /// The folder.
    pub path: PathBuf,
    /// What the system says.
    #[source]
    pub source: std::io::Error,
}

impl Registry {
    /// Looks for plugins and examines what is new or changed. Never fails: what is wrong with a file is its verdict.
    pub fn discover(options: &DiscoverOptions) -> Self {
        let (journal, culprits) = options
            .state_folder
            .as_deref()
            .map(Journal::open)
            .unwrap_or_default();
        let cache = VerdictCache::open(options.state_folder.as_deref());
        Self::with_cache(options, cache, journal, culprits)
    }

    /// The same again, within the same session: what plugins log goes on in the same book.
    #[must_use]
    pub fn discover_again(&self, options: &DiscoverOptions) -> Self {
        let cache = match options.state_folder.as_deref() {
            // Another session may have learnt something.
            Some(folder) => VerdictCache::open(Some(folder)),
            None => self.lock_cache().clone(),
        };
        // The culprits were blamed when the session began; by now the user may have let them try again.
        let journal = Arc::clone(&self.journal);
        let registry = Self::with_cache(options, cache, journal, Vec::new());
        let controls = self.controls.lock().unwrap_or_else(PoisonError::into_inner);
        Self {
            controls: Mutex::new(controls.clone()),
            culprits: self.culprits.clone(),
            log: self.log(),
            ..registry
        }
    }

    fn with_cache(
        options: &DiscoverOptions,
        mut cache: VerdictCache,
        journal: Arc<Journal>,
        culprits: Vec<Culprit>,
    ) -> Self {
        let mut files = examine_all(options, &mut cache, &culprits);
        cache.save();
        // A copy of a library that was found before adds nothing but doubt about which one is meant.
        let mut seen = std::collections::BTreeSet::new();
        files.retain(|file| file.named || file.hash.is_empty() || seen.insert(file.hash.clone()));
        let (mut renderers, structures) = (list(&files, "renderer"), list(&files, "structure"));
        let loaders = list(&files, "loader");
        renderers.sort_by_key(|info| {
            let is_named = files
                .iter()
                .any(|file| file.named && file.path == info.path);
            (
                !is_named,
                demands(&info.entry.needs),
                info.entry.gives.progressive,
            )
        });
        Self {
            files,
            renderers,
            structures,
            loaders,
            options: options.clone(),
            cache: Mutex::new(cache),
            controls: Mutex::default(),
            journal,
            culprits,
            log: Arc::default(),
        }
    }

    /// Every file that is a plugin, or was named as one, with its verdict.
    pub fn files(&self) -> &[PluginFile] {
        &self.files
    }

    /// The renderers that may be used: those of named files first, then from what needs least of a scene to what needs most,
    /// of equals those that refine last, else in the order of the folders.
    pub fn renderers(&self) -> Vec<Arc<PluginInfo>> {
        self.renderers.clone()
    }

    /// The structures that may be used.
    pub fn structures(&self) -> Vec<Arc<PluginInfo>> {
        self.structures.clone()
    }

    /// The loaders that may be used, in the order of the folders.
    pub fn loaders(&self) -> Vec<Arc<PluginInfo>> {
        self.loaders.clone()
    }

    /// The renderer of this id, alias, `id@version` or `id#hash`.
    pub fn find_renderer(&self, key: &str) -> Result<Arc<PluginInfo>, UnknownPlugin> {
        find("renderer", key, &self.renderers, &self.files)
    }

    /// The structure of this id, alias, `id@version` or `id#hash`.
    pub fn find_structure(&self, key: &str) -> Result<Arc<PluginInfo>, UnknownPlugin> {
        find("structure", key, &self.structures, &self.files)
    }

    /// What plugins log.
    pub fn log(&self) -> Arc<LogBook> {
        Arc::clone(&self.log)
    }

    /// Plugins in whose acts earlier sessions ended; they are quarantined.
    pub fn culprits(&self) -> &[Culprit] {
        &self.culprits
    }

    /// Notes in the crash journal that `info` is about to act, until the returned value is dropped.
    pub fn watch(&self, info: &PluginInfo, act: Act) -> Watch {
        let PluginInfo { id, path, hash, .. } = info;
        self.journal.begin(Culprit {
            plugin: id.clone(),
            file: path.clone(),
            hash: hash.clone(),
            act,
        })
    }

    /// Loads a plugin; its library once per content.
    pub fn load(&self, info: &PluginInfo) -> Result<Arc<Factory>, LoadPluginError> {
        let file = library::name_of(&info.path);
        let verdict = self.files.iter().find(|file| file.path == info.path);
        if let Some(verdict) = verdict
            .map(|file| &file.verdict)
            .filter(|verdict| !verdict.is_usable())
        {
            let (message, detail) = (verdict.message.clone(), verdict.detail.clone());
            return Err(LoadPluginError::Refused { message, detail });
        }
        let data = std::fs::read(&info.path).map_err(|source| LoadPluginError::Read {
            file: file.clone(),
            source,
        })?;
        if blake3::hash(&data).to_hex().as_str() != info.hash {
            return Err(LoadPluginError::Changed { file });
        }
        let watch = self.watch(info, Act::Load);
        let library: Arc<LoadedLibrary> = library::load(&data, &info.path)?;
        drop(watch);
        let (kind, id) = (info.entry.kind.clone(), info.id.clone());
        match library.factory_index(&kind, &id) {
            Some(index) => Ok(Arc::new(Factory::new(library, index))),
            None => Err(LoadPluginError::NoFactory { file, kind, id }),
        }
    }

    /// Tries `info` on the session's device in a child process, unless that is known already. `adapter` names adapter
    /// and driver. Without a child program nothing is tried, and the plugin counts as good.
    pub fn try_out(&self, info: &PluginInfo, request: &TrialRequest, adapter: &str) -> Verdict {
        let Examination::Child(program) = &self.options.examination else {
            return Verdict::ok();
        };
        let key = TrialKey {
            hash: info.hash.clone(),
            plugin: info.id.clone(),
            host: host_build(&program.program),
            adapter: adapter.to_owned(),
        };
        let known = self.lock_cache().trial(&key).cloned();
        if let Some(verdict) = known {
            return verdict;
        }
        let request = TrialRequest {
            plugin: Some((info.path.clone(), info.id.clone())),
            ..request.clone()
        };
        let mut controls = self.controls.lock().unwrap_or_else(PoisonError::into_inner);
        let mut control = controls.remove(adapter);
        let verdict = try_plugin(program, &request, &mut control);
        controls.extend(control.map(|control| (adapter.to_owned(), control)));
        drop(controls);
        if verdict.class != VerdictClass::NotExamined {
            let mut cache = self.lock_cache();
            cache.set_trial(key, verdict.clone());
            cache.save();
        }
        verdict
    }

    /// Forgets what is known of a file, so that the next [`Registry::discover`] examines it again.
    pub fn retry(&self, path: &Path) {
        let mut cache = self.lock_cache();
        for file in self.files.iter().filter(|file| file.path == path) {
            cache.forget(&file.hash);
        }
        cache.save();
    }

    /// Sets a file aside: from the next [`Registry::discover`] on it is not loaded, in this session and later ones, until
    /// [`Registry::retry`]. Whether there is such a file.
    pub fn set_aside(&self, path: &Path) -> bool {
        let Some(file) = self.files.iter().find(|file| file.path == path) else {
            return false;
        };
        let host = host_of(&self.options);
        let mut cache = self.lock_cache();
        cache.set_file(
            file.key(&host),
            Verdict::set_aside(&library::name_of(&file.path)),
        );
        cache.save();
        true
    }

    fn lock_cache(&self) -> std::sync::MutexGuard<'_, VerdictCache> {
        self.cache.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Looks at every candidate; those that need a child get one at the same time, a few at once.
fn examine_all(
    options: &DiscoverOptions,
    cache: &mut VerdictCache,
    culprits: &[Culprit],
) -> Vec<PluginFile> {
    /// Children at once: enough to hide one that hangs.
    const AT_ONCE: usize = 4;
    let host = host_of(options);
    let found = candidates(options);
    let mut files: Vec<PluginFile> = found
        .iter()
        .filter_map(|candidate: &Candidate| look_at(candidate))
        .collect();
    for file in &mut files {
        if let Some(culprit) = culprits.iter().find(|culprit| culprit.hash == file.hash) {
            let message = format!(
                "{}: {culprit}; it is not loaded",
                library::name_of(&file.path)
            );
            let crashed = Verdict::new(VerdictClass::Crashed, message);
            cache.set_file(file.key(&host), crashed);
        }
    }
    for file in &mut files {
        if cache.is_set_aside(&file.hash) {
            file.verdict = Verdict::set_aside(&library::name_of(&file.path));
            file.from_cache = true;
        }
    }
    let Examination::Child(program) = &options.examination else {
        return files;
    };
    let mut due: Vec<(&mut PluginFile, FileKey)> = Vec::new();
    for file in files.iter_mut().filter(|file| file.verdict.is_usable()) {
        let key = file.key(&host);
        match cache.file(&key) {
            Some(known) => {
                file.verdict = known.clone();
                file.from_cache = true;
            }
            None => due.push((file, key)),
        }
    }
    for some in due.chunks_mut(AT_ONCE) {
        std::thread::scope(|scope| {
            for (file, _) in some.iter_mut() {
                scope.spawn(move || {
                    let examined = check_file(program, &file.path);
                    (file.verdict, file.examination_time) = (examined.verdict, examined.time);
                    file.api = examined.api.or(file.api.take());
                });
            }
        });
    }
    for (file, key) in due {
        if file.verdict.class != VerdictClass::NotExamined {
            cache.set_file(key, file.verdict.clone());
        }
    }
    files
}

/// The build of the program that examines.
fn host_of(options: &DiscoverOptions) -> String {
    match &options.examination {
        Examination::Child(child) => host_build(&child.program),
        Examination::ManifestOnly => String::new(),
    }
}

/// The usable plugins of one kind.
fn list(files: &[PluginFile], kind: &str) -> Vec<Arc<PluginInfo>> {
    let usable = files.iter().filter(|file| file.verdict.is_usable());
    let entries = usable.flat_map(|file| {
        let entries = file.manifest.iter().flat_map(|manifest| &manifest.plugins);
        entries
            .filter(|entry| entry.kind == kind)
            .map(move |entry| {
                Arc::new(PluginInfo {
                    id: entry.id.clone(),
                    entry: entry.clone(),
                    path: file.path.clone(),
                    hash: file.hash.clone(),
                })
            })
    });
    entries.collect()
}

/// How many things of a scene a renderer cannot do without.
fn demands(needs: &Needs) -> usize {
    let columns = [
        needs.normals,
        needs.radii,
        needs.axes,
        needs.colours,
        needs.mesh,
    ];
    columns.into_iter().map(usize::from).sum::<usize>() + needs.columns.len()
}

#[cfg(test)]
#[path = "registry_tests.rs"]
pub(crate) mod tests;
