//! The call of a renderer's view.

use super::plan::Planned;
use super::{plugin_error, world_from_view};
use crate::frame::CpuTargets;
use crate::plugins::{CallState, PluginInfo};
use crate::stage::options::FrameError;
use crate::stage::prepare::{Ready, setting_records};
use crate::stage::records::{block_columns, with_scene_record};
use crate::stage::request::FrameRequest;
use crate::stage::selection;
use crate::stage::session::Stage;
use crate::stage::viewport::{LastFrame, ViewSlot, ViewportOnDevice, changes_since};
use abi_stable::std_types::{RSlice, RSliceMut, RStr};
use pointstage_plugin_api::abi::{
    BlockRecord, ColumnRecord, FrameRecord, Handle, OutcomeRecord, RendererBox, TargetRecord,
    share_host,
};
use pointstage_plugin_api::settings_schema::snapshot;
use pointstage_plugin_api::{Error as PluginError, ErrorCode};
use std::sync::Arc;
use std::time::Instant;

/// What the call of a view needs beside the view.
pub(super) struct FrameParts<'a> {
    pub planned: &'a Planned<'a>,
    pub info: &'a Arc<PluginInfo>,
    pub group: Handle,
    pub targets: &'a [TargetRecord<'a>],
    pub thread_count: usize,
}

/// A block's columns, held while its record is lent.
pub(super) struct BlockParts<'a> {
    columns: Vec<ColumnRecord<'a>>,
    surfel_count: u32,
}

impl<'a> BlockParts<'a> {
    pub(super) fn record(&'a self) -> BlockRecord<'a> {
        let columns = RSlice::from_slice(&self.columns);
        BlockRecord {
            first_surfel: 0,
            surfel_count: self.surfel_count,
            columns,
        }
    }
}

/// The columns of every draw's block.
pub(super) fn block_records<'a>(
    planned: &'a Planned<'_>,
    lookup: &dyn Fn(*const u8) -> Handle,
) -> Vec<BlockParts<'a>> {
    let objects = planned.request.scene.objects();
    let parts = planned.draws.iter().map(|draw| BlockParts {
        columns: block_columns(draw.block, &objects[draw.object as usize], lookup),
        surfel_count: draw.block.len() as u32,
    });
    parts.collect()
}

/// Calls the view, within the frame's time budget. One that gives up for want of time draws again without a budget, and
/// has none from then on: late is better than nothing.
pub(super) fn render(
    frame: &FrameParts<'_>,
    slot: &mut ViewSlot,
    mut cpu_targets: Option<&mut CpuTargets>,
    lookup: &dyn Fn(*const u8) -> Handle,
    place: &dyn Fn(usize) -> (u32, Handle),
) -> Result<OutcomeRecord, FrameError> {
    let budget = frame.planned.request.time_budget;
    let budget = budget.filter(|_| !slot.gives_up);
    let deadline = budget.and_then(|budget| Instant::now().checked_add(budget));
    let call = deadline.map_or_else(CallState::new, CallState::with_deadline);
    let outcome = call_view(
        frame,
        slot,
        cpu_targets.as_deref_mut(),
        lookup,
        place,
        &call,
    );
    match outcome {
        Err(FrameError::Plugin { source, .. })
            if deadline.is_some() && source.code == ErrorCode::CANCELLED =>
        {
            slot.gives_up = true;
            if let Some(cpu_targets) = &mut cpu_targets {
                cpu_targets.clear();
            }
            call_view(frame, slot, cpu_targets, lookup, place, &CallState::new())
        }
        outcome => outcome,
    }
}

fn call_view(
    frame: &FrameParts<'_>,
    slot: &mut ViewSlot,
    mut cpu_targets: Option<&mut CpuTargets>,
    lookup: &dyn Fn(*const u8) -> Handle,
    place: &dyn Fn(usize) -> (u32, Handle),
    call: &CallState,
) -> Result<OutcomeRecord, FrameError> {
    let FrameParts {
        planned,
        info,
        group,
        targets,
        thread_count,
    } = *frame;
    let request = planned.request;
    let keys: Vec<String> = match &cpu_targets {
        None => targets
            .iter()
            .map(|target| target.key.as_str().to_owned())
            .collect(),
        Some(cpu_targets) => cpu_targets
            .planes()
            .iter()
            .map(|plane| plane.spec.key.to_string())
            .collect(),
    };
    let (changes, changed) = changes_since(slot.last.as_ref(), request, &keys);
    let changed: Vec<RStr<'_>> = changed.iter().map(|id| RStr::from_str(id)).collect();
    let actions: Vec<RStr<'_>> = request
        .actions
        .iter()
        .map(|id| RStr::from_str(id))
        .collect();
    let values = snapshot(&info.entry.settings, &request.settings)?;
    let settings = setting_records(&values);
    let blocks = block_records(planned, lookup);
    let blocks: Vec<BlockRecord<'_>> = blocks.iter().map(BlockParts::record).collect();
    let draws = selection::draw_records(&planned.draws, &blocks, place);
    let outcome = with_scene_record(&request.scene, lookup, |scene| {
        let mut planes = cpu_targets
            .as_mut()
            .map(|targets| targets.records())
            .unwrap_or_default();
        let mut record = FrameRecord {
            uniform: planned.uniform,
            frame_group: group,
            world_from_view: world_from_view(request).to_cols_array(),
            size_px: request.size_px,
            scene,
            draws: RSlice::from_slice(&draws),
            settings: RSlice::from_slice(&settings),
            actions: RSlice::from_slice(&actions),
            targets: RSlice::from_slice(targets),
            planes: RSliceMut::from_mut_slice(&mut planes),
            interaction: request.interaction,
            purpose: request.purpose,
            changes,
            changed_settings: RSlice::from_slice(&changed),
            thread_count: thread_count as u32,
            call: call.border(),
        };
        slot.view.render(&mut record)
    });
    let outcome = outcome
        .into_result()
        .map_err(|error| plugin_error(info, error.into()))?;
    slot.frame_index = slot.frame_index.wrapping_add(1);
    let still = changes.0 == 0;
    slot.sample_index = if still {
        slot.sample_index.saturating_add(1)
    } else {
        1
    };
    slot.last = Some(LastFrame::new(request, keys));
    Ok(outcome)
}

impl Stage {
    /// Takes the view (a new one if it is prepared anew) and the viewport's things out of the viewport for one frame.
    pub(super) fn borrow_view(
        &mut self,
        request: &FrameRequest,
        info: &Arc<PluginInfo>,
        ready: &Arc<Ready<RendererBox>>,
    ) -> Result<(ViewSlot, Option<ViewportOnDevice>), FrameError> {
        let host = self
            .renderer_instance(info)
            .map(|instance| share_host(&instance.host));
        let viewport = self.viewport(request);
        let slot = viewport
            .views
            .remove(&info.id)
            .filter(|slot| Arc::ptr_eq(&slot.ready, ready));
        let slot = match (slot, host) {
            (Some(slot), _) => slot,
            (None, None) => return Err(plugin_error(info, PluginError::failed("it is gone"))),
            (None, Some(host)) => {
                let view = ready
                    .product
                    .view(host)
                    .into_result()
                    .map_err(|error| plugin_error(info, error.into()))?;
                ViewSlot {
                    view,
                    ready: Arc::clone(ready),
                    last: None,
                    frame_index: 0,
                    sample_index: 0,
                    gives_up: false,
                }
            }
        };
        Ok((slot, viewport.gpu.take()))
    }
}
