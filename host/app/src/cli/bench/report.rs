//! `bench.json`. Its form is documented in `docs/user-guide/measuring-speed.md`; what is there keeps its name and meaning
//! within one [`FORMAT`].

use serde::Serialize;

use super::lane::{Lane, Memory};
use super::{BenchArguments, Stand};
use crate::cli::Outcome;
use crate::cli::measuring::made_by::MadeBy;
use crate::cli::measuring::times::{Spread, Times};
use crate::cli::measuring::who::Who;
use crate::output::record::background_text;

/// Version of the form.
const FORMAT: u32 = 1;

/// All that was measured.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    format: u32,
    pub(super) made_by: MadeBy,
    pub(super) size: [u32; 2],
    background: String,
    radius_scale: f32,
    pub(super) path: String,
    pub(super) frames: u32,
    pub(super) rounds: u32,
    warm_up: u32,
    pub(super) baseline: Option<String>,
    pub(super) scenes: Vec<SceneReport>,
}

/// One scene.
#[derive(Debug, Serialize)]
pub(super) struct SceneReport {
    pub(super) name: String,
    file: String,
    pub(super) surfels: usize,
    triangles: usize,
    /// In the order of the renderers.
    pub(super) renderers: Vec<LaneReport>,
}

/// One renderer on one scene.
#[derive(Debug, Serialize)]
pub(super) struct LaneReport {
    #[serde(flatten)]
    pub(super) who: Who,
    /// Why it cannot draw the scene; the rest is `null` then.
    pub(super) unsuitable: Option<String>,
    pub(super) times: Option<Times>,
    /// By the median.
    pub(super) frames_per_second: Option<f64>,
    /// Selected surfels times `frames_per_second`.
    pub(super) splats_per_second: Option<f64>,
    /// Median of `times` over the baseline's on the same scene.
    pub(super) ratio: Option<f64>,
    pub(super) first_image_ms: Option<f64>,
    /// Of pictures right after another renderer's.
    pub(super) switch_ms: Option<Spread>,
    pub(super) memory: Option<MemoryReport>,
}

/// The most that was held at a time, bytes.
#[allow(
    clippy::struct_field_names,
    reason = "fields carry their unit, and in JSON these are the names"
)]
#[derive(Debug, Serialize)]
pub(super) struct MemoryReport {
    plugin_bytes: u64,
    scene_bytes: u64,
    target_bytes: u64,
    process_bytes: Option<u64>,
}

impl MemoryReport {
    fn of(memory: &Memory) -> Self {
        let Memory {
            plugin_bytes,
            scene_bytes,
            target_bytes,
            process_bytes,
        } = *memory;
        Self {
            plugin_bytes,
            scene_bytes,
            target_bytes,
            process_bytes,
        }
    }

    /// All that is on the device.
    pub(super) fn device_bytes(&self) -> u64 {
        self.plugin_bytes + self.scene_bytes + self.target_bytes
    }

    /// What the process grew by where it is known, else what is on the device.
    pub(super) fn peak_bytes(&self) -> u64 {
        self.process_bytes.unwrap_or(0).max(self.device_bytes())
    }
}

impl Report {
    /// Puts together what was measured.
    pub(super) fn new(
        arguments: &BenchArguments,
        made_by: MadeBy,
        stands: &[Stand],
        lanes: &[Lane<'_>],
        baseline: Option<&str>,
    ) -> Outcome<Self> {
        let look = &arguments.look;
        let scenes = stands.iter().enumerate().map(|(index, stand)| {
            let of_scene = || lanes.iter().filter(|lane| lane.stand == index);
            let base = of_scene()
                .find(|lane| Some(&*lane.entry.label) == baseline)
                .and_then(|lane| Times::of(&lane.costs))
                .map(|times| times.frame_ms.median);
            let objects = stand.scene.objects().iter();
            Ok(SceneReport {
                name: stand.name.clone(),
                file: stand.file.to_string_lossy().into_owned(),
                surfels: stand.scene.surfel_count(),
                triangles: objects.map(|object| object.geometry.triangle_count()).sum(),
                renderers: of_scene()
                    .map(|lane| LaneReport::of(lane, base))
                    .collect::<Outcome<_>>()?,
            })
        });
        Ok(Self {
            format: FORMAT,
            made_by,
            size: look.size,
            background: background_text(look.background),
            radius_scale: look.radius_scale,
            path: arguments.path.text(),
            frames: arguments.frames,
            rounds: arguments.rounds.min(arguments.frames),
            warm_up: arguments.warm_up,
            baseline: baseline.map(str::to_owned),
            scenes: scenes.collect::<Outcome<_>>()?,
        })
    }

    /// Labels of the renderers, in their order.
    pub(super) fn labels(&self) -> Vec<&str> {
        let first = self.scenes.first();
        let lanes = first.into_iter().flat_map(|scene| &scene.renderers);
        lanes.map(|lane| &*lane.who.label).collect()
    }
}

impl LaneReport {
    fn of(lane: &Lane<'_>, base_ms: Option<f64>) -> Outcome<Self> {
        let times = Times::of(&lane.costs);
        let median = times.map(|times| times.frame_ms.median);
        let frames_per_second = median.map(|ms| 1000.0 / ms);
        Ok(Self {
            who: Who::of(lane.entry)?,
            unsuitable: lane.unsuitable.clone(),
            times,
            frames_per_second,
            splats_per_second: frames_per_second.map(|fps| fps * lane.surfels_selected as f64),
            ratio: median.zip(base_ms).map(|(ms, base)| ms / base),
            first_image_ms: lane.first_ms,
            switch_ms: Spread::of(lane.switches_ms.iter().copied()),
            memory: lane
                .unsuitable
                .is_none()
                .then(|| MemoryReport::of(&lane.memory)),
        })
    }
}
