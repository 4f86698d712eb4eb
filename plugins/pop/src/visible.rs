//! Where visible primitives are written, for pictures of a size.

use crate::blending::{BlendedBuffers, BlendedTextures, SUM_BYTES};
use crate::passes::Passes;
use pointstage_plugin_api::Result;
use pointstage_plugin_api::abi::{self, BufferUsage, Format};
use pointstage_plugin_api::gpu::{AsHandle as _, BindGroup, Buffer, Texture};
use pointstage_visibility::{Large, Source, picture_texture};

/// Bytes of a pixel of the compute path: primitive and depth.
const PIXEL_BYTES: u64 = 8;

/// Where the visibility pass writes, for pictures of a size.
pub(crate) enum Visible {
    Buffers {
        size_px: [u32; 2],
        pixels: Buffer,
        large: Large,
        /// Group 3 of the kernels, and of shading.
        group: BindGroup,
        shading: BindGroup,
        /// Of blended splats; then `pixels` holds triangles alone.
        blended: Option<BlendedBuffers>,
    },
    Textures {
        size_px: [u32; 2],
        primitives: Texture,
        depth: Texture,
        shading: BindGroup,
        /// Of blended splats; then `primitives` holds triangles alone.
        blended: Option<BlendedTextures>,
    },
}

impl Visible {
    /// For pictures of a size, with blended splats or not.
    pub(crate) fn buffers(passes: &Passes, size_px: [u32; 2], is_blended: bool) -> Result<Self> {
        let gpu = &passes.gpu;
        let storage = BufferUsage::STORAGE | BufferUsage::COPY_DST;
        let pixels = gpu.buffer("visible pixels", pixel_bytes(size_px), storage)?;
        let large = Large::new(gpu, "large triangles")?;
        let group = gpu.bind_group(
            "visible pixels",
            &passes.pixels_layout,
            &[(0, &pixels), (1, &large.list)],
        )?;
        let bytes = pixel_bytes(size_px);
        let blended = is_blended
            .then(|| BlendedBuffers::new(passes, size_px, bytes, &large.list))
            .transpose()?;
        let shading = match &blended {
            Some(blended) => blended.shading(passes, &pixels)?,
            None => gpu.bind_group("visible pixels", &passes.visible_layout, &[(0, &pixels)])?,
        };
        Ok(Self::Buffers {
            size_px,
            pixels,
            large,
            group,
            shading,
            blended,
        })
    }

    /// For pictures of a size, with blended splats or not.
    pub(crate) fn textures(passes: &Passes, size_px: [u32; 2], is_blended: bool) -> Result<Self> {
        let gpu = &passes.gpu;
        let texture = |label, format| picture_texture(gpu, label, size_px, format);
        let primitives = texture("visible primitives", Format::R32_UINT)?;
        let depth = texture("depth", Format::DEPTH32_FLOAT)?;
        if is_blended {
            let blended = BlendedTextures::new(gpu, size_px)?;
            return Ok(Self::Textures {
                size_px,
                shading: blended.shading(passes, [&primitives, &depth])?,
                primitives,
                depth,
                blended: Some(blended),
            });
        }
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
            blended: None,
        })
    }

    /// Whether it is what a frame needs.
    pub(crate) fn fits(&self, size_px: [u32; 2], source: Source, is_blended: bool) -> bool {
        match self {
            Self::Buffers {
                size_px: its,
                blended,
                ..
            } => source == Source::Pixels && *its == size_px && blended.is_some() == is_blended,
            Self::Textures {
                size_px: its,
                blended,
                ..
            } => source == Source::Ids && *its == size_px && blended.is_some() == is_blended,
        }
    }
}

/// Bytes of the compute path's pixels.
fn pixel_bytes([width, height]: [u32; 2]) -> u64 {
    PIXEL_BYTES * u64::from(width) * u64::from(height)
}

/// Bytes of the largest buffer of the compute path.
pub(crate) fn buffer_bytes(size_px: [u32; 2], is_blended: bool) -> u64 {
    let a_pixel = if is_blended { SUM_BYTES } else { PIXEL_BYTES };
    pixel_bytes(size_px) / PIXEL_BYTES * a_pixel
}
