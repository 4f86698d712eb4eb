//! Recording passes and commands.

use super::resources::{AsHandle, Buffer, ComputePipeline, RenderPipeline, Ticket};
use crate::abi::commands::{self, Command, CommandListRecord};
use bytemuck::NoUninit;

pub use crate::abi::commands::{ColourAttachment, DepthAttachment};

/// Passes and commands in order. Nothing happens until the host replays them.
#[derive(Clone, Debug, Default)]
pub struct Recorder {
    list: CommandListRecord,
}

impl Recorder {
    /// An empty list.
    pub fn new() -> Self {
        Self::default()
    }

    /// Records any command; the methods below say it shorter.
    pub fn push(&mut self, command: impl Into<Command>) {
        self.list.push(command);
    }

    /// Opens a render pass, which ends when it is dropped. Its label names it in the timings.
    pub fn render_pass(
        &mut self,
        label: &str,
        colours: &[Option<ColourAttachment>],
        depth: Option<DepthAttachment>,
    ) -> RenderPass<'_> {
        self.push(commands::BeginRenderPass {
            label: label.into(),
            colours: colours.into(),
            depth,
        });
        RenderPass { recorder: self }
    }

    /// Opens a compute pass, which ends when it is dropped. Its label names it in the timings.
    pub fn compute_pass(&mut self, label: &str) -> ComputePass<'_> {
        self.push(commands::BeginComputePass {
            label: label.into(),
        });
        ComputePass { recorder: self }
    }

    /// Fills a buffer with zeros.
    pub fn clear_buffer(&mut self, buffer: &Buffer) {
        self.push(commands::ClearBuffer {
            buffer: buffer.handle(),
            offset: 0,
            size: 0,
        });
    }

    /// Copies bytes between buffers.
    pub fn copy_buffer(
        &mut self,
        source: &dyn AsHandle,
        source_offset: u64,
        target: &Buffer,
        target_offset: u64,
        size: u64,
    ) {
        let (source, target) = (source.as_handle(), target.handle());
        self.push(commands::CopyBufferToBuffer {
            source,
            source_offset,
            target,
            target_offset,
            size,
        });
    }

    /// Copies bytes of a buffer to the CPU; poll the ticket in a later frame.
    pub fn read_back(&mut self, buffer: &Buffer, offset: u64, size: u64, ticket: &Ticket) {
        let (buffer, ticket) = (buffer.handle(), ticket.handle());
        self.push(commands::ReadBack {
            buffer,
            offset,
            size,
            ticket,
        });
    }

    /// Appends what another recorder holds.
    pub fn append(&mut self, other: &Self) {
        let shift = self.list.payload.len() as u32;
        self.list.payload.extend(other.list.payload.iter().copied());
        self.list
            .commands
            .extend(other.list.commands.iter().map(|record| {
                let mut record = *record;
                record.start += shift;
                record
            }));
    }

    pub(crate) fn into_record(self) -> CommandListRecord {
        self.list
    }
}

impl ColourAttachment {
    /// Keeps what is there: the host has cleared its targets.
    pub fn load(target: &dyn AsHandle) -> Self {
        Self {
            target: target.as_handle(),
            resolve: crate::abi::Handle::NONE,
            clear: None,
            store: true,
        }
    }

    /// Clears first.
    pub fn clear(target: &dyn AsHandle, value: [f64; 4]) -> Self {
        Self {
            clear: Some(value),
            ..Self::load(target)
        }
    }
}

impl DepthAttachment {
    /// Keeps what is there, tests and writes.
    pub fn load(target: &dyn AsHandle) -> Self {
        Self {
            target: target.as_handle(),
            clear: None,
            store: true,
            read_only: false,
        }
    }

    /// Clears to 0, which is infinitely far in reversed z.
    pub fn clear(target: &dyn AsHandle) -> Self {
        Self {
            clear: Some(0.0),
            ..Self::load(target)
        }
    }

    /// Tests only; shaders may read the texture meanwhile.
    pub fn read_only(target: &dyn AsHandle) -> Self {
        Self {
            read_only: true,
            ..Self::load(target)
        }
    }
}

