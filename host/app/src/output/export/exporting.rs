//! Saves an image step by step.

use std::time::Duration;

use pointstage_engine::frame::targets::{COLOUR, DEPTH, PlaneFormat, TargetSpec};
use pointstage_engine::stage::{
    Background, FALLBACK_ID, FrameRequest, FrameResult, FrameStats, Notice, PassTime, Patience,
    Role, Show, Stage, ViewportId,
};
use pointstage_scene::{Job, ViewRecord};

use super::exr_layers::{ExrLayers, MOST_BYTES};
use super::png_rows::PngRows;
use super::tiling::Tiling;
use super::{Export, ExportError, Format, Saved};
use crate::output::png_file::Alpha;
use crate::output::record;
use crate::output::whole_file::PartFile;

/// A viewport of its own, so that nobody else's targets and views change size.
const VIEWPORT: ViewportId = ViewportId(u32::MAX);

/// How long a step waits where there is nothing to do but to wait.
const MOMENT: Duration = Duration::from_millis(5);

/// Size of a frame that only tells whether the renderer is ready, px.
const TRIAL_PX: u32 = 16;

/// The greatest side of the overview that tells the range of a shown target, px.
const OVERVIEW_PX: u32 = 1024;

/// Bytes that a pixel takes while it is composed and read back, beside its targets.
const PICTURE_BYTES: u64 = 12;

/// An image that is being saved. Dropping it leaves nothing behind but what was there before.
pub(crate) struct Exporting {
    export: Export,
    job: Job,
    part: Option<PartFile>,
    /// Known with the first step.
    tiling: Option<Tiling>,
    /// Known once the renderer is ready.
    drawing: Option<Drawing>,
    /// Whether the renderer drew the last frame as asked for.
    is_ready: bool,
    notices: Vec<Notice>,
}

/// How far it is.
struct Drawing {
    tiling: Tiling,
    next: usize,
    sink: Sink,
    stats: FrameStats,
    has_ended: bool,
}

enum Sink {
    Png(PngRows),
    Exr(ExrLayers),
}

impl Exporting {
    /// Begins: the file can be written, as far as that can be known. `job` tells progress and cancels.
    pub(crate) fn begin(mut export: Export, job: Job) -> Result<Self, ExportError> {
        let part = PartFile::create(&export.path)?;
        export.frame.viewport = VIEWPORT;
        export.frame.role = Role::Auxiliary;
        if export.format == Format::Exr {
            // Values have neither a ramp nor a background.
            export.frame.show = Show::Colours;
            export.frame.background = Background::Transparent;
        }
        Ok(Self {
            export,
            job,
            part: Some(part),
            tiling: None,
            drawing: None,
            is_ready: false,
            notices: Vec::new(),
        })
    }

    /// Does the next step, at most one frame; the image when it is saved. After an error there is nothing more to do.
    ///
    /// With [`Patience::DrawMeanwhile`] a step never waits for the renderer's preparation.
    pub(crate) fn step(&mut self, stage: &mut Stage) -> Result<Option<Saved>, ExportError> {
        let outcome = self.try_step(stage);
        if !matches!(outcome, Ok(None)) {
            stage.close_viewport(VIEWPORT);
        }
        outcome
    }

    /// Whether all is drawn, and the file takes its place any moment.
    pub(crate) fn is_being_written(&self) -> bool {
        self.drawing
            .as_ref()
            .is_some_and(|drawing| drawing.has_ended)
    }

    fn try_step(&mut self, stage: &mut Stage) -> Result<Option<Saved>, ExportError> {
        self.job.check()?;
        let Some(tiling) = self.tiling else {
            self.tiling = Some(self.plan(stage)?);
            return Ok(None);
        };
        if !self.is_ready {
            self.try_to_be_ready(stage, &tiling)?;
            return Ok(None);
        }
        let Some(drawing) = &mut self.drawing else {
            self.drawing = Some(self.begin_to_draw(stage, tiling)?);
            return Ok(None);
        };
        if drawing.next < drawing.tiling.count() {
            if drawing.sink.is_behind() {
                std::thread::sleep(MOMENT);
                return Ok(None);
            }
            self.draw_tile(stage)?;
            return Ok(None);
        }
        if !drawing.has_ended {
            drawing.has_ended = true;
            self.job.set_stage("writing the file");
            // Writing takes a while, and no tile is drawn any more.
            stage.close_viewport(VIEWPORT);
            drawing.sink.end()?;
        }
        if !drawing.sink.poll()? {
            std::thread::sleep(MOMENT);
            return Ok(None);
        }
        self.job.set_progress(1.0);
        Ok(Some(Saved {
            path: self.export.path.clone(),
            drawn_by: id_of(stage, &self.export.frame.renderer)?,
            stats: std::mem::take(&mut drawing.stats),
            tile_count: drawing.tiling.count(),
            notices: std::mem::take(&mut self.notices),
        }))
    }

