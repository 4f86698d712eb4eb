//! Views that the command line names.

use std::path::Path;

use pointstage_plugin_api::nearest::{did_you_mean, nearest_names};
use pointstage_scene::{Scene, ViewRecord, ViewRecordError, ViewSource, ViewSourceError};

use super::{Failure, Outcome};

/// Reads what stands for views: `orbit:N`, a file, or the name of one of those `stored`.
pub(crate) fn parse(text: &str, stored: &[(String, ViewRecord)]) -> Outcome<ViewSource> {
    let names = || stored.iter().map(|(name, _)| name.as_str());
    let source = ViewSource::parse(text, names()).map_err(Failure::usage_from)?;
    match &source {
        ViewSource::Stored(name) if !names().any(|stored| stored == name) => {
            Err(Failure::usage_from(ViewSourceError::NotStored {
                name: name.clone(),
                stored: names().map(str::to_owned).collect(),
            }))
        }
        _ => Ok(source),
    }
}

/// The views themselves; `size_px` is the size of those that have none of their own.
pub(crate) fn resolve(
    source: &ViewSource,
    scene: &Scene,
    size_px: [u32; 2],
    stored: &[(String, ViewRecord)],
) -> Outcome<Vec<ViewRecord>> {
    let views = source.resolve(&scene.framed_world(), size_px, stored);
    views.map_err(failure)
}

/// A view that cannot be had: a file that cannot be read is no wrong use.
fn failure(error: ViewSourceError) -> Failure {
    match error {
        ViewSourceError::Record { path, source } => {
            let near = match source {
                ViewRecordError::Io { .. } => did_you_mean(&neighbours_like(&path)),
                _ => String::new(),
            };
            let error = ViewSourceError::Record { path, source };
            Failure::Failed(anyhow::anyhow!("{error}{near}"))
        }
        other => Failure::usage_from(other),
    }
}

/// View files beside `path` whose names resemble its name.
fn neighbours_like(path: &Path) -> Vec<String> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let name_of = |path: &Path| Some(path.file_name()?.to_string_lossy().into_owned());
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    let names = entries.filter_map(|entry| {
        let path = entry.ok()?.path();
        let is_view = path
            .extension()
            .is_some_and(|extension| extension == "json");
        is_view.then(|| name_of(&path)).flatten()
    });
    name_of(path).map_or_else(Vec::new, |name| nearest_names(&name, names))
}
