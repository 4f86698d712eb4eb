//! One frame by a renderer that is ready: selection, uniforms, the call, replay, composition, read-back.

use super::ids::IdTable;
use super::options::FrameError;
use super::prepare::{Ready, Standing, setting_records};
use super::records::{block_columns, with_scene_record};
use super::request::{FrameRequest, FrameResult, FrameStats, PassTime, Severity};
use super::selection::{self, FrameBuffers, OwnBlock, PlannedDraw};
use super::session::{Drawer, FALLBACK_ID, OnDevice, Stage};
use super::uniforms::{FrameNumbers, frame_uniform, object_uniform};
use super::upload::Extra;
use super::viewport::{LastFrame, SelectorSlot, ViewSlot, ViewportOnDevice, changes_since};
use crate::device::GpuError;
use crate::frame::targets::{self, TargetSpec, host_target_spec};
use crate::frame::{Composition, CpuTargets, Fit, GpuTarget, TargetSet, compose_cpu};
use crate::frame::{Picture, Plane, Show};
use crate::gpu::{Owner, PassTimes, Timings};
use crate::plugins::{CallState, PluginInfo};
use abi_stable::std_types::{RSlice, RSliceMut, RStr};
use glam::DMat4;
use pointstage_plugin_api::Error as PluginError;
use pointstage_plugin_api::abi::commands::CommandListRecord;
use pointstage_plugin_api::abi::{
    BlockRecord, DrawUniform, Format, FrameRecord, FrameUniform, Handle, OutcomeRecord,
    RendererBox, SelectRecord, StatisticRecord, StructureBox, TargetRecord, share_host,
};
use pointstage_plugin_api::manifest::{DeviceKind, TargetEntry};
use pointstage_plugin_api::settings_schema::snapshot;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How long a submitted frame may take before the device counts as hung.
const FRAME_LIMIT: Duration = Duration::from_mins(2);

/// What is common to every way of drawing.
struct Planned<'a> {
    request: &'a FrameRequest,
    uniform: FrameUniform,
    draws: Vec<PlannedDraw<'a>>,
    ids: IdTable,
    /// The structure's owner, whose buffers the draws may name.
    structure: Option<Owner>,
    selection_statistics: Vec<StatisticRecord>,
}

impl Stage {
    /// Draws with the one chosen.
    pub(super) fn draw(
        &mut self,
        request: &FrameRequest,
        drawer: &Drawer,
    ) -> Result<FrameResult, FrameError> {
        // While another scene is being prepared for, the prepared one goes on being drawn.
        let request = &match drawer {
            Drawer::Plugin(_, ready) if ready.key.scene != request.scene.revision() => {
                FrameRequest {
                    scene: Arc::clone(ready.scene()),
                    ..request.clone()
                }
            }
            _ => request.clone(),
        };
        let own_blocks = self.own_blocks(request)?;
        let (info, entry_id) = match drawer {
            Drawer::Plugin(info, _) => (Some(info), info.id.as_str()),
            Drawer::Fallback => (None, FALLBACK_ID),
        };
        let specs = self.target_specs(request, info)?;
        let numbers = self.numbers(request, entry_id);
        let uniform = frame_uniform(request, numbers);
        let planned = self.plan(request, uniform, &own_blocks)?;
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
        result.ids = Arc::new(planned.ids);
        Ok(result)
    }

    fn numbers(&mut self, request: &FrameRequest, id: &str) -> FrameNumbers {
        let slot = self.viewport(request).views.get(id);
        slot.map_or_else(FrameNumbers::default, |slot| FrameNumbers {
            frame_index: slot.frame_index,
            sample_index: slot.sample_index,
        })
    }

