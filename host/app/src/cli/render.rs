//! `pointstage render`: files to pictures, without a window.
//!
//! What can be wrong with the command line is checked before a file is read. Then the scene is loaded once, each view is
//! drawn, and its files are written whole.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use clap::Args;
use pointstage_engine::plugins::{PluginInfo, suitability};
use pointstage_engine::stage::{
    Background, FALLBACK_ID, FrameRequest, FrameResult, FrameStats, Severity, Show, Stage,
};
use pointstage_plugin_api::nearest::{did_you_mean, nearest_names};
use pointstage_plugin_api::settings_schema::{SettingSchema, SettingValues, ValueError};
use pointstage_scene::{Scene, ViewRecord, ViewSource};
use serde_json::{Value, json};

use super::load::LoadArguments;
use super::values::{self, AovFile, AovFormat};
use super::{Failure, Globals, Outcome, write_out};
use crate::output::{exr_file, file_values, names, png_file, whole_file};

/// Size of a picture when neither `--size` nor the view says one, px.
const DEFAULT_SIZE: [u32; 2] = [1280, 720];

/// Arguments of `render`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  pointstage render scan.ply --renderer surfel --out scan.png
  pointstage render scan.ply --renderer points --set size_mode=fixed --set size=3 --out scan.png
  pointstage render scan.ply --out scan.png --aov depth=depth.exr --aov normal=normal.png
  pointstage render a.ply b.ply --view orbit:8 --size 800x600 --out turn.png
  pointstage render scan.ply --view view.json --stats stats.json --out scan.png

Several views (orbit:N) number their files: turn_000.png, turn_001.png, …
EXR files hold the target's values: depth as the distance along the line of sight in scene units (infinite where
nothing is), normals in view space, ids as whole numbers. PNG files show them as the window's legend does.
PNG files carry the renderer, settings and view that made them, as JSON in the text chunk 'Pointstage'.")]
pub(crate) struct RenderArguments {
    /// PLY files; each becomes an object
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// Renderer: an id, a short name, id@version or id#hash [default: the first that can draw]
    #[arg(long, value_name = "ID")]
    renderer: Option<String>,
    /// Structure that selects levels of detail
    #[arg(long, value_name = "ID")]
    structure: Option<String>,
    /// Picture to write
    #[arg(long, value_name = "FILE.png", value_parser = values::png_path)]
    out: PathBuf,
    /// Size of the picture in pixels [default: the view's, else 1280x720]
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    size: Option<[u32; 2]>,
    /// Where to look from: a view FILE, or orbit:N for N views around the scene
    #[arg(long, value_name = "FILE|orbit:N", default_value = "orbit:1")]
    view: String,
    /// A setting of the renderer; may be given several times
    #[arg(long = "set", value_name = "ID=VALUE", value_parser = values::assignment)]
    settings: Vec<(String, String)>,
    /// A setting of the structure; may be given several times
    #[arg(long = "set-structure", value_name = "ID=VALUE", value_parser = values::assignment, requires = "structure")]
    structure_settings: Vec<(String, String)>,
    /// Another target to write, as values (.exr) or colours (.png); may be given several times
    #[arg(long = "aov", value_name = "KEY=FILE", value_parser = values::aov)]
    aovs: Vec<AovFile>,
    /// What the picture shows: 'colours' or the key of a target
    #[arg(long, value_name = "KEY", default_value = "colours")]
    show: String,
    /// What lies behind: 'transparent', '#rrggbb', or '#rrggbb,#rrggbb' from top to bottom
    #[arg(long, value_name = "COLOUR", value_parser = values::background, default_value = "#4d545e,#171a1f")]
    background: Background,
    /// Factor on the colours
    #[arg(long, value_name = "FACTOR", value_parser = values::factor, default_value = "1")]
    exposure: f32,
    /// Factor on every surfel's radius
    #[arg(long, value_name = "FACTOR", value_parser = values::factor, default_value = "1")]
    radius_scale: f32,
    /// Write times and counts of every view as JSON
    #[arg(long, value_name = "FILE.json")]
    stats: Option<PathBuf>,
    /// Say as JSON on standard output what was written
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    load: LoadArguments,
}

