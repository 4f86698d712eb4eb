//! One walk over recorded commands: where it stands (outside, in a render pass, in a compute pass), what is set, and what
//! each command may do there. Numbers that wgpu would panic about, or report without naming the command, are checked
//! here; the rest is wgpu's to check, inside the caller's error scope.

use super::bytes::Charge;
use super::create::hosts_buffer;
use super::handles::{BufferEntry, Table};
use super::service::Caller;
use super::tickets::Ticket;
use super::timing::Queries;
use crate::device::{GpuDevice, GpuError};
use pointstage_plugin_api::abi::commands::{
    BeginRenderPass, ClearBuffer, ColourAttachment, Command, CopyBufferToBuffer, Draw, DrawIndexed,
    ReadBack, SetBindGroup, SetImmediates, SetIndexBuffer, SetVertexBuffer, SetViewport,
};
use pointstage_plugin_api::abi::{BufferUsage, Handle};
use std::sync::Arc;
use wgpu::{Features, IndexFormat};

/// Bytes of the arguments of an indirect dispatch, draw, and indexed draw.
const DISPATCH_ARGUMENTS: u64 = 12;
const DRAW_ARGUMENTS: u64 = 16;
const INDEXED_ARGUMENTS: u64 = 20;

/// A copy on its way to a ticket, once it is submitted.
pub(super) struct PendingReadBack {
    pub(super) ticket: Arc<Ticket>,
    pub(super) staging: wgpu::Buffer,
    pub(super) charge: Charge,
}

/// What a finished walk has to submit.
pub(super) struct Encoded {
    pub(super) commands: wgpu::CommandBuffer,
    /// Labels of the passes, in order.
    pub(super) passes: Vec<String>,
    pub(super) read_backs: Vec<PendingReadBack>,
}

/// The open pass.
#[expect(
    clippy::large_enum_variant,
    reason = "there is one, and boxing it would allocate for each pass"
)]
enum Pass {
    None,
    Render(wgpu::RenderPass<'static>),
    Compute(wgpu::ComputePass<'static>),
}

/// The state between two commands. The pass stands before the encoder, as it must end first.
pub(super) struct Walk<'a> {
    pass: Pass,
    encoder: wgpu::CommandEncoder,
    gpu: &'a GpuDevice,
    table: &'a Table,
    caller: &'a Caller,
    queries: Option<&'a Queries>,
    /// Immediate bytes of the pipeline that is set.
    pipeline: Option<u32>,
    index_buffer_set: bool,
    /// Open debug groups: outside passes, and in the open pass.
    groups: [usize; 2],
    passes: Vec<String>,
    read_backs: Vec<PendingReadBack>,
}

impl<'a> Walk<'a> {
    pub(super) fn new(
        gpu: &'a GpuDevice,
        table: &'a Table,
        caller: &'a Caller,
        queries: Option<&'a Queries>,
    ) -> Self {
        let encoder = gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor {
                label: Some(&caller.state.name),
            });
        Self {
            pass: Pass::None,
            encoder,
            gpu,
            table,
            caller,
            queries,
            pipeline: None,
            index_buffer_set: false,
            groups: [0; 2],
            passes: Vec::new(),
            read_backs: Vec::new(),
        }
    }

