//! What is set within a pass: pipeline, groups, buffers, immediates, viewport.

use super::passes::colour;
use super::{Pass, Walk, check_offset};
use crate::device::GpuError;
use crate::gpu::features;
use pointstage_plugin_api::abi::commands::{
    SetBindGroup, SetBlendConstant, SetImmediates, SetIndexBuffer, SetScissor, SetVertexBuffer,
    SetViewport,
};
use pointstage_plugin_api::abi::{BufferUsage, Handle};
use wgpu::{Features, IndexFormat};

impl Walk<'_> {
    pub(super) fn set_pipeline(&mut self, handle: Handle) -> Result<(), GpuError> {
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

    pub(super) fn set_bind_group(&mut self, set: &SetBindGroup) -> Result<(), GpuError> {
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

    pub(super) fn set_vertex_buffer(&mut self, set: &SetVertexBuffer) -> Result<(), GpuError> {
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

    pub(super) fn set_index_buffer(&mut self, set: &SetIndexBuffer) -> Result<(), GpuError> {
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

    pub(super) fn set_immediates(&mut self, set: &SetImmediates) -> Result<(), GpuError> {
        let granted = self.caller.state.granted;
        features::require(self.gpu, granted, Features::IMMEDIATES, "immediate data")?;
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

    pub(super) fn set_viewport(&mut self, set: &SetViewport) -> Result<(), GpuError> {
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

    pub(super) fn set_scissor(&mut self, set: &SetScissor) -> Result<(), GpuError> {
        let ([x, y], [width, height]) = (set.origin, set.size);
        self.render()?.set_scissor_rect(x, y, width, height);
        Ok(())
    }

    pub(super) fn set_blend_constant(&mut self, set: &SetBlendConstant) -> Result<(), GpuError> {
        self.render()?.set_blend_constant(colour(set.colour));
        Ok(())
    }
}

fn no_pass() -> GpuError {
    GpuError::validation("no pass is open; begin a render or compute pass before")
}

pub(super) fn no_pipeline() -> GpuError {
    GpuError::validation("no pipeline is set in this pass; set one before")
}
