//! Draws a view and writes its files.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

use pointstage_engine::stage::{FrameError, FrameRequest, FrameStats, Show, Stage};
use pointstage_scene::{Job, ObjectId, ViewRecord, Warnings};
use serde_json::{Value, json};

use super::RenderArguments;
use crate::cli::Outcome;
use crate::cli::drawing::{draw_finished, no_target, say, write_png};
use crate::cli::values::{AovFile, AovFormat};
use crate::output::export::{Export, ExportError, Exporting, Format, LARGE_TILE_PX, Saved};
use crate::output::{exr_file, file_values, names, record, whole_file};

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
    /// Whether the views are pictures of a film.
    pub(super) is_film: bool,
}

impl Place<'_> {
    fn file(&self, path: &Path) -> PathBuf {
        if self.is_film {
            names::for_frame(path, self.index, self.count)
        } else {
            names::for_view(path, self.index, self.count)
        }
    }

    /// Draws one view and writes its files; says what was written, drawn and counted.
    pub(super) fn draw_and_write(
        &self,
        stage: &mut Stage,
        view: &ViewRecord,
        request: &FrameRequest,
    ) -> Outcome<Value> {
        let fits = request
            .size_px
            .iter()
            .all(|side| *side <= stage.largest_frame_px());
        if !fits || Format::of(&self.arguments.out) != Some(Format::Png) {
            return self.export(stage, view, request);
        }
        let result = draw_finished(stage, request)?;
        let mut record = self.record_of(request);
        record::add_drawer(&mut record, stage, &result.drawn_by);
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

    /// What the picture is made from, so that it can be made again.
    fn record_of(&self, request: &FrameRequest) -> Value {
        let out = self.file(&self.arguments.out);
        record::of_frame(request, self.warnings, &out)
    }

    /// Draws each file of a view by itself, in tiles where it is larger than what the device draws at once.
    fn export(
        &self,
        stage: &mut Stage,
        view: &ViewRecord,
        request: &FrameRequest,
    ) -> Outcome<Value> {
        let record = self.record_of(request);
        let export = |path: &Path, show: Show, targets: Vec<String>| Export {
            path: self.file(path),
            format: Format::of(path).unwrap_or(Format::Png),
            frame: FrameRequest {
                show,
                read_back: Vec::new(),
                ..request.clone()
            },
            targets,
            record: record.clone(),
            most_tile_px: LARGE_TILE_PX,
        };
        let picture = export(&self.arguments.out, request.show.clone(), Vec::new());
        let others = self.arguments.aovs.iter().map(|AovFile { key, path, .. }| {
            // An EXR file shows nothing, and a PNG file has no layers.
            export(path, Show::Target(key.clone()), vec![key.clone()])
        });
        let exports: Vec<Export> = std::iter::once(picture).chain(others).collect();
        let files: Vec<PathBuf> = exports.iter().map(|export| export.path.clone()).collect();
        let mut first: Option<Saved> = None;
        for export in exports {
            let saved = save(stage, export)?;
            saved.notices.iter().for_each(say);
            tracing::info!("written {}", saved.path.display());
            first.get_or_insert(saved);
        }
        let first = first.expect("the picture itself is the first");
        Ok(json!({
            "files": files,
            "drawn_by": first.drawn_by,
            "size": request.size_px,
            "tiles": first.tile_count,
            "view": view,
            "stats": stats_of(&first.stats),
        }))
    }
}

/// Saves an image, however long it takes.
fn save(stage: &mut Stage, export: Export) -> Outcome<Saved> {
    let mut exporting = Exporting::begin(export, Job::new())?;
    loop {
        match exporting.step(stage) {
            Ok(Some(saved)) => return Ok(saved),
            Ok(None) => {}
            Err(
                ExportError::NoTarget {
                    renderer,
                    key,
                    given,
                }
                | ExportError::Frame(FrameError::NoTarget {
                    renderer,
                    key,
                    given,
                }),
            ) => {
                let given: Vec<&str> = given.split(", ").collect();
                return Err(no_target(&renderer, &key, &given));
            }
            Err(error) => return Err(error.into()),
        }
    }
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