    /// The selection: by the structure if it is ready, else all of the scene.
    fn plan<'a>(
        &mut self,
        request: &'a FrameRequest,
        uniform: FrameUniform,
        own_blocks: &'a [OwnBlock],
    ) -> Result<Planned<'a>, FrameError> {
        let objects: Vec<DrawUniform> = request
            .scene
            .objects()
            .iter()
            .map(|object| object_uniform(object, &request.camera))
            .collect();
        let mut ids = IdTable::default();
        let mut planned = Planned {
            request,
            uniform,
            draws: Vec::new(),
            ids: IdTable::default(),
            structure: None,
            selection_statistics: Vec::new(),
        };
        match self.structure(request)? {
            Some((info, Standing::Ready(ready))) => {
                let selected = self.select(request, &uniform, &objects, &info, &ready)?;
                let draws = selection::of_structure(
                    &request.scene,
                    own_blocks,
                    &selected.draws,
                    &objects,
                    &mut ids,
                )
                .map_err(|error| plugin_error(&info, PluginError::failed(error)))?;
                planned.draws = draws;
                planned.structure = self
                    .structure_instance(&info.id)
                    .and_then(|instance| instance.owner);
                planned.selection_statistics = selected.statistics.into_vec();
            }
            Some((info, Standing::Failed(source))) => {
                self.tell(
                    Severity::Error,
                    &info.id,
                    source.to_string(),
                    source.detail.clone(),
                );
                planned.draws = selection::whole_scene(&request.scene, &objects, &mut ids);
            }
            _ => planned.draws = selection::whole_scene(&request.scene, &objects, &mut ids),
        }
        planned.ids = ids;
        Ok(planned)
    }

    /// The structure's own blocks, copied once per preparation.
    fn own_blocks(&mut self, request: &FrameRequest) -> Result<Vec<OwnBlock>, FrameError> {
        match self.structure(request)? {
            Some((info, Standing::Ready(ready))) => ready
                .own_blocks()
                .map_err(|source| plugin_error(&info, source))
                .map(<[OwnBlock]>::to_vec),
            _ => Ok(Vec::new()),
        }
    }

    fn select(
        &mut self,
        request: &FrameRequest,
        uniform: &FrameUniform,
        objects: &[DrawUniform],
        info: &Arc<PluginInfo>,
        ready: &Arc<Ready<StructureBox>>,
    ) -> Result<pointstage_plugin_api::abi::SelectionRecord, FrameError> {
        let host = self
            .structure_instance(&info.id)
            .map(|instance| share_host(&instance.host));
        let owner = self
            .structure_instance(&info.id)
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
                world_from_view: world_from_view(request),
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
                .replay(owner, &selected.commands, Timings::Off)?;
        }
        Ok(selected)
    }

    /// The targets that are asked for and that the renderer gives, in the host's order.
    fn target_specs(
        &self,
        request: &FrameRequest,
        info: Option<&Arc<PluginInfo>>,
    ) -> Result<Vec<TargetSpec>, FrameError> {
        let given = given_targets(info);
        let id = info.map_or(FALLBACK_ID, |info| &info.id);
        let mut wanted = vec![targets::COLOUR, targets::DEPTH];
        if let Show::Target(key) = &request.show {
            if !given.iter().any(|spec| spec.key == *key) && self.is_asked_for(request, info) {
                let given = given
                    .iter()
                    .map(|spec| spec.key.as_ref())
                    .collect::<Vec<_>>()
                    .join(", ");
                return Err(FrameError::NoTarget {
                    renderer: id.into(),
                    key: key.clone(),
                    given,
                });
            }
            wanted.push(key);
        }
        wanted.extend(request.read_back.iter().map(String::as_str));
        Ok(given
            .into_iter()
            .filter(|spec| wanted.contains(&spec.key.as_ref()))
            .collect())
    }

    /// Whether this is the renderer of the request, not a stand-in.
    fn is_asked_for(&self, request: &FrameRequest, info: Option<&Arc<PluginInfo>>) -> bool {
        match info {
            Some(info) => self
                .registry
                .find_renderer(&request.renderer)
                .is_ok_and(|asked| asked.id == info.id),
            None => request.renderer == FALLBACK_ID,
        }
    }

    fn draw_on_device(
        &mut self,
        planned: &Planned<'_>,
        specs: &[TargetSpec],
        info: &Arc<PluginInfo>,
        ready: &Arc<Ready<RendererBox>>,
    ) -> Result<FrameResult, FrameError> {
        let request = planned.request;
        let (slot, mut on_viewport) = self.borrow_view(request, info, ready)?;
        let mut slot = slot;
        let outcome = self.render_on_device(planned, specs, info, &mut slot, &mut on_viewport);
        let viewport = self.viewport(request);
        viewport.gpu = on_viewport;
        if outcome.is_ok() {
            viewport.views.insert(info.id.clone(), slot);
        }
        outcome
    }

    /// Takes the view (a new one if it is prepared anew) and the viewport's things out of the viewport for one frame.
    fn borrow_view(
        &mut self,
        request: &FrameRequest,
        info: &Arc<PluginInfo>,
        ready: &Arc<Ready<RendererBox>>,
    ) -> Result<(ViewSlot, Option<ViewportOnDevice>), FrameError> {
        let host = self
            .renderer_instance(&info.id)
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
                }
            }
        };
        Ok((slot, viewport.gpu.take()))
    }

    fn render_on_device(
        &mut self,
        planned: &Planned<'_>,
        specs: &[TargetSpec],
        info: &Arc<PluginInfo>,
        slot: &mut ViewSlot,
        on_viewport: &mut Option<ViewportOnDevice>,
    ) -> Result<FrameResult, FrameError> {
        let thread_count = self.thread_count();
        let owner = self
            .renderer_instance(&info.id)
            .and_then(|instance| instance.owner);
        let (Some(gpu), Some(owner)) = (&self.gpu, owner) else {
            return Err(plugin_error(
                info,
                PluginError::failed("there is no device"),
            ));
        };
        let request = planned.request;
        let blocks = planned.draws.iter().map(|draw| draw.block);
        gpu.scene
            .update(&request.scene, blocks, &Extra::of(&info.entry.needs))?;
        let on_viewport = fit(
            gpu,
            on_viewport,
            request.size_px,
            specs,
            planned.draws.len(),
        )?;
        on_viewport.buffers.write(&planned.uniform, &planned.draws);
        clear(gpu, &on_viewport.targets)?;
        let groups = selection::draw_groups(
            &planned.draws,
            &gpu.scene,
            &gpu.device,
            &gpu.service,
            planned.structure,
        )?;
        let targets: Vec<TargetRecord<'_>> = on_viewport
            .handles
            .iter()
            .zip(specs)
            .map(|((key, texture), spec)| TargetRecord {
                key: RStr::from_str(key),
                format: spec.format,
                texture: *texture,
            })
            .collect();
        let place = |number: usize| (on_viewport.buffers.offset(number), groups[number]);
        let lookup = |content: *const u8| gpu.scene.handle(content);
        let frame = FrameParts {
            planned,
            info,
            group: on_viewport.buffers.group(),
            targets: &targets,
            thread_count,
        };
        let plugin_start = Instant::now();
        let outcome = render(&frame, slot, None, &lookup, place)?;
        let plugin_cpu = plugin_start.elapsed();
        let device_start = Instant::now();
        let mut replay = gpu
            .service
            .replay(owner, &outcome.commands, Timings::On)
            .map_err(|error| as_plugins(info, error))?;
        replay.wait(FRAME_LIMIT)?;
        let device_wall = device_start.elapsed();
        let times = replay.times();
        let (plugin_bytes, timeout) = (gpu.service.bytes(owner), FRAME_LIMIT);
        gpu.scene.drop_draw_groups();
        let composition = composition(request, specs, &planned.uniform);
        let read_back: Vec<&str> = read_back_keys(request, specs).collect();
        let Some(gpu) = &mut self.gpu else {
            unreachable!("borrowed above")
        };
        let composed =
            gpu.composer
                .compose(&on_viewport.targets, &composition, &read_back, timeout)?;
        let stats = FrameStats {
            plugin_cpu,
            device_wall,
            passes: match times {
                PassTimes::Known(times) => times
                    .into_iter()
                    .map(|pass| PassTime {
                        label: pass.label,
                        time: pass.time,
                    })
                    .collect(),
                _ => Vec::new(),
            },
            plugin_bytes,
            ..FrameStats::default()
        };
        let crate::frame::compose::ComposedFrame { composed, planes } = composed;
        Ok(result(
            info,
            composed.picture,
            planes,
            composed.range,
            stats,
            &outcome,
        ))
    }

    /// CPU renderers and the fallback: planes instead of textures, and composition's CPU twin.
    fn draw_on_cpu(
        &mut self,
        planned: &Planned<'_>,
        specs: &[TargetSpec],
        plugin: Option<(&Arc<PluginInfo>, &Arc<Ready<RendererBox>>)>,
    ) -> Result<FrameResult, FrameError> {
        let request = planned.request;
        let thread_count = self.thread_count();
        let mut targets = self
            .viewport(request)
            .cpu_targets
            .take()
            .unwrap_or_else(|| CpuTargets::new(request.size_px, specs));
        targets.fit(request.size_px, specs);
        targets.clear();
        let start = Instant::now();
        let outcome = match plugin {
            None => Ok(self.draw_fallback(planned, &mut targets)),
            Some((info, ready)) => {
                self.borrow_view(request, info, ready)
                    .and_then(|(mut slot, on_viewport)| {
                        self.viewport(request).gpu = on_viewport;
                        let frame = FrameParts {
                            planned,
                            info,
                            group: Handle::NONE,
                            targets: &[],
                            thread_count,
                        };
                        let lookup = |_: *const u8| Handle::NONE;
                        let outcome =
                            render(&frame, &mut slot, Some(&mut targets), &lookup, |_| {
                                (0, Handle::NONE)
                            })?;
                        self.viewport(request).views.insert(info.id.clone(), slot);
                        Ok(outcome)
                    })
            }
        };
        let plugin_cpu = start.elapsed();
        let finished = outcome.map(|outcome| {
            let composed =
                compose_cpu::compose(&targets, &composition(request, specs, &planned.uniform));
            let (picture, range) = composed.map_or_else(
                || (empty_picture(request.size_px), None),
                |c| (c.picture, c.range),
            );
            let planes = read_back_keys(request, specs)
                .filter_map(|key| Some((key.to_owned(), targets.read(key)?)))
                .collect();
            let stats = FrameStats {
                plugin_cpu,
                ..FrameStats::default()
            };
            let mut drawn = result_of(
                plugin.map(|(info, _)| info),
                picture,
                planes,
                range,
                stats,
                outcome.progress,
            );
            add_statistics(&mut drawn.stats.reported, &outcome.statistics);
            drawn
        });
        self.viewport(request).cpu_targets = Some(targets);
        finished
    }

    fn draw_fallback(&mut self, planned: &Planned<'_>, targets: &mut CpuTargets) -> OutcomeRecord {
        let blocks = block_records(planned, &|_| Handle::NONE);
        let blocks: Vec<BlockRecord<'_>> = blocks.iter().map(BlockParts::record).collect();
        let records = selection::draw_records(&planned.draws, &blocks, |_| (0, Handle::NONE));
        let fallback = &mut self.viewport(planned.request).fallback;
        fallback.draw(&planned.uniform, &records, targets, &|| false);
        OutcomeRecord {
            progress: 1.0,
            commands: CommandListRecord::default(),
            statistics: Vec::new().into(),
        }
    }
}

