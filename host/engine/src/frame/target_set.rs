//! Targets on the device: the textures of one viewport.

use wgpu::{TextureFormat, TextureUsages};

use super::targets::{PlaneFormat, TargetSpec};
use crate::device::{GpuDevice, GpuError};
use crate::gpu::texture_format;

/// One target on the device.
#[derive(Clone, Debug)]
pub struct GpuTarget {
    /// What it is.
    pub spec: TargetSpec,
    /// Its texture: an attachment, sampled, copied, and storage where the device can.
    pub texture: wgpu::Texture,
    /// All of the texture.
    pub view: wgpu::TextureView,
}

/// The textures of one viewport, all of one size.
#[derive(Clone, Debug, Default)]
pub struct TargetSet {
    size_px: [u32; 2],
    targets: Vec<GpuTarget>,
}

/// Whether fitting a [`TargetSet`] made new textures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fit {
    /// All textures are those of before, and in the order of before.
    Kept,
    /// Some are new or gone: import them again.
    Changed,
}

impl TargetSet {
    /// Makes the textures fit a size and a list of targets. Those that fit already are kept, with their contents; a target
    /// that is named twice gets one texture. After an error the set is as before.
    ///
    /// # Errors
    /// The size is zero or beyond the device's limit, the device cannot draw into a format, or its memory is used up.
    pub fn fit(
        &mut self,
        gpu: &GpuDevice,
        size_px: [u32; 2],
        specs: &[TargetSpec],
    ) -> Result<Fit, GpuError> {
        let limit = gpu.limits.max_texture_dimension_2d;
        let [width, height] = size_px;
        if width == 0 || height == 0 || width > limit || height > limit {
            return Err(GpuError::Unsupported(format!(
                "a picture of {width} × {height} px; this device draws from 1 to {limit} px a side: ask for another \
                 size, or draw in tiles"
            )));
        }
        let mut fit = Fit::Kept;
        let mut targets: Vec<GpuTarget> = Vec::with_capacity(specs.len());
        for spec in specs {
            if targets.iter().any(|target| target.spec.key == spec.key) {
                continue;
            }
            let same = |target: &&GpuTarget| {
                target.spec.key == spec.key && target.spec.format == spec.format
            };
            let old = self.targets.iter().find(same);
            if let Some(old) = old.filter(|_| self.size_px == size_px) {
                targets.push(GpuTarget {
                    spec: spec.clone(),
                    ..old.clone()
                });
            } else {
                targets.push(create(gpu, size_px, spec)?);
                fit = Fit::Changed;
            }
        }
        let keys = |targets: &[GpuTarget]| -> Vec<_> {
            targets
                .iter()
                .map(|target| target.spec.key.clone())
                .collect()
        };
        if keys(&targets) != keys(&self.targets) {
            fit = Fit::Changed;
        }
        *self = Self { size_px, targets };
        Ok(fit)
    }

    /// Sets all targets to their clear values, as attachments of passes that draw nothing: as few passes as the device's
    /// limits allow.
    pub fn clear(&self, gpu: &GpuDevice, encoder: &mut wgpu::CommandEncoder) {
        let mut depth = self.targets.iter().find(|target| is_depth(target));
        let colours: Vec<&GpuTarget> = self
            .targets
            .iter()
            .filter(|target| !is_depth(target))
            .collect();
        let mut rest = &colours[..];
        while !rest.is_empty() || depth.is_some() {
            let (pass, later) = rest.split_at(attachments_that_fit(rest, &gpu.limits));
            rest = later;
            let attachments: Vec<_> = pass.iter().map(|target| Some(cleared(target))).collect();
            encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("clear targets"),
                color_attachments: &attachments,
                depth_stencil_attachment: depth.take().map(|target| {
                    wgpu::RenderPassDepthStencilAttachment {
                        view: &target.view,
                        depth_ops: Some(wgpu::Operations {
                            load: wgpu::LoadOp::Clear(target.spec.clear[0] as f32),
                            store: wgpu::StoreOp::Store,
                        }),
                        stencil_ops: None,
                    }
                }),
                ..Default::default()
            });
        }
    }

    /// Width and height, px.
    pub fn size_px(&self) -> [u32; 2] {
        self.size_px
    }

    /// The targets, in the order asked for.
    pub fn targets(&self) -> &[GpuTarget] {
        &self.targets
    }

    /// The target of this key.
    pub fn get(&self, key: &str) -> Option<&GpuTarget> {
        self.targets.iter().find(|target| target.spec.key == key)
    }

    /// Bytes that the textures hold on the device.
    pub fn bytes(&self) -> u64 {
        let texel_bytes = |target: &GpuTarget| {
            let size = target.texture.format().block_copy_size(None);
            u64::from(size.unwrap_or(4)) // depth32float has four bytes, though it may not be copied everywhere
        };
        let pixels = u64::from(self.size_px[0]) * u64::from(self.size_px[1]);
        self.targets.iter().map(texel_bytes).sum::<u64>() * pixels
    }
}

fn is_depth(target: &GpuTarget) -> bool {
    target.texture.format().is_depth_stencil_format()
}

/// How many of the next attachments one pass may have, at least 1 of what there is.
fn attachments_that_fit(targets: &[&GpuTarget], limits: &wgpu::Limits) -> usize {
    let mut bytes = 0_u32;
    let fitting = targets.iter().take_while(|target| {
        let format = target.texture.format();
        let alignment = format.target_component_alignment().unwrap_or(4);
        // WebGPU, 'Calculating color attachment bytes per sample'.
        bytes = bytes.next_multiple_of(alignment) + format.target_pixel_byte_cost().unwrap_or(16);
        bytes <= limits.max_color_attachment_bytes_per_sample
    });
    let count = fitting.take(limits.max_color_attachments as usize).count();
    count.max(1).min(targets.len())
}

fn cleared(target: &GpuTarget) -> wgpu::RenderPassColorAttachment<'_> {
    let [r, g, b, a] = target.spec.clear;
    wgpu::RenderPassColorAttachment {
        view: &target.view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations {
            load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a }),
            store: wgpu::StoreOp::Store,
        },
    }
}

fn create(
    gpu: &GpuDevice,
    [width, height]: [u32; 2],
    spec: &TargetSpec,
) -> Result<GpuTarget, GpuError> {
    let format = texture_format(spec.format)?;
    let usage = usages(gpu, format);
    let needed = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
    if !usage.contains(needed) {
        return Err(GpuError::Unsupported(format!(
            "target '{}': the device cannot draw into {format:?}; do not request it, or choose another adapter",
            spec.key
        )));
    }
    let label = format!("target {}", spec.key);
    gpu.scoped(|| {
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(&label),
            size: wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        GpuTarget {
            spec: spec.clone(),
            texture,
            view,
        }
    })
}

/// What the device allows of what targets are used for.
fn usages(gpu: &GpuDevice, format: TextureFormat) -> TextureUsages {
    let specific = wgpu::Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES;
    let features = if gpu.features.contains(specific) {
        gpu.format_features(format)
    } else {
        format.guaranteed_format_features(gpu.features)
    };
    let wanted = TextureUsages::RENDER_ATTACHMENT
        | TextureUsages::TEXTURE_BINDING
        | TextureUsages::STORAGE_BINDING
        | TextureUsages::COPY_SRC
        | TextureUsages::COPY_DST;
    features.allowed_usages & wanted
}

impl GpuTarget {
    /// What shaders read from it.
    pub(super) fn plane_format(&self) -> PlaneFormat {
        self.spec.plane_format()
    }
}
