//! Drawing on the device: upload, targets, replay of the plugin's commands, composition.

use super::call::{FrameParts, render};
use super::plan::Planned;
use super::targets::{composition, read_back_keys};
use super::{Drawn, as_plugins, plugin_error, result_of};
use crate::device::GpuError;
use crate::frame::compose::ComposedFrame;
use crate::frame::{Fit, GpuTarget, TargetSet, targets::TargetSpec};
use crate::gpu::{PassTimes, Timings};
use crate::plugins::PluginInfo;
use crate::stage::options::FrameError;
use crate::stage::prepare::Ready;
use crate::stage::request::{FrameResult, FrameStats};
use crate::stage::selection::{self, FrameBuffers};
use crate::stage::session::{OnDevice, Stage};
use crate::stage::upload::Extra;
use crate::stage::viewport::{ViewSlot, ViewportOnDevice};
use abi_stable::std_types::RStr;
use pointstage_plugin_api::Error as PluginError;
use pointstage_plugin_api::abi::{Handle, RendererBox, TargetRecord};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How long a submitted frame may take before the device counts as hung.
const FRAME_LIMIT: Duration = Duration::from_mins(2);

impl Stage {
    pub(super) fn draw_on_device(
        &mut self,
        planned: &Planned<'_>,
        specs: &[TargetSpec],
        info: &Arc<PluginInfo>,
        ready: &Arc<Ready<RendererBox>>,
    ) -> Result<FrameResult, FrameError> {
        let request = planned.request;
        let (mut slot, mut on_viewport) = self.borrow_view(request, info, ready)?;
        let outcome = self.render_on_device(planned, specs, info, &mut slot, &mut on_viewport);
        let viewport = self.viewport(request);
        viewport.gpu = on_viewport;
        if outcome.is_ok() {
            viewport.views.insert(info.id.clone(), slot);
        }
        outcome
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
            .renderer_instance(info)
            .and_then(|instance| instance.owner);
        let (Some(gpu), Some(owner)) = (&self.gpu, owner) else {
            return Err(plugin_error(
                info,
                PluginError::failed("there is no device"),
            ));
        };
        let request = planned.request;
        let blocks = planned.draws.iter().map(|draw| draw.block);
        gpu.scene.update(
            request.viewport,
            &request.scene,
            blocks,
            &Extra::of(&info.entry.needs),
        )?;
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
        let outcome = render(&frame, slot, None, &lookup, &place)?;
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
                PassTimes::Known(times) => times,
                _ => Vec::new(),
            },
            plugin_bytes,
            target_bytes: on_viewport.targets.bytes(),
            ..FrameStats::default()
        };
        let ComposedFrame { composed, planes } = composed;
        let drawn = Drawn {
            picture: composed.picture,
            range: composed.range,
            planes,
            stats,
        };
        Ok(result_of(Some(info), drawn, &outcome))
    }
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
