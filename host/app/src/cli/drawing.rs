//! What commands that draw have in common: renderers and settings by name, frames to their end, pictures into files.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use pointstage_engine::plugins::{PluginInfo, Registry};
use pointstage_engine::stage::{
    FALLBACK_ID, FrameError, FrameRequest, FrameResult, FrameStats, Notice, SettingValues,
    Severity, Stage,
};
use pointstage_plugin_api::nearest::{did_you_mean, nearest_names};
use pointstage_plugin_api::settings_schema::{SettingSchema, ValueError};
use serde_json::Value;

use super::{Failure, Outcome};
use crate::output::{png_file, whole_file};

/// Whether `name` means the built-in renderer, which is no plugin.
pub(crate) fn is_fallback(name: &str) -> bool {
    name == FALLBACK_ID || name == "fallback"
}

/// The renderer of this name; none if it is the built-in one.
pub(crate) fn find_renderer(registry: &Registry, name: &str) -> Outcome<Option<Arc<PluginInfo>>> {
    if is_fallback(name) {
        return Ok(None);
    }
    let found = registry.find_renderer(name);
    found.map(Some).map_err(Failure::usage_from)
}

/// The settings of a plugin; none has none.
pub(crate) fn schema(info: Option<&PluginInfo>) -> &[SettingSchema] {
    info.map_or(&[], |info| &info.entry.settings)
}

/// The setting `id`, or which one may be meant.
pub(crate) fn find_setting<'a>(
    schema: &'a [SettingSchema],
    id: &str,
) -> Result<&'a SettingSchema, ValueError> {
    let setting = schema.iter().find(|setting| setting.id == id);
    setting.ok_or_else(|| ValueError::unknown(id, schema))
}

/// Adds the values that the command line gives, checked against the schema.
pub(crate) fn set_values(
    values: &mut SettingValues,
    schema: &[SettingSchema],
    given: &[(String, String)],
) -> Result<(), ValueError> {
    for (id, text) in given {
        let value = find_setting(schema, id)?.parse_text(text)?;
        values.insert(id.clone(), value);
    }
    Ok(())
}

/// The renderer writes no such target.
pub(crate) fn no_target(renderer: &str, key: &str, given: &[&str]) -> Failure {
    let near = did_you_mean(&nearest_names(key, given));
    Failure::usage(format!(
        "renderer '{renderer}' writes no target '{key}'{near} (it writes {})",
        given.join(", ")
    ))
}

/// None of several renderers writes such a target.
pub(crate) fn no_target_of_any(key: &str, given: &[&str]) -> Failure {
    let near = did_you_mean(&nearest_names(key, given));
    Failure::usage(format!(
        "no renderer of these writes a target '{key}'{near} (they write {})",
        given.join(", ")
    ))
}

/// Says a notice on standard error.
pub(crate) fn say(notice: &Notice) {
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

/// Draws until the picture does not refine any more; notices go to standard error.
pub(crate) fn draw_finished(stage: &mut Stage, request: &FrameRequest) -> Outcome<FrameResult> {
    let (result, _) = draw_in_silence(stage, request)?;
    result.notices.iter().for_each(say);
    Ok(result)
}

/// What a picture cost, all of its frames together.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Cost {
    /// From the request to the picture in memory, by the clock.
    pub(crate) wall: Duration,
    /// In the renderer's code on the CPU.
    pub(crate) plugin_cpu: Duration,
    /// From submission to completion, by the clock; zero where the CPU draws.
    pub(crate) device_wall: Duration,
    /// The renderer's passes on the device, by timestamps; none where there are none.
    pub(crate) passes: Option<Duration>,
}

impl Cost {
    /// Adds a frame.
    fn add(&mut self, stats: &FrameStats) {
        self.wall += stats.total;
        self.plugin_cpu += stats.plugin_cpu;
        self.device_wall += stats.device_wall;
        if !stats.passes.is_empty() {
            let passes: Duration = stats.passes.iter().map(|pass| pass.time).sum();
            *self.passes.get_or_insert_default() += passes;
        }
    }
}

/// The same, but the notices of all its frames are in the result alone. With it, what all its frames cost.
pub(crate) fn draw_in_silence(
    stage: &mut Stage,
    request: &FrameRequest,
) -> Outcome<(FrameResult, Cost)> {
    let (mut notices, mut cost) = (Vec::new(), Cost::default());
    loop {
        let frame = stage.frame(request).map_err(|error| match error {
            FrameError::NoTarget {
                renderer,
                key,
                given,
            } => no_target(&renderer, &key, &given.split(", ").collect::<Vec<_>>()),
            other => other.into(),
        });
        let mut result = match frame {
            Ok(result) => result,
            Err(failure) => {
                // Nobody else gets to see what led to it.
                notices.iter().for_each(say);
                return Err(failure);
            }
        };
        notices.append(&mut result.notices);
        cost.add(&result.stats);
        if result.progress >= 1.0 {
            return Ok((FrameResult { notices, ..result }, cost));
        }
    }
}

/// Writes a picture with what it was made from.
pub(crate) fn write_png(path: &Path, result: &FrameResult, record: &Value) -> Outcome {
    let bytes = png_file::encode(result.picture.size_px, &result.picture.rgba, record)?;
    Ok(whole_file::write(path, &bytes)?)
}