    /// Checks and encodes one command.
    pub(super) fn step(&mut self, command: Command) -> Result<(), GpuError> {
        match command {
            Command::BeginRenderPass(begin) => self.begin_render_pass(begin),
            Command::EndRenderPass(_) => {
                self.render()?;
                self.end_pass()
            }
            Command::BeginComputePass(begin) => self.begin_compute_pass(begin.label),
            Command::EndComputePass(_) => {
                self.compute()?;
                self.end_pass()
            }
            Command::SetPipeline(set) => self.set_pipeline(set.pipeline),
            Command::SetBindGroup(set) => self.set_bind_group(&set),
            Command::SetVertexBuffer(set) => self.set_vertex_buffer(&set),
            Command::SetIndexBuffer(set) => self.set_index_buffer(&set),
            Command::SetImmediates(set) => self.set_immediates(&set),
            Command::SetViewport(set) => self.set_viewport(&set),
            Command::SetScissor(set) => {
                let ([x, y], [width, height]) = (set.origin, set.size);
                self.render()?.set_scissor_rect(x, y, width, height);
                Ok(())
            }
            Command::SetBlendConstant(set) => {
                self.render()?.set_blend_constant(colour(set.colour));
                Ok(())
            }
            Command::Draw(draw) => self.draw(&draw),
            Command::DrawIndexed(draw) => self.draw_indexed(&draw),
            Command::DrawIndirect(draw) => {
                self.check_drawable()?;
                let buffer = self.arguments(draw.buffer, draw.offset, DRAW_ARGUMENTS)?;
                self.render()?.draw_indirect(buffer, draw.offset);
                Ok(())
            }
            Command::DrawIndexedIndirect(draw) => {
                self.check_drawable()?;
                self.check_index_buffer()?;
                let buffer = self.arguments(draw.buffer, draw.offset, INDEXED_ARGUMENTS)?;
                self.render()?.draw_indexed_indirect(buffer, draw.offset);
                Ok(())
            }
            Command::Dispatch(dispatch) => self.dispatch(dispatch.groups),
            Command::DispatchIndirect(dispatch) => {
                self.compute()?;
                self.check_pipeline()?;
                let buffer =
                    self.arguments(dispatch.buffer, dispatch.offset, DISPATCH_ARGUMENTS)?;
                self.compute()?
                    .dispatch_workgroups_indirect(buffer, dispatch.offset);
                Ok(())
            }
            Command::CopyBufferToBuffer(copy) => self.copy_buffer(&copy),
            Command::CopyBufferToTexture(copy) => {
                let source = self.copied(copy.source, BufferUsage::COPY_SRC, "COPY_SRC")?;
                let source = rows(source, copy.offset, copy.bytes_per_row, copy.size);
                let target = self.texture(copy.target, copy.mip_level, copy.origin)?;
                self.outside()?
                    .copy_buffer_to_texture(source, target, extent(copy.size));
                Ok(())
            }
            Command::CopyTextureToBuffer(copy) => {
                let target = self.written(copy.target)?;
                let target = rows(target, copy.offset, copy.bytes_per_row, copy.size);
                let source = self.texture(copy.source, copy.mip_level, copy.origin)?;
                self.outside()?
                    .copy_texture_to_buffer(source, target, extent(copy.size));
                Ok(())
            }
            Command::CopyTextureToTexture(copy) => {
                let source = self.texture(copy.source, copy.source_mip, copy.source_origin)?;
                let target = self.texture(copy.target, copy.target_mip, copy.target_origin)?;
                self.outside()?
                    .copy_texture_to_texture(source, target, extent(copy.size));
                Ok(())
            }
            Command::ClearBuffer(clear) => self.clear_buffer(&clear),
            Command::ReadBack(read) => self.read_back(&read),
            Command::PushDebugGroup(push) => {
                match &mut self.pass {
                    Pass::None => self.encoder.push_debug_group(&push.label),
                    Pass::Render(pass) => pass.push_debug_group(&push.label),
                    Pass::Compute(pass) => pass.push_debug_group(&push.label),
                }
                *self.open_groups() += 1;
                Ok(())
            }
            Command::PopDebugGroup(_) => self.pop_debug_group(),
        }
    }

    /// Ends the encoding, if the list ends as it should.
    pub(super) fn finish(mut self) -> Result<Encoded, GpuError> {
        if let Some(label) = self.open_pass() {
            return Err(GpuError::validation(format!(
                "the list ends inside the pass '{label}'; end the pass"
            )));
        }
        self.check_groups_closed()?;
        Ok(self.encoded())
    }

    /// Ends the encoding wherever it stands; for finding the command that wgpu refuses.
    pub(super) fn abandon(mut self) {
        if self.open_pass().is_some() {
            self.pop_groups();
            self.pass = Pass::None;
        }
        self.pop_groups();
        drop(self.encoded().commands);
    }

