//! What a frame draws: the structure's selection, or all of the scene.

use super::{as_plugins, plugin_error, world_from_view};
use crate::gpu::{Owner, Timings};
use crate::plugins::{CallState, PluginInfo};
use crate::stage::ids::IdTable;
use crate::stage::options::FrameError;
use crate::stage::prepare::{Ready, setting_records};
use crate::stage::records::with_scene_record;
use crate::stage::request::FrameRequest;
use crate::stage::selection::{self, OwnBlock, PlannedDraw};
use crate::stage::session::{Selecting, Stage};
use crate::stage::uniforms::object_uniform;
use crate::stage::viewport::SelectorSlot;
use abi_stable::std_types::RSlice;
use pointstage_plugin_api::Error as PluginError;
use pointstage_plugin_api::abi::{
    DrawUniform, FrameUniform, Handle, SelectRecord, SelectionRecord, StatisticRecord,
    StructureBox, share_host,
};
use pointstage_plugin_api::settings_schema::snapshot;
use std::sync::Arc;
/// What is common to every way of drawing.
pub(super) struct Planned<'a> {
    pub request: &'a FrameRequest,
    pub uniform: FrameUniform,
    pub draws: Vec<PlannedDraw<'a>>,
    pub ids: IdTable,
    /// The structure's owner, whose buffers the draws may name.
    pub structure: Option<Owner>,
    pub selection_statistics: Vec<StatisticRecord>,
}

impl Stage {
    /// The selection: by the structure if it is ready, else all of the scene.
    pub(super) fn plan<'a>(
        &mut self,
        request: &'a FrameRequest,
        uniform: FrameUniform,
        structure: Option<&'a Selecting>,
    ) -> Result<Planned<'a>, FrameError> {
        let objects: Vec<DrawUniform> = request
            .scene
            .objects()
            .iter()
            .map(|object| object_uniform(object, &request.camera))
            .collect();
        let mut planned = Planned {
            request,
            uniform,
            draws: Vec::new(),
            ids: IdTable::default(),
            structure: None,
            selection_statistics: Vec::new(),
        };
        if let Some((info, ready)) = structure {
            let own_blocks = ready
                .own_blocks()
                .map_err(|source| plugin_error(info, source))?;
            self.plan_selection(&mut planned, &objects, info, ready, own_blocks)?;
            return Ok(planned);
        }
        planned.draws = selection::whole_scene(&request.scene, &objects, &mut planned.ids);
        Ok(planned)
    }

    /// Fills the plan with what the structure selects.
    fn plan_selection<'a>(
        &mut self,
        planned: &mut Planned<'a>,
        objects: &[DrawUniform],
        info: &Arc<PluginInfo>,
        ready: &Arc<Ready<StructureBox>>,
        own_blocks: &'a [OwnBlock],
    ) -> Result<(), FrameError> {
        let selected = self.select(planned.request, &planned.uniform, objects, info, ready)?;
        planned.draws = selection::of_structure(
            &planned.request.scene,
            own_blocks,
            &selected.draws,
            objects,
            &mut planned.ids,
        )
        .map_err(|error| plugin_error(info, PluginError::failed(error)))?;
        planned.structure = self
            .structure_instance(info)
            .and_then(|instance| instance.owner);
        planned.selection_statistics = selected.statistics.into_vec();
        Ok(())
    }

    /// Asks the viewport's selector, a new one if the structure was prepared anew, and replays its commands.
    fn select(
        &mut self,
        request: &FrameRequest,
        uniform: &FrameUniform,
        objects: &[DrawUniform],
        info: &Arc<PluginInfo>,
        ready: &Arc<Ready<StructureBox>>,
    ) -> Result<SelectionRecord, FrameError> {
        let host = self
            .structure_instance(info)
            .map(|instance| share_host(&instance.host));
        let owner = self
            .structure_instance(info)
            .and_then(|instance| instance.owner);
        let settings = snapshot(&info.entry.settings, &request.structure_settings)?;
        let on_device = self.gpu.as_ref().map(|gpu| Arc::clone(&gpu.scene));
        let viewport = self.viewport(request);
        if viewport
            .selectors
            .get(&info.id)
            .is_none_or(|slot| !Arc::ptr_eq(&slot.ready, ready))
        {
            let Some(host) = host else {
                return Err(plugin_error(info, PluginError::failed("it is gone")));
            };
            let selector = ready
                .product
                .selector(host)
                .into_result()
                .map_err(|error| plugin_error(info, error.into()))?;
            viewport.selectors.insert(
                info.id.clone(),
                SelectorSlot {
                    selector,
                    ready: Arc::clone(ready),
                },
            );
        }
        let Some(slot) = viewport.selectors.get_mut(&info.id) else {
            unreachable!("inserted above")
        };
        let call = Arc::new(CallState::new());
        let settings = setting_records(&settings);
        let lookup = |content: *const u8| {
            on_device
                .as_ref()
                .map_or(Handle::NONE, |on_device| on_device.handle(content))
        };
        let outcome = with_scene_record(&request.scene, &lookup, |scene| {
            slot.selector.select(&SelectRecord {
                uniform: *uniform,
                world_from_view: world_from_view(request).to_cols_array(),
                scene,
                objects: RSlice::from_slice(objects),
                settings: RSlice::from_slice(&settings),
                interaction: request.interaction,
                call: call.border(),
            })
        });
        let selected = outcome.into_result().map_err(|error| {
            viewport.selectors.remove(&info.id);
            plugin_error(info, error.into())
        })?;
        if let (Some(gpu), Some(owner)) = (&self.gpu, owner)
            && !selected.commands.commands.is_empty()
        {
            gpu.service
                .replay(owner, &selected.commands, Timings::Off)
                .map_err(|error| as_plugins(info, error))?;
        }
        Ok(selected)
    }
}
