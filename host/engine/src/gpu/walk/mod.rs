//! One walk over recorded commands: where it stands (outside, in a render pass, in a compute pass), what is set, and what
//! each command may do there. Numbers that wgpu would panic about, or report without naming the command, are checked
//! here; the rest is wgpu's to check, inside the caller's error scope.

mod copies;
mod draws;
mod passes;
mod state;

use super::bytes::Charge;
use super::handles::{BufferEntry, Table};
use super::service::Caller;
use super::tickets::Ticket;
use super::timing::Queries;
use crate::device::{GpuDevice, GpuError};
use pointstage_plugin_api::abi::commands::Command;
use pointstage_plugin_api::abi::{BufferUsage, Handle};
use std::sync::Arc;

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
    /// A walk that stands before the first command.
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
            Command::SetScissor(set) => self.set_scissor(&set),
            Command::SetBlendConstant(set) => self.set_blend_constant(&set),
            Command::Draw(draw) => self.draw(&draw),
            Command::DrawIndexed(draw) => self.draw_indexed(&draw),
            Command::DrawIndirect(draw) => self.draw_indirect(&draw),
            Command::DrawIndexedIndirect(draw) => self.draw_indexed_indirect(&draw),
            Command::Dispatch(dispatch) => self.dispatch(dispatch.groups),
            Command::DispatchIndirect(dispatch) => self.dispatch_indirect(&dispatch),
            Command::CopyBufferToBuffer(copy) => self.copy_buffer(&copy),
            Command::CopyBufferToTexture(copy) => self.copy_buffer_to_texture(&copy),
            Command::CopyTextureToBuffer(copy) => self.copy_texture_to_buffer(&copy),
            Command::CopyTextureToTexture(copy) => self.copy_texture(&copy),
            Command::ClearBuffer(clear) => self.clear_buffer(&clear),
            Command::ReadBack(read) => self.read_back(&read),
            Command::PushDebugGroup(push) => {
                self.push_debug_group(&push.label);
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

fn check_range(offset: u64, size: u64, entry: &BufferEntry) -> Result<(), GpuError> {
    let length = entry.buffer.size();
    if offset.checked_add(size).is_some_and(|end| end <= length) {
        return Ok(());
    }
    Err(GpuError::validation(format!(
        "{size} bytes from byte {offset} go past the end of a buffer of {length} bytes"
    )))
}
