//! Opening and closing passes and debug groups.

use super::{Pass, Walk};
use crate::device::GpuError;
use pointstage_plugin_api::abi::commands::{BeginRenderPass, ColourAttachment};

impl<'a> Walk<'a> {
    pub(super) fn open_pass(&self) -> Option<&str> {
        match self.pass {
            Pass::None => None,
            Pass::Render(_) | Pass::Compute(_) => self.passes.last().map(String::as_str),
        }
    }

    /// The encoder, when no pass is open.
    pub(super) fn outside(&mut self) -> Result<&mut wgpu::CommandEncoder, GpuError> {
        match self.open_pass() {
            None => Ok(&mut self.encoder),
            Some(label) => Err(GpuError::validation(format!(
                "the pass '{label}' is open; end it first"
            ))),
        }
    }

    pub(super) fn render(&mut self) -> Result<&mut wgpu::RenderPass<'static>, GpuError> {
        match &mut self.pass {
            Pass::Render(pass) => Ok(pass),
            Pass::None | Pass::Compute(_) => Err(GpuError::validation(
                "no render pass is open; begin one before",
            )),
        }
    }

    pub(super) fn compute(&mut self) -> Result<&mut wgpu::ComputePass<'static>, GpuError> {
        match &mut self.pass {
            Pass::Compute(pass) => Ok(pass),
            Pass::None | Pass::Render(_) => Err(GpuError::validation(
                "no compute pass is open; begin one before",
            )),
        }
    }

    pub(super) fn begin_render_pass(&mut self, begin: BeginRenderPass) -> Result<(), GpuError> {
        self.outside()?;
        let most = self.gpu.limits.max_color_attachments as usize;
        if begin.colours.len() > most {
            return Err(GpuError::validation(format!(
                "{} colour attachments; the device has at most {most}",
                begin.colours.len()
            )));
        }
        let mut colours = Vec::with_capacity(begin.colours.len());
        for (index, attachment) in begin.colours.iter().enumerate() {
            colours.push(match attachment {
                None => None,
                Some(attachment) => Some(
                    self.colour_attachment(attachment)
                        .map_err(|error| error.at(format_args!("colour attachment {index}")))?,
                ),
            });
        }
        let depth = match &begin.depth {
            None => None,
            Some(depth) => {
                let (view, _) = self
                    .table
                    .any_view(self.caller.owner, depth.target)
                    .map_err(|error| error.at("depth attachment"))?;
                let operations = wgpu::Operations {
                    load: depth.clear.map_or(wgpu::LoadOp::Load, wgpu::LoadOp::Clear),
                    store: store(depth.store),
                };
                Some(wgpu::RenderPassDepthStencilAttachment {
                    view,
                    depth_ops: (!depth.read_only).then_some(operations),
                    stencil_ops: None,
                })
            }
        };
        let timestamps = self.pass_queries();
        let pass = self.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(&begin.label),
            color_attachments: &colours,
            depth_stencil_attachment: depth,
            timestamp_writes: timestamps.map(|(query_set, [first, last])| {
                wgpu::RenderPassTimestampWrites {
                    query_set,
                    beginning_of_pass_write_index: Some(first),
                    end_of_pass_write_index: Some(last),
                }
            }),
            occlusion_query_set: None,
            multiview_mask: None,
        });
        self.pass = Pass::Render(pass.forget_lifetime());
        self.opened(begin.label);
        Ok(())
    }

    fn colour_attachment(
        &self,
        attachment: &ColourAttachment,
    ) -> Result<wgpu::RenderPassColorAttachment<'a>, GpuError> {
        let (view, _) = self.table.any_view(self.caller.owner, attachment.target)?;
        let resolve_target = if attachment.resolve.is_some() {
            let (view, _) = self
                .table
                .any_view(self.caller.owner, attachment.resolve)
                .map_err(|error| error.at("resolve target"))?;
            Some(view)
        } else {
            None
        };
        Ok(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target,
            ops: wgpu::Operations {
                load: match attachment.clear {
                    Some(clear) => wgpu::LoadOp::Clear(colour(clear)),
                    None => wgpu::LoadOp::Load,
                },
                store: store(attachment.store),
            },
        })
    }

    pub(super) fn begin_compute_pass(&mut self, label: String) -> Result<(), GpuError> {
        self.outside()?;
        let timestamps = self.pass_queries();
        let pass = self
            .encoder
            .begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some(&label),
                timestamp_writes: timestamps.map(|(query_set, [first, last])| {
                    wgpu::ComputePassTimestampWrites {
                        query_set,
                        beginning_of_pass_write_index: Some(first),
                        end_of_pass_write_index: Some(last),
                    }
                }),
            });
        self.pass = Pass::Compute(pass.forget_lifetime());
        self.opened(label);
        Ok(())
    }

    fn pass_queries(&self) -> Option<(&'a wgpu::QuerySet, [u32; 2])> {
        let queries = self.queries?;
        Some((&queries.set, queries.of_pass(self.passes.len())?))
    }

    fn opened(&mut self, label: String) {
        self.passes.push(label);
        self.pipeline = None;
        self.index_buffer_set = false;
    }

    pub(super) fn end_pass(&mut self) -> Result<(), GpuError> {
        self.check_groups_closed()?;
        // Dropping a pass ends it.
        self.pass = Pass::None;
        Ok(())
    }

    fn open_groups(&mut self) -> &mut usize {
        let inside = usize::from(self.open_pass().is_some());
        &mut self.groups[inside]
    }

    pub(super) fn push_debug_group(&mut self, label: &str) {
        match &mut self.pass {
            Pass::None => self.encoder.push_debug_group(label),
            Pass::Render(pass) => pass.push_debug_group(label),
            Pass::Compute(pass) => pass.push_debug_group(label),
        }
        *self.open_groups() += 1;
    }

    pub(super) fn pop_debug_group(&mut self) -> Result<(), GpuError> {
        let open = self.open_groups();
        let Some(rest) = open.checked_sub(1) else {
            return Err(GpuError::validation(
                "no debug group is open here; push one before (a pass has its own)",
            ));
        };
        *open = rest;
        match &mut self.pass {
            Pass::None => self.encoder.pop_debug_group(),
            Pass::Render(pass) => pass.pop_debug_group(),
            Pass::Compute(pass) => pass.pop_debug_group(),
        }
        Ok(())
    }

    pub(super) fn pop_groups(&mut self) {
        while *self.open_groups() > 0 {
            // The loop's condition is what popping needs.
            self.pop_debug_group().ok();
        }
    }

    pub(super) fn check_groups_closed(&mut self) -> Result<(), GpuError> {
        match *self.open_groups() {
            0 => Ok(()),
            open => Err(GpuError::validation(format!(
                "{open} debug groups are still open; pop each"
            ))),
        }
    }
}

pub(super) fn colour([r, g, b, a]: [f64; 4]) -> wgpu::Color {
    wgpu::Color { r, g, b, a }
}

fn store(keep: bool) -> wgpu::StoreOp {
    if keep {
        wgpu::StoreOp::Store
    } else {
        wgpu::StoreOp::Discard
    }
}
