//! Where visible primitives are written, for pictures of a size.

use crate::passes::Passes;
use pointstage_plugin_api::Result;
use pointstage_plugin_api::abi::{self, BufferUsage, Format, TextureUsage};
use pointstage_plugin_api::gpu::{AsHandle as _, BindGroup, Buffer, Texture, TextureOptions};

/// Large triangles of a draw that the second kernel takes; `LARGE_COUNT` in the shader.
const LARGE_COUNT: u64 = 65_535;
/// Bytes of a pixel of the compute path: primitive and depth.
const PIXEL_BYTES: u64 = 8;

/// Where the visibility pass writes, for pictures of a size.
pub(crate) enum Visible {
    Buffers {
        size_px: [u32; 2],
        pixels: Buffer,
        large: Buffer,
        arguments: Buffer,
        /// Group 3 of the kernels, and of shading.
        group: BindGroup,
        shading: BindGroup,
    },
    Textures {
        size_px: [u32; 2],
        primitives: Texture,
        depth: Texture,
        shading: BindGroup,
    },
}

impl Visible {
    pub(crate) fn buffers(passes: &Passes, size_px: [u32; 2]) -> Result<Self> {
        let gpu = &passes.gpu;
        let storage = BufferUsage::STORAGE | BufferUsage::COPY_DST;
        let pixels = gpu.buffer("visible pixels", pixel_bytes(size_px), storage)?;
        let large = gpu.buffer(
            "large triangles",
            4 * (3 + LARGE_COUNT),
            storage | BufferUsage::COPY_SRC,
        )?;
        // Workgroups in x come from the count, one in y and z.
        let arguments = gpu.buffer_with("large dispatch", BufferUsage::INDIRECT, &[0_u32, 1, 1])?;
        let group = gpu.bind_group(
            "visible pixels",
            &passes.pixels_layout,
            &[(0, &pixels), (1, &large)],
        )?;
        let shading = gpu.bind_group("visible pixels", &passes.visible_layout, &[(0, &pixels)])?;
        Ok(Self::Buffers {
            size_px,
            pixels,
            large,
            arguments,
            group,
            shading,
        })
    }

    pub(crate) fn textures(passes: &Passes, size_px: [u32; 2]) -> Result<Self> {
        let gpu = &passes.gpu;
        let texture = |label, format| {
            gpu.texture(&TextureOptions {
                label,
                size: size_px,
                layers: 1,
                mip_level_count: 1,
                format,
                usage: TextureUsage::RENDER_ATTACHMENT | TextureUsage::TEXTURE_BINDING,
            })
        };
        let primitives = texture("visible primitives", Format::R32_UINT)?;
        let depth = texture("depth", Format::DEPTH32_FLOAT)?;
        let entries =
            [(0, primitives.as_handle()), (1, depth.as_handle())].map(|(binding, resource)| {
                abi::BindingRecord {
                    binding,
                    resource,
                    ..Default::default()
                }
            });
        let shading = gpu.bind_group_from(&abi::BindGroupDescriptor {
            label: "visible primitives".into(),
            layout: passes.textures_layout.handle(),
            entries: entries.as_slice().into(),
        })?;
        Ok(Self::Textures {
            size_px,
            primitives,
            depth,
            shading,
        })
    }
}

/// Bytes of the compute path's pixels.
pub(crate) fn pixel_bytes([width, height]: [u32; 2]) -> u64 {
    PIXEL_BYTES * u64::from(width) * u64::from(height)
}