macro_rules! pass_methods {
    ($pass:ident, $pipeline:ty) => {
        impl $pass<'_> {
            /// Sets the pipeline.
            pub fn set_pipeline(&mut self, pipeline: &$pipeline) {
                self.recorder.push(commands::SetPipeline {
                    pipeline: pipeline.handle(),
                });
            }

            /// Sets a bind group, with one offset for each dynamic binding.
            pub fn set_bind_group(&mut self, index: u32, group: &dyn AsHandle, offsets: &[u32]) {
                let (group, offsets) = (group.as_handle(), offsets.into());
                self.recorder.push(commands::SetBindGroup {
                    index,
                    group,
                    offsets,
                });
            }

            /// Sets immediate data (push constants) at a byte offset.
            pub fn set_immediates<T: NoUninit>(&mut self, offset: u32, data: &[T]) {
                let data = bytemuck::cast_slice(data).to_vec();
                self.recorder.push(commands::SetImmediates { offset, data });
            }
        }
    };
}

/// An open render pass.
pub struct RenderPass<'a> {
    recorder: &'a mut Recorder,
}

/// An open compute pass.
pub struct ComputePass<'a> {
    recorder: &'a mut Recorder,
}

pass_methods!(RenderPass, RenderPipeline);
pass_methods!(ComputePass, ComputePipeline);

impl RenderPass<'_> {
    /// Sets a vertex buffer.
    pub fn set_vertex_buffer(&mut self, slot: u32, buffer: &dyn AsHandle) {
        self.recorder.push(commands::SetVertexBuffer {
            slot,
            buffer: buffer.as_handle(),
            offset: 0,
        });
    }

    /// Sets the index buffer of `u32`s.
    pub fn set_index_buffer(&mut self, buffer: &dyn AsHandle) {
        self.recorder.push(commands::SetIndexBuffer {
            buffer: buffer.as_handle(),
            offset: 0,
            wide: true,
        });
    }

    /// Draws `vertices` vertices, `instances` times.
    pub fn draw(&mut self, vertices: core::ops::Range<u32>, instances: core::ops::Range<u32>) {
        self.recorder.push(commands::Draw {
            vertex_count: vertices.end.saturating_sub(vertices.start),
            instance_count: instances.end.saturating_sub(instances.start),
            first_vertex: vertices.start,
            first_instance: instances.start,
        });
    }

    /// Draws by the index buffer.
    pub fn draw_indexed(
        &mut self,
        indices: core::ops::Range<u32>,
        base_vertex: i32,
        instances: core::ops::Range<u32>,
    ) {
        self.recorder.push(commands::DrawIndexed {
            index_count: indices.end.saturating_sub(indices.start),
            instance_count: instances.end.saturating_sub(instances.start),
            first_index: indices.start,
            base_vertex,
            first_instance: instances.start,
        });
    }

    /// Draws with arguments from a buffer.
    pub fn draw_indirect(&mut self, buffer: &Buffer, offset: u64) {
        self.recorder.push(commands::DrawIndirect {
            buffer: buffer.handle(),
            offset,
        });
    }

    /// Restricts drawing to a rectangle; px.
    pub fn set_scissor(&mut self, origin: [u32; 2], size: [u32; 2]) {
        self.recorder.push(commands::SetScissor { origin, size });
    }
}

impl ComputePass<'_> {
    /// Runs workgroups. No dimension may exceed 65,535: see [`ComputePass::dispatch_linear`].
    pub fn dispatch(&mut self, groups: [u32; 3]) {
        self.recorder.push(commands::Dispatch { groups });
    }

    /// Runs at least `invocations` invocations in groups of `group_size`, spread over x and y.
    ///
    /// With `@builtin(workgroup_id) group` and `@builtin(local_invocation_index) local`, an invocation's number is
    /// `(group.y * 32768 + group.x) * group_size + local`; the shader checks it against the count.
    pub fn dispatch_linear(&mut self, invocations: u32, group_size: u32) {
        const ROW: u32 = 32_768; // groups a row: below WebGPU's 65,535, and a power of two
        let groups = invocations.div_ceil(group_size.max(1));
        self.dispatch([
            groups.min(ROW),
            groups.div_ceil(ROW).max(u32::from(groups > 0)),
            1,
        ]);
    }

    /// Runs workgroups with arguments from a buffer.
    pub fn dispatch_indirect(&mut self, buffer: &Buffer, offset: u64) {
        self.recorder.push(commands::DispatchIndirect {
            buffer: buffer.handle(),
            offset,
        });
    }
}

impl Drop for RenderPass<'_> {
    fn drop(&mut self) {
        self.recorder.push(commands::EndRenderPass {});
    }
}

impl Drop for ComputePass<'_> {
    fn drop(&mut self) {
        self.recorder.push(commands::EndComputePass {});
    }
}