/// Draws and writes every view.
pub(crate) fn run(globals: &Globals, arguments: &RenderArguments) -> Outcome {
    let view_source = ViewSource::parse(&arguments.view, []).map_err(Failure::usage_from)?;
    let mut stage = Stage::new(globals.stage_options())?;
    let chosen = Chosen::new(&stage, arguments)?;
    let scene = Arc::new(arguments.load.load_scene(&arguments.files)?);
    let size_px = arguments.size.unwrap_or(DEFAULT_SIZE);
    let views = view_source
        .resolve(&scene.bounds_world(), size_px, &[])
        .map_err(Failure::usage_from)?;
    let renderer = chosen.renderer_for(&stage, &scene);
    let mut written = Vec::new();
    for (index, view) in views.iter().enumerate() {
        let mut view = *view;
        if let Some([width, height]) = arguments.size {
            (view.width, view.height) = (width, height);
        }
        let request = chosen.request(&scene, &view, renderer.clone(), arguments);
        let place = Place {
            arguments,
            index,
            count: views.len(),
        };
        written.push(place.draw_and_write(&mut stage, &view, &request)?);
    }
    if let Some(path) = &arguments.stats {
        let text = serde_json::to_string_pretty(&written)?;
        whole_file::write(path, text.as_bytes())?;
    }
    if arguments.json {
        write_out(&serde_json::to_string_pretty(&written)?)?;
    }
    Ok(())
}

/// What the command line names, looked up and checked before a file is read.
struct Chosen {
    renderer: Option<Arc<PluginInfo>>,
    is_fallback: bool,
    structure: Option<Arc<PluginInfo>>,
    settings: SettingValues,
    structure_settings: SettingValues,
    show: Show,
}

impl Chosen {
    fn new(stage: &Stage, arguments: &RenderArguments) -> Outcome<Self> {
        let registry = stage.registry();
        let is_fallback = arguments
            .renderer
            .as_deref()
            .is_some_and(|key| key == FALLBACK_ID || key == "fallback");
        let renderer = match &arguments.renderer {
            Some(key) if !is_fallback => {
                Some(registry.find_renderer(key).map_err(Failure::usage_from)?)
            }
            _ => None,
        };
        let structure = match &arguments.structure {
            Some(key) => Some(registry.find_structure(key).map_err(Failure::usage_from)?),
            None => None,
        };
        if renderer.is_none() && !is_fallback && !arguments.settings.is_empty() {
            return Err(Failure::usage(
                "--set needs --renderer: settings belong to a renderer",
            ));
        }
        let show = match arguments.show.as_str() {
            "colours" | "colors" => Show::Colours,
            key => Show::Target(key.to_owned()),
        };
        if let Some(info) = &renderer {
            check_targets(info, &show, &arguments.aovs)?;
        }
        Ok(Self {
            settings: values_of(renderer.as_deref(), &arguments.settings)?,
            structure_settings: values_of(structure.as_deref(), &arguments.structure_settings)?,
            renderer,
            is_fallback,
            structure,
            show,
        })
    }

    /// The id to ask for: the one named, else the first that can draw the scene, else the built-in one.
    fn renderer_for(&self, stage: &Stage, scene: &Scene) -> String {
        if let Some(info) = &self.renderer {
            return info.id.clone();
        }
        let device = stage.device().map(|device| &**device);
        let suitable = |info: &Arc<PluginInfo>| {
            suitability(&info.entry.needs, scene, device)
                .reason()
                .is_none()
        };
        let found = stage.registry().renderers().into_iter().find(suitable);
        match found {
            Some(info) if !self.is_fallback => info.id.clone(),
            _ => FALLBACK_ID.to_owned(),
        }
    }

