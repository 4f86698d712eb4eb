//! Loaders that are plugins, as the scene knows loaders.

use super::instance::HostInstance;
use super::journal::Act;
use super::loader_sink::{JobCall, Sink};
use super::registry::{PluginInfo, Registry};
use crate::stage::setting_records;
use abi_stable::std_types::{RSlice, RStr};
use pointstage_plugin_api::abi::{FileStartRecord, LoadRecord, LoaderBox, LogLevel};
use pointstage_plugin_api::loading::{Claim, FileStart};
use pointstage_plugin_api::settings_schema::snapshot;
use pointstage_plugin_api::{Error, ErrorCode};
use pointstage_scene::{
    Contents, FormatError, Job, LoadOptions, LoadStop, Loader, LoaderInfo, SourceFile,
};
use std::sync::{Arc, OnceLock};

/// The registry's loaders, for [`pointstage_scene::Loaders::with_others`]. Their libraries are loaded when the first file
/// is looked at.
pub fn loaders(registry: &Arc<Registry>) -> Vec<Arc<dyn Loader>> {
    let adapt = |info: Arc<PluginInfo>| -> Arc<dyn Loader> {
        let registry = Arc::clone(registry);
        Arc::new(PluginLoader::new(info, registry, OnceLock::new()))
    };
    registry.loaders().into_iter().map(adapt).collect()
}

fn names_of(info: &PluginInfo) -> LoaderInfo {
    LoaderInfo {
        id: info.id.clone(),
        alias: info.entry.alias.clone(),
        title: info.entry.title.clone(),
        extensions: info.entry.extensions.clone(),
        settings: info.entry.settings.clone(),
    }
}

/// A loader of a plugin.
pub(super) struct PluginLoader {
    names: LoaderInfo,
    info: Arc<PluginInfo>,
    registry: Arc<Registry>,
    /// The plugin's side; why there is none was said in the log.
    object: OnceLock<Result<LoaderBox, Error>>,
}

impl std::fmt::Debug for PluginLoader {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("PluginLoader").field(&self.names.id).finish()
    }
}

impl PluginLoader {
    /// The loader of `info`; `object` is the plugin's side if it is there already.
    pub(super) fn new(
        info: Arc<PluginInfo>,
        registry: Arc<Registry>,
        object: OnceLock<Result<LoaderBox, Error>>,
    ) -> Self {
        Self {
            names: names_of(&info),
            info,
            registry,
            object,
        }
    }

    fn object(&self) -> Result<&LoaderBox, Error> {
        let made = self.object.get_or_init(|| {
            let factory = self.registry.load(&self.info);
            let object = factory
                .map_err(|error| Error::failed(error.to_string()))
                .and_then(|factory| factory.object().loader().into_result().map_err(Error::from));
            if let Err(error) = &object {
                self.log(&error.message);
            }
            object
        });
        made.as_ref().map_err(Clone::clone)
    }

    fn log(&self, text: &str) {
        let log = self.registry.log();
        log.add(&self.info.id, LogLevel::WARN, text);
    }

    fn read(
        &self,
        file: &SourceFile,
        options: &LoadOptions,
        job: &Job,
    ) -> Result<Contents, LoadStop> {
        let object = self.object().map_err(format_error)?;
        let values = snapshot(&self.info.entry.settings, options.loader_values())?;
        let settings = setting_records(&values);
        let Some(path) = file.path().to_str() else {
            let text = "the path is not Unicode, which plugins cannot take; rename the file";
            return Err(FormatError::new(text).into());
        };
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let (sink, call) = (Sink::of(job, file), JobCall::new(job));
        job.set_stage("reading the file");
        let watch = self.registry.watch(&self.info, Act::ReadFile);
        let outcome = object.load(&LoadRecord {
            host: HostInstance::border(&self.info, None, threads, self.registry.log()),
            path: RStr::from_str(path),
            bytes: RSlice::from_slice(file.bytes()),
            settings: RSlice::from_slice(&settings),
            sink: sink.border(),
            call: call.border(),
        });
        drop(watch);
        if job.is_cancelled() {
            return Err(LoadStop::Cancelled);
        }
        outcome.into_result().map_err(|record| {
            let error = Error::from(record);
            if error.code == ErrorCode::CANCELLED {
                return LoadStop::Cancelled;
            }
            format_error(error)
        })?;
        // A plugin may go on as if nothing had been refused.
        let builder = sink.into_builder().map_err(|problem| {
            let text = format!(
                "the loader '{}' broke its own rules: {problem}; tell its author",
                self.names.id
            );
            LoadStop::from(FormatError::new(text))
        })?;
        file.release();
        builder.finish(options, job)
    }
}

fn format_error(error: Error) -> LoadStop {
    FormatError::new(error.message).into()
}

impl Loader for PluginLoader {
    fn info(&self) -> &LoaderInfo {
        &self.names
    }

    fn claims(&self, start: &FileStart<'_>) -> Claim {
        let Ok(object) = self.object() else {
            return Claim::No;
        };
        let watch = self.registry.watch(&self.info, Act::ReadFile);
        let claim = object.claims(&FileStartRecord {
            bytes: RSlice::from_slice(start.bytes),
            name: RStr::from_str(start.name),
            length: start.length,
        });
        drop(watch);
        match claim.into_result() {
            Ok(level) => Claim::from_level(level),
            Err(record) => {
                self.log(record.message.as_str());
                Claim::No
            }
        }
    }

    fn load(
        &self,
        file: &SourceFile,
        options: &LoadOptions,
        job: &Job,
    ) -> Result<Contents, LoadStop> {
        self.read(file, options, job)
    }
}
