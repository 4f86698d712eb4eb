//! What the paths of a viewport draw into, of the picture's size.

use crate::pipelines::Prepared;
use crate::rectangle::PixelRectangle;
use crate::targets::picture_texture;
use pointstage_plugin_api::Result;
use pointstage_plugin_api::abi::commands::{ClearBuffer, CopyBufferToBuffer};
use pointstage_plugin_api::abi::{BufferUsage, Format};
use pointstage_plugin_api::gpu::{AsHandle as _, BindGroup, Buffer, Gpu, Recorder, Texture};

/// Bytes of a pixel of the compute path: id and depth.
pub(crate) const PIXEL_BYTES: u64 = 8;

/// Splats or triangles of a draw that the second kernel takes; `LARGE_COUNT` in the shaders.
pub const LARGE_COUNT: u32 = 65_535;

/// Own targets of the raster path, where the host did not ask for them.
pub(crate) struct RasterBuffers {
    size_px: [u32; 2],
    pub(crate) ids: Texture,
    pub(crate) depth: Texture,
}

impl RasterBuffers {
    /// Those of a viewport, made anew where it has none of this size.
    ///
    /// # Errors
    /// If the device refuses a texture.
    pub(crate) fn ready(kept: &mut Option<Self>, gpu: &Gpu, size_px: [u32; 2]) -> Result<()> {
        if kept
            .as_ref()
            .is_some_and(|buffers| buffers.size_px == size_px)
        {
            return Ok(());
        }
        let texture = |label, format| picture_texture(gpu, label, size_px, format);
        *kept = Some(Self {
            size_px,
            ids: texture("visible ids", Format::R32_UINT)?,
            depth: texture("depth", Format::DEPTH32_FLOAT)?,
        });
        Ok(())
    }
}

/// Buffers of the compute path.
pub(crate) struct ComputeBuffers {
    byte_count: u64,
    pub(crate) pixels: Buffer,
    pub(crate) large: Large,
    pub(crate) group: BindGroup,
}

impl ComputeBuffers {
    /// Those of a viewport, made anew where it has none for a picture of this size.
    ///
    /// # Errors
    /// If the device refuses a buffer.
    pub(crate) fn ready(
        kept: &mut Option<Self>,
        prepared: &Prepared,
        [width, height]: [u32; 2],
    ) -> Result<()> {
        let byte_count = PIXEL_BYTES * u64::from(width) * u64::from(height);
        if kept
            .as_ref()
            .is_some_and(|buffers| buffers.byte_count == byte_count)
        {
            return Ok(());
        }
        let gpu = &prepared.gpu;
        let storage = BufferUsage::STORAGE | BufferUsage::COPY_DST;
        let pixels = gpu.buffer("visible pixels", byte_count, storage)?;
        let large = Large::new(gpu, "large surfels")?;
        let group = gpu.bind_group(
            "visible pixels",
            &prepared.pixels_layout,
            &[(0, &pixels), (1, &large.list)],
        )?;
        *kept = Some(Self {
            byte_count,
            pixels,
            large,
            group,
        });
        Ok(())
    }
}

/// What a draw's first kernel leaves to the second one, which takes a workgroup for each: splats or triangles of many pixels.
pub struct Large {
    /// How many there are, two numbers that are not used, and which.
    pub list: Buffer,
    /// Arguments of the second kernel's dispatch.
    arguments: Buffer,
}

impl Large {
    /// For [`LARGE_COUNT`] of them.
    ///
    /// # Errors
    /// If the device refuses a buffer.
    pub fn new(gpu: &Gpu, label: &str) -> Result<Self> {
        let list = gpu.buffer(
            label,
            4 * (3 + u64::from(LARGE_COUNT)),
            BufferUsage::STORAGE | BufferUsage::COPY_DST | BufferUsage::COPY_SRC,
        )?;
        // Workgroups in x come from the count, one in y and z.
        let arguments = gpu.buffer_with("large dispatch", BufferUsage::INDIRECT, &[0_u32, 1, 1])?;
        Ok(Self { list, arguments })
    }

    /// Empties the list, before a draw's first kernel.
    pub fn clear(&self, recorder: &mut Recorder) {
        recorder.push(ClearBuffer {
            buffer: self.list.as_handle(),
            offset: 0,
            size: 4,
        });
    }

    /// Makes the arguments of the second kernel's dispatch of what the first one has found; these.
    ///
    /// A buffer cannot be written and give a dispatch its arguments at once.
    pub fn dispatch_arguments(&self, recorder: &mut Recorder) -> &Buffer {
        recorder.push(CopyBufferToBuffer {
            source: self.list.as_handle(),
            source_offset: 0,
            target: self.arguments.as_handle(),
            target_offset: 0,
            size: 4,
        });
        &self.arguments
    }
}

/// Places of a rectangle's rows in a buffer of all pixels.
pub fn rows_of(pixels: PixelRectangle, size_px: [u32; 2]) -> core::ops::Range<usize> {
    let row = |row: u32| row as usize * size_px[0] as usize;
    row(pixels.origin[1])..row(pixels.origin[1] + pixels.size[1])
}