    /// Whether the renderer is ready; finds the shown target's range on the way.
    fn try_to_be_ready(&mut self, stage: &mut Stage, tiling: &Tiling) -> Result<(), ExportError> {
        let frame = &self.export.frame;
        let shows_target = matches!(frame.show, Show::Target(_));
        // One tile finds its own; several have to agree.
        let needs_range = shows_target && frame.shown_range.is_none() && tiling.count() > 1;
        let size_px = if needs_range {
            fitted(frame.size_px, OVERVIEW_PX)
        } else {
            [TRIAL_PX; 2]
        };
        let trial = FrameRequest {
            size_px,
            tile: None,
            read_back: Vec::new(),
            ..frame.clone()
        };
        let Some(result) = self.drawn_as_asked(stage, &trial)? else {
            return Ok(());
        };
        if needs_range {
            self.export.frame.shown_range = result.shown_range;
        }
        self.is_ready = true;
        Ok(())
    }

    /// Draws a frame; none while the renderer or the structure is being prepared for it.
    fn drawn_as_asked(
        &mut self,
        stage: &mut Stage,
        request: &FrameRequest,
    ) -> Result<Option<FrameResult>, ExportError> {
        let mut result = stage.frame(request)?;
        self.notices.append(&mut result.notices);
        if let Some(preparing) = &result.preparing {
            let what = if preparing.stage.is_empty() {
                format!("preparing {}", preparing.id)
            } else {
                format!("preparing {}: {}", preparing.id, preparing.stage)
            };
            self.job.set_stage(what);
            self.is_ready = false;
            std::thread::sleep(MOMENT);
            return Ok(None);
        }
        let is_asked_for = result.drawn_by == id_of(stage, &request.renderer)?
            && result.scene.revision() == request.scene.revision();
        if is_asked_for {
            return Ok(Some(result));
        }
        // A stand-in drew, so the one asked for has failed: waiting for it tells why.
        let waiting = FrameRequest {
            patience: Patience::Wait,
            size_px: [TRIAL_PX; 2],
            tile: None,
            read_back: Vec::new(),
            ..request.clone()
        };
        stage.frame(&waiting)?;
        self.is_ready = false;
        Ok(None)
    }

    /// Checks what is asked for and cuts the image into tiles.
    fn plan(&mut self, stage: &Stage) -> Result<Tiling, ExportError> {
        let given = stage.given_targets(&self.export.frame.renderer)?;
        let drawn_by = id_of(stage, &self.export.frame.renderer)?;
        let Export {
            format,
            frame,
            targets,
            most_tile_px,
            ..
        } = &mut self.export;
        let size_px = frame.size_px;
        if *format == Format::Exr {
            if targets.is_empty() {
                *targets = given.iter().map(|spec| spec.key.to_string()).collect();
            }
            frame.read_back.clone_from(targets);
            check_layers(&given, targets, size_px, &drawn_by)?;
        }
        let is_drawn = |spec: &&TargetSpec| {
            let is_shown = matches!(&frame.show, Show::Target(key) if *key == spec.key);
            let is_own = spec.key == COLOUR || spec.key == DEPTH;
            is_shown || is_own || targets.iter().any(|key| *key == spec.key)
        };
        // On the device, in the buffer that it is read back through, and in memory.
        let bytes = given
            .iter()
            .filter(is_drawn)
            .map(|spec| 3 * value_bytes(spec));
        let pixel_bytes = PICTURE_BYTES + bytes.sum::<u64>();
        let most_px = (*most_tile_px).min(stage.largest_frame_px());
        Ok(Tiling::new(size_px, most_px, pixel_bytes))
    }

    /// Opens the file.
    fn begin_to_draw(&mut self, stage: &Stage, tiling: Tiling) -> Result<Drawing, ExportError> {
        let Export {
            path,
            format,
            frame,
            record,
            ..
        } = &mut self.export;
        let drawn_by = id_of(stage, &frame.renderer)?;
        record::add_drawer(record, stage, &drawn_by);
        if let Some(fields) = record.as_object_mut() {
            fields.insert(
                "shown_range".to_owned(),
                serde_json::json!(frame.shown_range),
            );
        }
        let size_px = frame.size_px;
        let part = match self.part.take() {
            Some(part) => part,
            None => PartFile::create(path)?,
        };
        let sink = match format {
            Format::Png => {
                let alpha = match frame.background {
                    Background::Transparent => Alpha::Straight,
                    _ => Alpha::None,
                };
                let record = record.clone();
                Sink::Png(PngRows::begin(part, path, size_px, alpha, record)?)
            }
            Format::Exr => Sink::Exr(ExrLayers::begin(
                part,
                path.clone(),
                size_px,
                record.clone(),
                self.job.clone(),
            )),
        };
        Ok(Drawing {
            tiling,
            next: 0,
            sink,
            stats: FrameStats::default(),
            has_ended: false,
        })
    }

