//! The child's side of an examination: the program itself, started with a hidden first argument.
//!
//! `program __examine-plugin check FILE` loads a library and checks it; `program __examine-plugin try REQUEST` draws a
//! frame. The answer is one line on standard output, marked, so that what a plugin prints itself does not matter.

use super::discover::DiscoverOptions;
use super::library;
use super::load_error::LoadPluginError;
use super::verdict::{Verdict, VerdictClass};
use crate::device::{Backend, DeviceOptions};
use crate::stage::{self, StageOptions};
use abi_stable::std_types::{RSlice, RStr};
use pointstage_plugin_api::Error;
use pointstage_plugin_api::abi::FileStartRecord;
use pointstage_plugin_api::loading::START_BYTES;
use serde::{Deserialize, Serialize};
use std::ffi::OsString;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::str::FromStr as _;

/// First argument of the program as an examining child.
pub(super) const HIDDEN_COMMAND: &str = "__examine-plugin";
/// Starts the answer's line.
pub(super) const ANSWER_MARK: &str = "pointstage-verdict ";

/// What a trial draws with.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TrialRequest {
    /// Name of the graphics interface; none for the default.
    pub backend: Option<String>,
    /// Part of the adapter's name, or its number.
    pub adapter: Option<String>,
    /// Whether the session has a device at all.
    pub use_device: bool,
    /// Library and id of the plugin; none for the control run, which draws without any.
    pub plugin: Option<(PathBuf, String)>,
}

/// The verdict of an examination and the border version of the library.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Answer {
    pub(super) verdict: Verdict,
    #[serde(default)]
    pub(super) api: Option<String>,
}

/// Examines a plugin if that is what the program was started for; the program's `main` calls this first, before any
/// window or device, and returns the code if there is one.
///
/// `arguments` are the program's, its name included.
pub fn child_main(arguments: impl IntoIterator<Item = OsString>) -> Option<ExitCode> {
    let arguments: Vec<OsString> = arguments.into_iter().take(4).collect();
    let [_, command, what, subject] = &arguments[..] else {
        return None;
    };
    if command != HIDDEN_COMMAND {
        return None;
    }
    let answer = match what.to_str() {
        Some("check") => check(Path::new(subject)),
        Some("try") => Answer {
            verdict: try_out(subject),
            api: None,
        },
        _ => return Some(ExitCode::from(2)),
    };
    let json = serde_json::to_string(&answer).unwrap_or_default();
    // A line of its own, whatever the plugin printed before.
    let written = writeln!(std::io::stdout().lock(), "\n{ANSWER_MARK}{json}");
    // The plugin's exit handlers are not ours to judge: the answer is out.
    Some(if written.is_ok() {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}

/// Loads a library and makes its factories.
fn check(file: &Path) -> Answer {
    let read = std::fs::read(file).map_err(|source| LoadPluginError::Read {
        file: library::name_of(file),
        source,
    });
    match read.and_then(|data| library::load(&data, file)) {
        Ok(library) => Answer {
            verdict: try_loaders(&library).unwrap_or_else(Verdict::ok),
            api: Some(library.api().to_owned()),
        },
        Err(error) => {
            let verdict = Verdict::rejected(error.to_string()).with_detail(error.detail());
            Answer { verdict, api: None }
        }
    }
}

/// Shows each loader a few starts of files, as opening any file would; the verdict on the library if one fails.
fn try_loaders(library: &library::LoadedLibrary) -> Option<Verdict> {
    let zeros = [0; START_BYTES];
    for loader in library.loaders() {
        let failed = loader.and_then(|loader| {
            for bytes in [&[][..], &zeros[..], b"1 2 3\n", b"\xff\xfe\xfd"] {
                let start = FileStartRecord {
                    bytes: RSlice::from_slice(bytes),
                    name: RStr::from_str("unknown"),
                    length: bytes.len() as u64,
                };
                loader.claims(&start).into_result().map_err(Error::from)?;
            }
            Ok(())
        });
        if let Err(error) = failed {
            return Some(Verdict::rejected(format!(
                "a loader of it fails at the first look at a file: {}",
                error.message
            )));
        }
    }
    None
}

/// Draws one frame with a plugin, or the control frame without any.
///
/// A plugin that refuses with an error is a good plugin: the session shows that error where the user looks.
fn try_out(request: &OsString) -> Verdict {
    let request: Option<TrialRequest> = request
        .to_str()
        .and_then(|json| serde_json::from_str(json).ok());
    let not_examined = |message: String| Verdict::new(VerdictClass::NotExamined, message);
    let Some(request) = request else {
        return not_examined("the trial's request cannot be read".to_owned());
    };
    let backend = request
        .backend
        .as_deref()
        .map(Backend::from_str)
        .transpose();
    let backend = match backend {
        Ok(backend) => backend,
        Err(error) => return not_examined(error.to_string()),
    };
    let (files, plugin) = request.plugin.map(|(file, id)| (vec![file], id)).unzip();
    let options = StageOptions {
        device: DeviceOptions {
            backend,
            adapter: request.adapter,
        },
        use_device: request.use_device,
        plugins: DiscoverOptions {
            files: files.unwrap_or_default(),
            ..DiscoverOptions::default()
        },
        ..StageOptions::default()
    };
    match stage::try_out(options, plugin.as_deref()) {
        Ok(_) => Verdict::ok(),
        Err(error) => not_examined(error.to_string()),
    }
}