    fn request(
        &self,
        scene: &Arc<Scene>,
        view: &ViewRecord,
        renderer: String,
        arguments: &RenderArguments,
    ) -> FrameRequest {
        let values = arguments
            .aovs
            .iter()
            .filter(|aov| aov.format == AovFormat::Exr);
        FrameRequest {
            structure: self.structure.as_ref().map(|info| info.id.clone()),
            settings: self.settings.clone(),
            structure_settings: self.structure_settings.clone(),
            read_back: values.map(|aov| aov.key.clone()).collect(),
            show: self.show.clone(),
            background: arguments.background,
            exposure: arguments.exposure,
            radius_scale: arguments.radius_scale,
            ..FrameRequest::still(
                scene.clone(),
                view.camera(),
                [view.width, view.height],
                renderer,
            )
        }
    }
}

/// The values that `--set` gives, checked against the schema.
fn values_of(info: Option<&PluginInfo>, given: &[(String, String)]) -> Outcome<SettingValues> {
    let schema: &[SettingSchema] = info.map_or(&[], |info| &info.entry.settings);
    let mut values = SettingValues::new();
    for (id, text) in given {
        let setting = schema
            .iter()
            .find(|setting| setting.id == *id)
            .ok_or_else(|| Failure::usage_from(ValueError::unknown(id, schema)))?;
        let value = setting.parse_text(text).map_err(Failure::usage_from)?;
        values.insert(id.clone(), value);
    }
    Ok(values)
}

/// Refuses targets that the renderer does not write.
fn check_targets(info: &PluginInfo, show: &Show, aovs: &[AovFile]) -> Outcome {
    let given: Vec<&str> = info
        .entry
        .gives
        .targets
        .iter()
        .map(|target| target.key.as_str())
        .collect();
    let shown = match show {
        Show::Target(key) => Some(key),
        Show::Colours => None,
    };
    for key in shown.into_iter().chain(aovs.iter().map(|aov| &aov.key)) {
        if !given.contains(&key.as_str()) {
            let near = did_you_mean(&nearest_names(key, &given));
            return Err(Failure::usage(format!(
                "renderer '{}' writes no target '{key}'{near} (it writes {})",
                info.entry.alias,
                given.join(", ")
            )));
        }
    }
    Ok(())
}

/// Where a view stands among the views, and so what its files are called.
struct Place<'a> {
    arguments: &'a RenderArguments,
    index: usize,
    count: usize,
}

impl Place<'_> {
    fn file(&self, path: &Path) -> PathBuf {
        names::for_view(path, self.index, self.count)
    }

    /// Draws one view and writes its files; says what was written, drawn and counted.
    fn draw_and_write(
        &self,
        stage: &mut Stage,
        view: &ViewRecord,
        request: &FrameRequest,
    ) -> Outcome<Value> {
        let result = draw_finished(stage, request)?;
        let record = record_of(self.arguments, view, request, &result);
        let out = self.file(&self.arguments.out);
        write_png(&out, &result, &record)?;
        let mut files = vec![out];
        for aov in &self.arguments.aovs {
            let path = self.file(&aov.path);
            match aov.format {
                AovFormat::Exr => {
                    let plane = result.planes.get(&aov.key).ok_or_else(|| {
                        Failure::usage(format!(
                            "renderer '{}' writes no target '{}'; it writes {}",
                            result.drawn_by,
                            aov.key,
                            result.available_targets.join(", ")
                        ))
                    })?;
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
        let result = stage.frame(request)?;
        for notice in &result.notices {
            let word = match notice.severity {
                Severity::Error => "error",
                Severity::Warning => "warning",
                Severity::Info => "note",
            };
            let plugin = if notice.plugin.is_empty() {
                String::new()
            } else {
                format!("{}: ", notice.plugin)
            };
            eprintln!("{word}: {plugin}{}", notice.text);
        }
        if result.progress >= 1.0 {
            return Ok(result);
        }
    }
}

/// What a picture was made from, so that it can be made again.
fn record_of(
    arguments: &RenderArguments,
    view: &ViewRecord,
    request: &FrameRequest,
    result: &FrameResult,
) -> Value {
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "files": arguments.files,
        "renderer": result.drawn_by,
        "settings": request.settings,
        "structure": request.structure,
        "structure_settings": request.structure_settings,
        "view": view,
        "lights": request.lights,
        "show": arguments.show,
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