    /// Draws the next tile once; it counts when it does not refine any more.
    fn draw_tile(&mut self, stage: &mut Stage) -> Result<(), ExportError> {
        let Some(drawing) = &self.drawing else {
            return Ok(());
        };
        let (count, number) = (drawing.tiling.count(), drawing.next);
        let Some(place) = drawing.tiling.place(number) else {
            return Ok(());
        };
        if count > 1 {
            self.job
                .set_stage(format!("tile {} of {count}", number + 1));
        } else {
            self.job.set_stage("drawing");
        }
        let request = FrameRequest {
            size_px: place.size_px,
            tile: drawing.tiling.tile(&place),
            ..self.export.frame.clone()
        };
        let Some(result) = self.drawn_as_asked(stage, &request)? else {
            return Ok(());
        };
        let Some(drawing) = &mut self.drawing else {
            return Ok(());
        };
        add_stats(&mut drawing.stats, &result.stats);
        if result.progress < 1.0 {
            return Ok(());
        }
        match &mut drawing.sink {
            Sink::Png(rows) => rows.take_tile(&place, &result.picture),
            Sink::Exr(layers) => {
                let [width, height] = self.export.frame.size_px;
                let view = ViewRecord::new(self.export.frame.camera, width, height);
                for key in &self.export.targets {
                    if let Some(plane) = result.planes.get(key) {
                        layers.take_plane(&place, key, plane, &view);
                    }
                }
            }
        }
        drawing.next += 1;
        self.job
            .set_progress(drawing.next as f32 / (count + 1) as f32);
        Ok(())
    }
}

impl Sink {
    fn is_behind(&self) -> bool {
        match self {
            Self::Png(rows) => rows.is_behind(),
            Self::Exr(_) => false,
        }
    }

    fn end(&mut self) -> Result<(), ExportError> {
        match self {
            Self::Png(rows) => {
                rows.end();
                Ok(())
            }
            Self::Exr(layers) => layers.end(),
        }
    }

    fn poll(&mut self) -> Result<bool, ExportError> {
        match self {
            Self::Png(rows) => rows.poll(),
            Self::Exr(layers) => layers.poll(),
        }
    }
}

/// The id that a request's renderer has in results.
fn id_of(stage: &Stage, renderer: &str) -> Result<String, ExportError> {
    if renderer == FALLBACK_ID {
        return Ok(FALLBACK_ID.to_owned());
    }
    Ok(stage.registry().find_renderer(renderer)?.id.clone())
}

/// The size in the same proportions within a square.
fn fitted(size_px: [u32; 2], most_px: u32) -> [u32; 2] {
    let longest = size_px[0].max(size_px[1]).max(1);
    let scale = (f64::from(most_px) / f64::from(longest)).min(1.0);
    size_px.map(|side| (f64::from(side) * scale).round().max(1.0) as u32)
}

/// Bytes of a pixel's values as they are read back.
fn value_bytes(spec: &TargetSpec) -> u64 {
    match spec.plane_format() {
        PlaneFormat::Uint | PlaneFormat::Float => 4,
        PlaneFormat::Float4 => 16,
    }
}

/// Refuses targets that the renderer does not give, and more of them than memory takes.
fn check_layers(
    given: &[TargetSpec],
    targets: &[String],
    [width, height]: [u32; 2],
    renderer: &str,
) -> Result<(), ExportError> {
    let mut pixel_bytes = 0;
    for key in targets {
        let Some(spec) = given.iter().find(|spec| spec.key == *key) else {
            let given: Vec<&str> = given.iter().map(|spec| &*spec.key).collect();
            return Err(ExportError::NoTarget {
                renderer: renderer.to_owned(),
                key: key.clone(),
                given: given.join(", "),
            });
        };
        pixel_bytes += value_bytes(spec);
    }
    let needed = u64::from(width) * u64::from(height) * pixel_bytes;
    if needed <= MOST_BYTES {
        return Ok(());
    }
    let gigabytes = |bytes: u64| bytes as f64 / f64::from(1 << 30);
    Err(ExportError::TooLarge {
        width,
        height,
        layers: targets.len(),
        needed_gb: gigabytes(needed),
        most_gb: gigabytes(MOST_BYTES),
    })
}

/// Adds a tile's times; counts are those of the largest.
fn add_stats(sum: &mut FrameStats, tile: &FrameStats) {
    sum.surfels_in_scene = sum.surfels_in_scene.max(tile.surfels_in_scene);
    sum.surfels_selected = sum.surfels_selected.max(tile.surfels_selected);
    sum.total += tile.total;
    sum.plugin_cpu += tile.plugin_cpu;
    sum.device_wall += tile.device_wall;
    sum.plugin_bytes = sum.plugin_bytes.max(tile.plugin_bytes);
    sum.scene_bytes = sum.scene_bytes.max(tile.scene_bytes);
    sum.target_bytes = sum.target_bytes.max(tile.target_bytes);
    sum.reported.extend(
        tile.reported
            .iter()
            .map(|(key, value)| (key.clone(), *value)),
    );
    for PassTime { label, time } in &tile.passes {
        match sum.passes.iter_mut().find(|pass| pass.label == *label) {
            Some(pass) => pass.time += *time,
            None => sum.passes.push(PassTime {
                label: label.clone(),
                time: *time,
            }),
        }
    }
}
