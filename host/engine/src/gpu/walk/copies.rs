//! Copies between buffers and textures, clears and read-backs: outside passes only.

use super::{PendingReadBack, Walk, check_range};
use crate::device::GpuError;
use crate::gpu::create::hosts_buffer;
use crate::gpu::handles::BufferEntry;
use pointstage_plugin_api::abi::commands::{
    ClearBuffer, CopyBufferToBuffer, CopyBufferToTexture, CopyTextureToBuffer,
    CopyTextureToTexture, ReadBack,
};
use pointstage_plugin_api::abi::{BufferUsage, Handle};
use std::sync::Arc;

impl<'a> Walk<'a> {
    pub(super) fn copy_buffer(&mut self, copy: &CopyBufferToBuffer) -> Result<(), GpuError> {
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

    pub(super) fn copy_buffer_to_texture(
        &mut self,
        copy: &CopyBufferToTexture,
    ) -> Result<(), GpuError> {
        let source = self.copied(copy.source, BufferUsage::COPY_SRC, "COPY_SRC")?;
        let source = rows(source, copy.offset, copy.bytes_per_row, copy.size);
        let target = self.texture(copy.target, copy.mip_level, copy.origin)?;
        self.outside()?
            .copy_buffer_to_texture(source, target, extent(copy.size));
        Ok(())
    }

    pub(super) fn copy_texture_to_buffer(
        &mut self,
        copy: &CopyTextureToBuffer,
    ) -> Result<(), GpuError> {
        let target = self.written(copy.target)?;
        let target = rows(target, copy.offset, copy.bytes_per_row, copy.size);
        let source = self.texture(copy.source, copy.mip_level, copy.origin)?;
        self.outside()?
            .copy_texture_to_buffer(source, target, extent(copy.size));
        Ok(())
    }

    pub(super) fn copy_texture(&mut self, copy: &CopyTextureToTexture) -> Result<(), GpuError> {
        let source = self.texture(copy.source, copy.source_mip, copy.source_origin)?;
        let target = self.texture(copy.target, copy.target_mip, copy.target_origin)?;
        self.outside()?
            .copy_texture_to_texture(source, target, extent(copy.size));
        Ok(())
    }

    pub(super) fn clear_buffer(&mut self, clear: &ClearBuffer) -> Result<(), GpuError> {
        let entry = self.written(clear.buffer)?;
        check_aligned(clear.offset, clear.size)?;
        check_range(clear.offset, clear.size, entry)?;
        // 0 is 'all that remain'.
        let size = (clear.size != 0).then_some(clear.size);
        self.outside()?
            .clear_buffer(&entry.buffer, clear.offset, size);
        Ok(())
    }

    pub(super) fn read_back(&mut self, read: &ReadBack) -> Result<(), GpuError> {
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

fn check_aligned(offset: u64, size: u64) -> Result<(), GpuError> {
    let alignment = wgpu::COPY_BUFFER_ALIGNMENT;
    if offset.is_multiple_of(alignment) && size.is_multiple_of(alignment) {
        return Ok(());
    }
    Err(GpuError::validation(format!(
        "{size} bytes from byte {offset}; expected multiples of {alignment}"
    )))
}