    fn encoded(mut self) -> Encoded {
        if let Some(queries) = self.queries {
            queries.resolve(&mut self.encoder, self.passes.len());
        }
        Encoded {
            commands: self.encoder.finish(),
            passes: self.passes,
            read_backs: self.read_backs,
        }
    }

    // Passes.

    fn open_pass(&self) -> Option<&str> {
        match self.pass {
            Pass::None => None,
            Pass::Render(_) | Pass::Compute(_) => self.passes.last().map(String::as_str),
        }
    }

    /// The encoder, when no pass is open.
    fn outside(&mut self) -> Result<&mut wgpu::CommandEncoder, GpuError> {
        match self.open_pass() {
            None => Ok(&mut self.encoder),
            Some(label) => Err(GpuError::validation(format!(
                "the pass '{label}' is open; end it first"
            ))),
        }
    }

    fn render(&mut self) -> Result<&mut wgpu::RenderPass<'static>, GpuError> {
        match &mut self.pass {
            Pass::Render(pass) => Ok(pass),
            Pass::None | Pass::Compute(_) => Err(GpuError::validation(
                "no render pass is open; begin one before",
            )),
        }
    }

    fn compute(&mut self) -> Result<&mut wgpu::ComputePass<'static>, GpuError> {
        match &mut self.pass {
            Pass::Compute(pass) => Ok(pass),
            Pass::None | Pass::Render(_) => Err(GpuError::validation(
                "no compute pass is open; begin one before",
            )),
        }
    }

    fn begin_render_pass(&mut self, begin: BeginRenderPass) -> Result<(), GpuError> {
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
        let table: &'a Table = self.table;
        let (view, _) = table.any_view(self.caller.owner, attachment.target)?;
        let resolve_target = if attachment.resolve.is_some() {
            let (view, _) = table
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

    fn begin_compute_pass(&mut self, label: String) -> Result<(), GpuError> {
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

    fn end_pass(&mut self) -> Result<(), GpuError> {
        self.check_groups_closed()?;
        // Dropping a pass ends it.
        self.pass = Pass::None;
        Ok(())
    }

    // State.

    fn set_pipeline(&mut self, handle: Handle) -> Result<(), GpuError> {
        let owner = self.caller.owner;
        self.pipeline = Some(match &mut self.pass {
            Pass::Render(pass) => {
                let entry = self.table.render_pipeline(owner, handle)?;
                pass.set_pipeline(&entry.pipeline);
                entry.immediate_size
            }
            Pass::Compute(pass) => {
                let entry = self.table.compute_pipeline(owner, handle)?;
                pass.set_pipeline(&entry.pipeline);
                entry.immediate_size
            }
            Pass::None => return Err(no_pass()),
        });
        Ok(())
    }

    fn set_bind_group(&mut self, set: &SetBindGroup) -> Result<(), GpuError> {
        let most = self.gpu.limits.max_bind_groups;
        if set.index >= most {
            return Err(GpuError::validation(format!(
                "bind group {}; the device has groups 0 to {}",
                set.index,
                most - 1
            )));
        }
        let entry = self.table.group(self.caller.owner, set.group)?;
        if set.offsets.len() != entry.dynamic_offsets {
            return Err(GpuError::validation(format!(
                "{} dynamic offsets; the group's layout has {} dynamic bindings, one offset each",
                set.offsets.len(),
                entry.dynamic_offsets
            )));
        }
        match &mut self.pass {
            Pass::Render(pass) => pass.set_bind_group(set.index, &entry.group, &set.offsets),
            Pass::Compute(pass) => pass.set_bind_group(set.index, &entry.group, &set.offsets),
            Pass::None => return Err(no_pass()),
        }
        Ok(())
    }

    fn set_vertex_buffer(&mut self, set: &SetVertexBuffer) -> Result<(), GpuError> {
        let most = self.gpu.limits.max_vertex_buffers;
        if set.slot >= most {
            return Err(GpuError::validation(format!(
                "vertex buffer {}; the device has 0 to {}",
                set.slot,
                most.saturating_sub(1)
            )));
        }
        let entry = self.used(set.buffer, BufferUsage::VERTEX, "VERTEX")?;
        check_offset(set.offset, 4, entry)?;
        self.render()?
            .set_vertex_buffer(set.slot, entry.buffer.slice(set.offset..));
        Ok(())
    }

    fn set_index_buffer(&mut self, set: &SetIndexBuffer) -> Result<(), GpuError> {
        let entry = self.used(set.buffer, BufferUsage::INDEX, "INDEX")?;
        let (format, alignment) = if set.wide {
            (IndexFormat::Uint32, 4)
        } else {
            (IndexFormat::Uint16, 2)
        };
        check_offset(set.offset, alignment, entry)?;
        self.render()?
            .set_index_buffer(entry.buffer.slice(set.offset..), format);
        self.index_buffer_set = true;
        Ok(())
    }

    fn set_immediates(&mut self, set: &SetImmediates) -> Result<(), GpuError> {
        let granted = self.caller.state.granted;
        super::features::require(self.gpu, granted, Features::IMMEDIATES, "immediate data")?;
        let Some(size) = self.pipeline else {
            return Err(no_pipeline());
        };
        let length = set.data.len() as u64;
        let end = u64::from(set.offset) + length;
        if !set.offset.is_multiple_of(4) || !length.is_multiple_of(4) || end > u64::from(size) {
            return Err(GpuError::validation(format!(
                "{length} bytes of immediate data from byte {}; expected multiples of 4 within the pipeline's {size}",
                set.offset
            )));
        }
        match &mut self.pass {
            Pass::Render(pass) => pass.set_immediates(set.offset, &set.data),
            Pass::Compute(pass) => pass.set_immediates(set.offset, &set.data),
            Pass::None => return Err(no_pass()),
        }
        Ok(())
    }

    fn set_viewport(&mut self, set: &SetViewport) -> Result<(), GpuError> {
        let SetViewport {
            origin,
            size,
            depth,
        } = *set;
        let numbers = [origin, size, depth].concat();
        if !numbers.iter().all(|number| number.is_finite()) {
            return Err(GpuError::validation(format!(
                "viewport at {origin:?} of size {size:?} with depths {depth:?}; expected finite numbers"
            )));
        }
        self.render()?
            .set_viewport(origin[0], origin[1], size[0], size[1], depth[0], depth[1]);
        Ok(())
    }

    // Draws and dispatches.

    fn check_pipeline(&self) -> Result<(), GpuError> {
        self.pipeline.map(|_| ()).ok_or_else(no_pipeline)
    }

    fn check_drawable(&mut self) -> Result<(), GpuError> {
        self.render()?;
        self.check_pipeline()
    }

    fn check_index_buffer(&self) -> Result<(), GpuError> {
        if self.index_buffer_set {
            return Ok(());
        }
        Err(GpuError::validation(
            "no index buffer is set; set one before",
        ))
    }

    fn draw(&mut self, draw: &Draw) -> Result<(), GpuError> {
        self.check_drawable()?;
        let vertices = range("vertices", draw.first_vertex, draw.vertex_count)?;
        let instances = range("instances", draw.first_instance, draw.instance_count)?;
        self.render()?.draw(vertices, instances);
        Ok(())
    }

    fn draw_indexed(&mut self, draw: &DrawIndexed) -> Result<(), GpuError> {
        self.check_drawable()?;
        self.check_index_buffer()?;
        let indices = range("indices", draw.first_index, draw.index_count)?;
        let instances = range("instances", draw.first_instance, draw.instance_count)?;
        self.render()?
            .draw_indexed(indices, draw.base_vertex, instances);
        Ok(())
    }

    fn dispatch(&mut self, groups: [u32; 3]) -> Result<(), GpuError> {
        self.compute()?;
        self.check_pipeline()?;
        let most = self.gpu.limits.max_compute_workgroups_per_dimension;
        let [x, y, z] = groups;
        if groups.iter().any(|count| *count > most) {
            return Err(GpuError::validation(format!(
                "{x} x {y} x {z} workgroups; the device has at most {most} a dimension; use a second dimension"
            )));
        }
        self.compute()?.dispatch_workgroups(x, y, z);
        Ok(())
    }

    /// A buffer with the arguments of an indirect command.
    fn arguments(
        &self,
        handle: Handle,
        offset: u64,
        size: u64,
    ) -> Result<&'a wgpu::Buffer, GpuError> {
        let entry = self.used(handle, BufferUsage::INDIRECT, "INDIRECT")?;
        check_offset(offset, 4, entry)?;
        check_range(offset, size, entry)?;
        Ok(&entry.buffer)
    }

    // Copies.

    fn copy_buffer(&mut self, copy: &CopyBufferToBuffer) -> Result<(), GpuError> {
        let source = self.copied(copy.source, BufferUsage::COPY_SRC, "COPY_SRC")?;
        let target = self.written(copy.target)?;
        let at = |what| move |error: GpuError| error.at(what);
        for (name, entry, offset) in [
            ("source", source, copy.source_offset),
            ("target", target, copy.target_offset),
        ] {
            check_aligned(offset, copy.size).map_err(at(name))?;
            check_range(offset, copy.size, entry).map_err(at(name))?;
        }
        self.outside()?.copy_buffer_to_buffer(
            &source.buffer,
            copy.source_offset,
            &target.buffer,
            copy.target_offset,
            copy.size,
        );
        Ok(())
    }

    fn clear_buffer(&mut self, clear: &ClearBuffer) -> Result<(), GpuError> {
        let entry = self.written(clear.buffer)?;
        check_aligned(clear.offset, clear.size)?;
        check_range(clear.offset, clear.size, entry)?;
        // 0 is 'all that remain'.
        let size = (clear.size != 0).then_some(clear.size);
        self.outside()?
            .clear_buffer(&entry.buffer, clear.offset, size);
        Ok(())
    }

    fn read_back(&mut self, read: &ReadBack) -> Result<(), GpuError> {
        self.outside()?;
        let entry = self.copied(read.buffer, BufferUsage::COPY_SRC, "COPY_SRC")?;
        check_aligned(read.offset, read.size)?;
        check_range(read.offset, read.size, entry)?;
        if read.size == 0 {
            return Err(GpuError::validation(
                "0 bytes to read back; expected at least 4",
            ));
        }
        let ticket = self.table.ticket(self.caller.owner, read.ticket)?;
        ticket.check_empty()?;
        let used = |pending: &PendingReadBack| Arc::ptr_eq(&pending.ticket, ticket);
        if self.read_backs.iter().any(used) {
            return Err(GpuError::validation(
                "the ticket is used by an earlier command of this list; make a ticket for each",
            ));
        }
        let charge = self.caller.state.charge(read.size)?;
        let staging = self.gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read back"),
            size: read.size,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        self.encoder
            .copy_buffer_to_buffer(&entry.buffer, read.offset, &staging, 0, read.size);
        self.read_backs.push(PendingReadBack {
            ticket: Arc::clone(ticket),
            staging,
            charge,
        });
        Ok(())
    }

    fn texture(
        &self,
        handle: Handle,
        mip_level: u32,
        [x, y, z]: [u32; 3],
    ) -> Result<wgpu::TexelCopyTextureInfo<'a>, GpuError> {
        let entry = self.table.texture(self.caller.owner, handle)?;
        Ok(wgpu::TexelCopyTextureInfo {
            texture: &entry.texture,
            mip_level,
            origin: wgpu::Origin3d { x, y, z },
            aspect: wgpu::TextureAspect::All,
        })
    }

    // Buffers.

    /// A buffer that was made for this use.
    fn used(
        &self,
        handle: Handle,
        usage: BufferUsage,
        name: &str,
    ) -> Result<&'a BufferEntry, GpuError> {
        let entry = self.table.buffer(self.caller.owner, handle)?;
        if entry.usage.contains(usage) {
            return Ok(entry);
        }
        Err(GpuError::validation(format!(
            "the buffer was made without the usage {name}; add it when creating the buffer"
        )))
    }

    /// As [`used`](Self::used), outside passes.
    fn copied(
        &mut self,
        handle: Handle,
        usage: BufferUsage,
        name: &str,
    ) -> Result<&'a BufferEntry, GpuError> {
        self.outside()?;
        self.used(handle, usage, name)
    }

    /// A buffer of the plugin that a copy may write.
    fn written(&mut self, handle: Handle) -> Result<&'a BufferEntry, GpuError> {
        let entry = self.copied(handle, BufferUsage::COPY_DST, "COPY_DST")?;
        if self.table.is_hosts(handle) {
            return Err(hosts_buffer());
        }
        Ok(entry)
    }

    // Debug groups.

    fn open_groups(&mut self) -> &mut usize {
        let inside = usize::from(self.open_pass().is_some());
        &mut self.groups[inside]
    }

    fn pop_debug_group(&mut self) -> Result<(), GpuError> {
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

    fn pop_groups(&mut self) {
        while *self.open_groups() > 0 {
            // The loop's condition is what popping needs.
            self.pop_debug_group().ok();
        }
    }

    fn check_groups_closed(&mut self) -> Result<(), GpuError> {
        match *self.open_groups() {
            0 => Ok(()),
            open => Err(GpuError::validation(format!(
                "{open} debug groups are still open; pop each"
            ))),
        }
    }
}

