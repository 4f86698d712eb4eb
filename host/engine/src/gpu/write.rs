//! Writes from the CPU: data is copied at once and lands before any command submitted or recorded later.

use super::create::hosts_buffer;
use super::service::{Caller, GpuService};
use crate::device::GpuError;
use pointstage_plugin_api::abi::{BufferUsage, Handle, TextureWriteRecord};

impl GpuService {
    pub(super) fn write_buffer(
        &self,
        caller: &Caller,
        handle: Handle,
        offset: u64,
        data: &[u8],
    ) -> Result<(), GpuError> {
        let table = self.read();
        let entry = table.buffer(caller.owner, handle)?;
        if table.is_hosts(handle) {
            return Err(hosts_buffer());
        }
        if !entry.usage.contains(BufferUsage::COPY_DST) {
            return Err(GpuError::validation(
                "the buffer cannot be written from the CPU; create it with the usage COPY_DST",
            ));
        }
        let (bytes, size) = (data.len() as u64, entry.buffer.size());
        if offset.checked_add(bytes).is_none_or(|end| end > size) {
            return Err(GpuError::validation(format!(
                "{bytes} bytes from byte {offset} go past the end of a buffer of {size} bytes; \
                 write less, or create a larger one"
            )));
        }
        let alignment = wgpu::COPY_BUFFER_ALIGNMENT;
        if !offset.is_multiple_of(alignment) || !bytes.is_multiple_of(alignment) {
            return Err(GpuError::validation(format!(
                "{bytes} bytes from byte {offset}; expected multiples of {alignment}; pad the data"
            )));
        }
        if data.is_empty() {
            return Ok(());
        }
        self.gpu
            .scoped(|| self.gpu.queue.write_buffer(&entry.buffer, offset, data))
    }

    pub(super) fn write_texture(
        &self,
        caller: &Caller,
        target: &TextureWriteRecord,
        data: &[u8],
    ) -> Result<(), GpuError> {
        let table = self.read();
        let entry = table.texture(caller.owner, target.texture)?;
        let [x, y, z] = target.origin;
        let [width, height, depth_or_array_layers] = target.size;
        self.gpu.scoped(|| {
            self.gpu.queue.write_texture(
                wgpu::TexelCopyTextureInfo {
                    texture: &entry.texture,
                    mip_level: target.mip_level,
                    origin: wgpu::Origin3d { x, y, z },
                    aspect: wgpu::TextureAspect::All,
                },
                data,
                wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: (target.bytes_per_row != 0).then_some(target.bytes_per_row),
                    rows_per_image: (target.rows_per_image != 0).then_some(target.rows_per_image),
                },
                wgpu::Extent3d {
                    width,
                    height,
                    depth_or_array_layers,
                },
            );
        })
    }
}
