//! Draws a view and writes its files.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

use pointstage_engine::stage::{
    FrameError, FrameRequest, FrameResult, FrameStats, Severity, Show, Stage,
};
use pointstage_scene::{ObjectId, ViewRecord, Warnings};
use serde_json::{Value, json};

use super::RenderArguments;
use super::choice::no_target;
use crate::cli::Outcome;
use crate::cli::values::{self, AovFile, AovFormat};
use crate::output::{exr_file, file_values, names, png_file, whole_file};
use crate::session_file::{SessionFile, folder_of};
use crate::toml_form::show_key;

/// Where a view stands among the views, and so what its files are called.
pub(super) struct Place<'a> {
    /// The command line.
    pub(super) arguments: &'a RenderArguments,
    /// What loading each object gave to say.
    pub(super) warnings: &'a BTreeMap<ObjectId, Warnings>,
    /// Of this view.
    pub(super) index: usize,
    /// Of all views.
    pub(super) count: usize,
}

impl Place<'_> {
    fn file(&self, path: &Path) -> PathBuf {
        names::for_view(path, self.index, self.count)
    }

    /// Draws one view and writes its files; says what was written, drawn and counted.
    pub(super) fn draw_and_write(
        &self,
        stage: &mut Stage,
        view: &ViewRecord,
        request: &FrameRequest,
    ) -> Outcome<Value> {
        let result = draw_finished(stage, request)?;
        let session = SessionFile::of_request(request, self.warnings);
        let record = record_of(view, request, &result, &session, &self.arguments.out);
        let lacks = |key: &str| {
            let given = result.available_targets.iter().map(String::as_str);
            no_target(&result.drawn_by, key, &given.collect::<Vec<_>>())
        };
        // Before anything is written.
        for AovFile { key, .. } in &self.arguments.aovs {
            if !result.available_targets.contains(key) {
                return Err(lacks(key));
            }
        }
        let out = self.file(&self.arguments.out);
        write_png(&out, &result, &record)?;
        let mut files = vec![out];
        for aov in &self.arguments.aovs {
            let path = self.file(&aov.path);
            match aov.format {
                AovFormat::Exr => {
                    let Some(plane) = result.planes.get(&aov.key) else {
                        return Err(lacks(&aov.key));
                    };
                    let plane = file_values::for_file(&aov.key, plane, view);
                    let bytes = exr_file::encode(&aov.key, result.picture.size_px, &plane)?;
                    whole_file::write(&path, &bytes)?;
                }
                AovFormat::Png => {
                    let shown = FrameRequest {
                        show: Show::Target(aov.key.clone()),
                        read_back: Vec::new(),
                        ..request.clone()
                    };
                    write_png(&path, &draw_finished(stage, &shown)?, &record)?;
                }
            }
            files.push(path);
        }
        for path in &files {
            tracing::info!("written {}", path.display());
        }
        Ok(json!({
            "files": files,
            "drawn_by": result.drawn_by,
            "size": result.picture.size_px,
            "view": view,
            "stats": stats_of(&result.stats),
        }))
    }
}

fn write_png(path: &Path, result: &FrameResult, record: &Value) -> Outcome {
    let bytes = png_file::encode(result.picture.size_px, &result.picture.rgba, record)?;
    Ok(whole_file::write(path, &bytes)?)
}

/// Draws until the picture does not refine any more; notices go to standard error.
fn draw_finished(stage: &mut Stage, request: &FrameRequest) -> Outcome<FrameResult> {
    loop {
        let result = stage.frame(request).map_err(|error| match error {
            FrameError::NoTarget {
                renderer,
                key,
                given,
            } => no_target(&renderer, &key, &given.split(", ").collect::<Vec<_>>()),
            other => other.into(),
        })?;
        for notice in &result.notices {
            let word = match notice.severity {
                Severity::Error => "error",
                Severity::Warning => "warning",
                Severity::Info => "note",
            };
            if notice.plugin.is_empty() {
                eprintln!("{word}: {}", notice.text);
            } else {
                eprintln!("{word}: {}: {}", notice.plugin, notice.text);
            }
        }
        if result.progress >= 1.0 {
            return Ok(result);
        }
    }
}

/// What a picture was made from, so that it can be made again.
fn record_of(
    view: &ViewRecord,
    request: &FrameRequest,
    result: &FrameResult,
    session: &SessionFile,
    out: &Path,
) -> Value {
    let files = request.scene.objects().iter();
    let files: Vec<_> = files.filter_map(|object| object.source.as_ref()).collect();
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        // The other fields are for people and for programs that know no sessions.
        "session": session.to_toml_string(&folder_of(out)).ok(),
        "files": files,
        "renderer": result.drawn_by,
        "settings": request.settings,
        "structure": request.structure,
        "structure_settings": request.structure_settings,
        "view": view,
        "lights": request.lights,
        "show": show_key(&request.show),
        "background": values::background_text(request.background),
        "exposure": request.exposure,
        "radius_scale": request.radius_scale,
    })
}

fn stats_of(stats: &FrameStats) -> Value {
    let millis = |time: Duration| time.as_secs_f64() * 1e3;
    let passes: Vec<Value> = stats
        .passes
        .iter()
        .map(|pass| json!({ "label": pass.label, "ms": millis(pass.time) }))
        .collect();
    json!({
        "surfels_in_scene": stats.surfels_in_scene,
        "surfels_selected": stats.surfels_selected,
        "total_ms": millis(stats.total),
        "plugin_cpu_ms": millis(stats.plugin_cpu),
        "device_wall_ms": millis(stats.device_wall),
        "passes": passes,
        "plugin_bytes": stats.plugin_bytes,
        "scene_bytes": stats.scene_bytes,
        "reported": stats.reported,
    })
}