fn no_pass() -> GpuError {
    GpuError::validation("no pass is open; begin a render or compute pass before")
}

fn no_pipeline() -> GpuError {
    GpuError::validation("no pipeline is set in this pass; set one before")
}

fn colour([r, g, b, a]: [f64; 4]) -> wgpu::Color {
    wgpu::Color { r, g, b, a }
}

fn store(keep: bool) -> wgpu::StoreOp {
    if keep {
        wgpu::StoreOp::Store
    } else {
        wgpu::StoreOp::Discard
    }
}

fn extent([width, height, depth_or_array_layers]: [u32; 3]) -> wgpu::Extent3d {
    wgpu::Extent3d {
        width,
        height,
        depth_or_array_layers,
    }
}

/// A buffer that holds rows of texels, images one after the other.
fn rows(
    entry: &BufferEntry,
    offset: u64,
    bytes_per_row: u32,
    size: [u32; 3],
) -> wgpu::TexelCopyBufferInfo<'_> {
    wgpu::TexelCopyBufferInfo {
        buffer: &entry.buffer,
        layout: wgpu::TexelCopyBufferLayout {
            offset,
            bytes_per_row: Some(bytes_per_row),
            rows_per_image: Some(size[1]),
        },
    }
}

fn range(what: &str, first: u32, count: u32) -> Result<std::ops::Range<u32>, GpuError> {
    match first.checked_add(count) {
        Some(end) => Ok(first..end),
        None => Err(GpuError::validation(format!(
            "{count} {what} from {first} go past 2^32 - 1; draw fewer"
        ))),
    }
}

/// Refuses an offset at or past the end, or off the alignment.
fn check_offset(offset: u64, alignment: u64, entry: &BufferEntry) -> Result<(), GpuError> {
    let size = entry.buffer.size();
    if offset < size && offset.is_multiple_of(alignment) {
        return Ok(());
    }
    Err(GpuError::validation(format!(
        "offset {offset}; expected a multiple of {alignment} below the buffer's {size} bytes"
    )))
}

fn check_aligned(offset: u64, size: u64) -> Result<(), GpuError> {
    let alignment = wgpu::COPY_BUFFER_ALIGNMENT;
    if offset.is_multiple_of(alignment) && size.is_multiple_of(alignment) {
        return Ok(());
    }
    Err(GpuError::validation(format!(
        "{size} bytes from byte {offset}; expected multiples of {alignment}"
    )))
}

fn check_range(offset: u64, size: u64, entry: &BufferEntry) -> Result<(), GpuError> {
    let length = entry.buffer.size();
    if offset.checked_add(size).is_some_and(|end| end <= length) {
        return Ok(());
    }
    Err(GpuError::validation(format!(
        "{size} bytes from byte {offset} go past the end of a buffer of {length} bytes"
    )))
}
