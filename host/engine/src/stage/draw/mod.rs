//! One frame by a renderer that is ready: selection, uniforms, the call, replay, composition, read-back.

mod call;
mod cpu;
mod device;
mod plan;
mod targets;

pub(super) use targets::given_targets;

use super::options::FrameError;
use super::request::{FrameRequest, FrameResult, FrameStats, Show};
use super::session::{Drawer, FALLBACK_ID, Selecting, Stage};
use super::uniforms::{FrameNumbers, frame_uniform};
use crate::device::GpuError;
use crate::frame::highlight::highlight;
use crate::frame::targets::ID;
use crate::frame::{Picture, Plane};
use crate::plugins::PluginInfo;
use glam::DMat4;
use pointstage_plugin_api::Error as PluginError;
use pointstage_plugin_api::abi::{FrameUniform, OutcomeRecord, StatisticRecord};
use pointstage_plugin_api::manifest::DeviceKind;
use std::collections::BTreeMap;
use std::sync::Arc;

impl Stage {
    /// Draws with the ones chosen.
    pub(super) fn draw(
        &mut self,
        request: &FrameRequest,
        drawer: &Drawer,
        structure: Option<&Selecting>,
    ) -> Result<FrameResult, FrameError> {
        // While another scene is being prepared for, the prepared one goes on being drawn.
        let mut drawn = request.clone();
        if let Drawer::Plugin(_, ready) = drawer
            && ready.key.scene != request.scene.revision()
        {
            drawn.scene = Arc::clone(ready.scene());
        }
        let shows_marks = shows_marks(&drawn);
        let asks_for_ids = drawn.read_back.iter().any(|key| key == ID);
        if shows_marks && !asks_for_ids {
            drawn.read_back.push(ID.to_owned());
        }
        let request = &drawn;
        // Its ranges and numbers are of one scene.
        let structure = structure.filter(|(_, ready)| ready.key.scene == request.scene.revision());
        let (info, entry_id) = match drawer {
            Drawer::Plugin(info, _) => (Some(info), info.id.as_str()),
            Drawer::Fallback => (None, FALLBACK_ID),
        };
        let specs = self.target_specs(request, info)?;
        let numbers = self.numbers(request, entry_id);
        let uniform = frame_uniform(request, numbers);
        let planned = self.plan(request, uniform, structure)?;
        let mut result = match drawer {
            Drawer::Plugin(info, ready) if info.entry.needs.device == DeviceKind::Gpu => {
                self.draw_on_device(&planned, &specs, info, ready)?
            }
            Drawer::Plugin(info, ready) => {
                self.draw_on_cpu(&planned, &specs, Some((info, ready)))?
            }
            Drawer::Fallback => self.draw_on_cpu(&planned, &specs, None)?,
        };
        result.stats.surfels_in_scene = request.scene.surfel_count() as u64;
        result.stats.surfels_selected = planned
            .draws
            .iter()
            .map(|draw| u64::from(draw.uniform.count))
            .sum();
        result.stats.scene_bytes = self.gpu.as_ref().map_or(0, |gpu| gpu.scene.bytes());
        add_statistics(&mut result.stats.reported, &planned.selection_statistics);
        result.uniform = planned.uniform;
        if shows_marks && let Some(Plane::Uint(ids)) = result.planes.get(ID) {
            let marked = planned.ids.marked(&request.scene);
            highlight(&mut result.picture, ids, |id| marked.contains(id));
        }
        if !asks_for_ids {
            result.planes.remove(ID);
        }
        result.ids = Arc::new(planned.ids);
        result.scene = Arc::clone(&request.scene);
        result.world_from_view = world_from_view(request);
        Ok(result)
    }

    fn numbers(&mut self, request: &FrameRequest, id: &str) -> FrameNumbers {
        let slot = self.viewport(request).views.get(id);
        slot.map_or_else(FrameNumbers::default, |slot| FrameNumbers {
            frame_index: slot.frame_index,
            sample_index: slot.sample_index,
        })
    }
}

/// Whether a picture has marks to show: over colours only, since a target's colours mean values.
fn shows_marks(request: &FrameRequest) -> bool {
    request.shows_marks && request.show == Show::Colours && request.scene.marked_count() > 0
}

/// What either way of drawing gives.
struct Drawn {
    picture: Picture,
    range: Option<[f32; 2]>,
    planes: BTreeMap<String, Plane>,
    stats: FrameStats,
}

fn result_of(info: Option<&Arc<PluginInfo>>, drawn: Drawn, outcome: &OutcomeRecord) -> FrameResult {
    let Drawn {
        picture,
        range,
        planes,
        mut stats,
    } = drawn;
    add_statistics(&mut stats.reported, &outcome.statistics);
    let progress = outcome.progress;
    FrameResult {
        picture,
        planes,
        available_targets: targets::given_targets(info)
            .into_iter()
            .map(|spec| spec.key.into_owned())
            .collect(),
        drawn_by: info.map_or(FALLBACK_ID, |info| &info.id).to_owned(),
        shown_range: range,
        stats,
        progress: if progress.is_finite() {
            progress.clamp(0.0, 1.0)
        } else {
            1.0
        },
        preparing: None,
        notices: Vec::new(),
        ids: Arc::default(),
        scene: Arc::default(),
        uniform: FrameUniform::default(),
        world_from_view: DMat4::IDENTITY,
    }
}

fn add_statistics(reported: &mut BTreeMap<String, f64>, statistics: &[StatisticRecord]) {
    reported.extend(
        statistics
            .iter()
            .map(|statistic| (statistic.key.to_string(), statistic.value)),
    );
}

/// Moves points from view space into the world.
fn world_from_view(request: &FrameRequest) -> DMat4 {
    request.camera.view_from_world().inverse()
}

fn plugin_error(info: &Arc<PluginInfo>, source: PluginError) -> FrameError {
    FrameError::Plugin {
        plugin: info.id.clone(),
        source,
    }
}

/// An error in a plugin's commands is the plugin's; a lost device is not.
fn as_plugins(info: &Arc<PluginInfo>, error: GpuError) -> FrameError {
    if matches!(error, GpuError::DeviceLost(_)) {
        return FrameError::Device(error);
    }
    let source = PluginError::new(error.code(), error.to_string()).with_detail(error.detail());
    plugin_error(info, source)
}
