//! A renderer on a scene, and what was measured of it.

use std::sync::Arc;

use pointstage_engine::stage::{FrameRequest, FrameStats, Stage};
use pointstage_plugin_api::abi::{Interaction, Purpose};
use pointstage_scene::{Camera, Scene};

use super::{BenchArguments, Stand};
use crate::cli::drawing::Cost;
use crate::cli::measuring::entries::Entry;

/// One of them.
pub(super) struct Lane<'a> {
    pub(super) entry: &'a Entry,
    /// Which scene it draws.
    pub(super) stand: usize,
    /// Why it cannot draw it; nothing else is measured then.
    pub(super) unsuitable: Option<String>,
    /// From the request to the first image, ms.
    pub(super) first_ms: Option<f64>,
    /// Pictures right after another renderer's, ms.
    pub(super) switches_ms: Vec<f64>,
    /// Of the pictures that count.
    pub(super) costs: Vec<Cost>,
    /// Surfels selected in the last picture.
    pub(super) surfels_selected: u64,
    pub(super) memory: Memory,
}

/// The most that was held at a time.
#[allow(
    clippy::struct_field_names,
    reason = "fields carry their unit, and in JSON these are the names"
)]
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Memory {
    /// By the renderer, on the device.
    pub(super) plugin_bytes: u64,
    /// By the scene's columns, on the device.
    pub(super) scene_bytes: u64,
    /// By the targets, on the device.
    pub(super) target_bytes: u64,
    /// By which the process grew until the first image; none where the system does not say.
    pub(super) process_bytes: Option<u64>,
}

impl<'a> Lane<'a> {
    /// Every renderer on every scene, scene by scene.
    pub(super) fn all(stage: &Stage, entries: &'a [Entry], stands: &[Stand]) -> Vec<Self> {
        let lanes = stands
            .iter()
            .enumerate()
            .flat_map(|(stand, Stand { scene, .. })| {
                entries.iter().map(move |entry| Self {
                    entry,
                    stand,
                    unsuitable: entry.reason_against(stage, scene),
                    first_ms: None,
                    switches_ms: Vec::new(),
                    costs: Vec::new(),
                    surfels_selected: 0,
                    memory: Memory::default(),
                })
            });
        lanes.collect()
    }

    /// Remembers what a picture needed.
    pub(super) fn note(&mut self, stats: &FrameStats) {
        self.surfels_selected = stats.surfels_selected;
        let memory = &mut self.memory;
        memory.plugin_bytes = memory.plugin_bytes.max(stats.plugin_bytes);
        memory.scene_bytes = memory.scene_bytes.max(stats.scene_bytes);
        memory.target_bytes = memory.target_bytes.max(stats.target_bytes);
    }

    /// Time spent on pictures that count, s.
    pub(super) fn spent_secs(&self) -> f64 {
        self.costs.iter().map(|cost| cost.wall.as_secs_f64()).sum()
    }
}

/// What a renderer is asked for; all else is the same for everybody.
pub(super) fn request(
    arguments: &BenchArguments,
    entry: &Entry,
    scene: &Arc<Scene>,
    camera: Camera,
) -> FrameRequest {
    let look = &arguments.look;
    FrameRequest {
        settings: entry.settings.clone(),
        background: look.background,
        exposure: look.exposure,
        radius_scale: look.radius_scale,
        purpose: Purpose::COMPARE,
        interaction: Interaction::STILL,
        ..FrameRequest::still(Arc::clone(scene), camera, look.size, entry.id.clone())
    }
}
