//! Drawing on the CPU, by plugins and by the fallback: planes instead of textures, and composition's CPU twin.

use super::call::{BlockParts, FrameParts, block_records, render};
use super::plan::Planned;
use super::targets::{composition, read_back_keys};
use super::{Drawn, result_of};
use crate::frame::{CpuTargets, Picture, compose_cpu, targets::TargetSpec};
use crate::plugins::PluginInfo;
use crate::stage::options::FrameError;
use crate::stage::prepare::Ready;
use crate::stage::request::{FrameResult, FrameStats};
use crate::stage::selection;
use crate::stage::session::Stage;
use pointstage_plugin_api::abi::commands::CommandListRecord;
use pointstage_plugin_api::abi::{BlockRecord, Handle, OutcomeRecord, RendererBox};
use std::sync::Arc;
use std::time::Instant;

impl Stage {
    /// CPU renderers and the fallback: planes instead of textures, and composition's CPU twin.
    pub(super) fn draw_on_cpu(
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
                            render(&frame, &mut slot, Some(&mut targets), &lookup, &|_| {
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
            let drawn = Drawn {
                picture,
                range,
                planes,
                stats,
            };
            result_of(plugin.map(|(info, _)| info), drawn, &outcome)
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

fn empty_picture(size_px: [u32; 2]) -> Picture {
    Picture {
        size_px,
        rgba: vec![0; size_px[0] as usize * size_px[1] as usize * 4].into(),
    }
}