/// What the call of a view needs beside the view.
struct FrameParts<'a> {
    planned: &'a Planned<'a>,
    info: &'a Arc<PluginInfo>,
    group: Handle,
    targets: &'a [TargetRecord<'a>],
    thread_count: usize,
}

/// A block's columns, held while its record is lent.
struct BlockParts<'a> {
    columns: Vec<pointstage_plugin_api::abi::ColumnRecord<'a>>,
    surfel_count: u32,
}

impl<'a> BlockParts<'a> {
    fn record(&'a self) -> BlockRecord<'a> {
        let columns = RSlice::from_slice(&self.columns);
        BlockRecord {
            first_surfel: 0,
            surfel_count: self.surfel_count,
            columns,
        }
    }
}

fn block_records<'a>(
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

/// Calls the view.
fn render(
    frame: &FrameParts<'_>,
    slot: &mut ViewSlot,
    mut cpu_targets: Option<&mut CpuTargets>,
    lookup: &dyn Fn(*const u8) -> Handle,
    place: impl Fn(usize) -> (u32, Handle),
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
    let call = Arc::new(CallState::new());
    let outcome = with_scene_record(&request.scene, lookup, |scene| {
        let mut planes = cpu_targets
            .as_mut()
            .map(|targets| targets.records())
            .unwrap_or_default();
        let mut record = FrameRecord {
            uniform: planned.uniform,
            frame_group: group,
            world_from_view: world_from_view(request),
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

/// Makes the viewport's targets and buffers fit.
fn fit<'v>(
    gpu: &OnDevice,
    on_viewport: &'v mut Option<ViewportOnDevice>,
    size_px: [u32; 2],
    specs: &[TargetSpec],
    draw_count: usize,
) -> Result<&'v mut ViewportOnDevice, GpuError> {
    if on_viewport.is_none() {
        let mut targets = TargetSet::default();
        targets.fit(&gpu.device, size_px, specs)?;
        let buffers = FrameBuffers::new(&gpu.device, &gpu.service, draw_count)?;
        *on_viewport = Some(ViewportOnDevice {
            handles: import(gpu, &targets),
            targets,
            buffers,
        });
    }
    let Some(fitted) = on_viewport else {
        unreachable!("made above")
    };
    if fitted.targets.fit(&gpu.device, size_px, specs)? == Fit::Changed {
        fitted
            .handles
            .iter()
            .for_each(|(_, handle)| gpu.service.release(*handle));
        fitted.handles = import(gpu, &fitted.targets);
    }
    if !fitted.buffers.fits(draw_count) {
        fitted.buffers = FrameBuffers::new(&gpu.device, &gpu.service, draw_count)?;
    }
    Ok(fitted)
}

fn import(gpu: &OnDevice, targets: &TargetSet) -> Vec<(String, Handle)> {
    let import = |target: &GpuTarget| {
        (
            target.spec.key.to_string(),
            gpu.service.import_texture(target.texture.clone()),
        )
    };
    targets.targets().iter().map(import).collect()
}

fn clear(gpu: &OnDevice, targets: &TargetSet) -> Result<(), GpuError> {
    gpu.device.scoped(|| {
        let mut encoder = gpu
            .device
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        targets.clear(&gpu.device, &mut encoder);
        gpu.device.queue.submit([encoder.finish()]);
    })
}

/// Keys to read back, of the targets that there are.
fn read_back_keys<'a>(
    request: &'a FrameRequest,
    specs: &'a [TargetSpec],
) -> impl Iterator<Item = &'a str> {
    let asked = |key: &&str| request.read_back.iter().any(|asked| asked == key);
    specs.iter().map(|spec| spec.key.as_ref()).filter(asked)
}

fn composition(
    request: &FrameRequest,
    specs: &[TargetSpec],
    uniform: &FrameUniform,
) -> Composition {
    let shown = match &request.show {
        Show::Target(key) => specs.iter().find(|spec| spec.key == *key),
        Show::Colours => None,
    };
    let colours = host_target_spec(targets::COLOUR).expect("the host's own target");
    Composition::of_frame(
        shown.unwrap_or(colours),
        request.background,
        request.exposure,
        uniform,
    )
}

/// Targets that a renderer gives, in the host's order, then its own.
pub(super) fn given_targets(info: Option<&Arc<PluginInfo>>) -> Vec<TargetSpec> {
    let Some(info) = info else {
        return crate::frame::fallback::TARGETS
            .iter()
            .filter_map(|key| host_target_spec(key).cloned())
            .collect();
    };
    let given = &info.entry.gives.targets;
    let host = targets::HOST_TARGETS
        .iter()
        .filter(|spec| given.iter().any(|target| target.key == spec.key))
        .cloned();
    let own = given
        .iter()
        .filter(|target| host_target_spec(&target.key).is_none());
    host.chain(own.filter_map(own_spec)).collect()
}

/// A target that the plugin declares itself; none if the declaration is not usable.
fn own_spec(target: &TargetEntry) -> Option<TargetSpec> {
    let format = target.format.as_deref().and_then(Format::from_name)?;
    TargetSpec::declared(
        &target.key,
        format,
        target.clear.unwrap_or_default(),
        &target.meaning,
    )
    .ok()
}

fn result(
    info: &Arc<PluginInfo>,
    picture: Picture,
    planes: BTreeMap<String, Plane>,
    range: Option<[f32; 2]>,
    stats: FrameStats,
    outcome: &OutcomeRecord,
) -> FrameResult {
    let mut result = result_of(Some(info), picture, planes, range, stats, outcome.progress);
    add_statistics(&mut result.stats.reported, &outcome.statistics);
    result
}

fn result_of(
    info: Option<&Arc<PluginInfo>>,
    picture: Picture,
    planes: BTreeMap<String, Plane>,
    range: Option<[f32; 2]>,
    stats: FrameStats,
    progress: f32,
) -> FrameResult {
    FrameResult {
        picture,
        planes,
        available_targets: given_targets(info)
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
    }
}

fn add_statistics(reported: &mut BTreeMap<String, f64>, statistics: &[StatisticRecord]) {
    reported.extend(
        statistics
            .iter()
            .map(|statistic| (statistic.key.to_string(), statistic.value)),
    );
}

fn empty_picture(size_px: [u32; 2]) -> Picture {
    Picture {
        size_px,
        rgba: vec![0; size_px[0] as usize * size_px[1] as usize * 4].into(),
    }
}

fn world_from_view(request: &FrameRequest) -> [f64; 16] {
    let matrix: DMat4 = request.camera.view_from_world().inverse();
    matrix.to_cols_array()
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
