//! Draws and dispatches, direct and with arguments from a buffer.

use super::state::no_pipeline;
use super::{Walk, check_offset, check_range};
use crate::device::GpuError;
use pointstage_plugin_api::abi::commands::{
    DispatchIndirect, Draw, DrawIndexed, DrawIndexedIndirect, DrawIndirect,
};
use pointstage_plugin_api::abi::{BufferUsage, Handle};

/// Bytes of the arguments of an indirect dispatch, draw, and indexed draw.
const DISPATCH_ARGUMENTS: u64 = 12;
const DRAW_ARGUMENTS: u64 = 16;
const INDEXED_ARGUMENTS: u64 = 20;

impl<'a> Walk<'a> {
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

    pub(super) fn draw(&mut self, draw: &Draw) -> Result<(), GpuError> {
        self.check_drawable()?;
        let vertices = range("vertices", draw.first_vertex, draw.vertex_count)?;
        let instances = range("instances", draw.first_instance, draw.instance_count)?;
        self.render()?.draw(vertices, instances);
        Ok(())
    }

    pub(super) fn draw_indexed(&mut self, draw: &DrawIndexed) -> Result<(), GpuError> {
        self.check_drawable()?;
        self.check_index_buffer()?;
        let indices = range("indices", draw.first_index, draw.index_count)?;
        let instances = range("instances", draw.first_instance, draw.instance_count)?;
        self.render()?
            .draw_indexed(indices, draw.base_vertex, instances);
        Ok(())
    }

    pub(super) fn dispatch(&mut self, groups: [u32; 3]) -> Result<(), GpuError> {
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

    pub(super) fn draw_indirect(&mut self, draw: &DrawIndirect) -> Result<(), GpuError> {
        self.check_drawable()?;
        let buffer = self.arguments(draw.buffer, draw.offset, DRAW_ARGUMENTS)?;
        self.render()?.draw_indirect(buffer, draw.offset);
        Ok(())
    }

    pub(super) fn draw_indexed_indirect(
        &mut self,
        draw: &DrawIndexedIndirect,
    ) -> Result<(), GpuError> {
        self.check_drawable()?;
        self.check_index_buffer()?;
        let buffer = self.arguments(draw.buffer, draw.offset, INDEXED_ARGUMENTS)?;
        self.render()?.draw_indexed_indirect(buffer, draw.offset);
        Ok(())
    }

    pub(super) fn dispatch_indirect(
        &mut self,
        dispatch: &DispatchIndirect,
    ) -> Result<(), GpuError> {
        self.compute()?;
        self.check_pipeline()?;
        let DispatchIndirect { buffer, offset } = *dispatch;
        let buffer = self.arguments(buffer, offset, DISPATCH_ARGUMENTS)?;
        self.compute()?.dispatch_workgroups_indirect(buffer, offset);
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
}

fn range(what: &str, first: u32, count: u32) -> Result<std::ops::Range<u32>, GpuError> {
    match first.checked_add(count) {
        Some(end) => Ok(first..end),
        None => Err(GpuError::validation(format!(
            "{count} {what} from {first} go past 2^32 - 1; draw fewer"
        ))),
    }
}
