//! Making buffers, textures, views, samplers and shaders from the border's descriptors.

use super::handles::{BufferEntry, ShaderEntry, TextureEntry, ViewEntry};
use super::service::{Caller, GpuService};
use super::{convert, features, shader};
use crate::device::GpuError;
use pointstage_plugin_api::abi::{
    self, BufferDescriptor, Dimension, Handle, SamplerDescriptor, ShaderDescriptor,
    TextureDescriptor, TextureViewDescriptor,
};
use std::sync::Arc;

impl GpuService {
    pub(super) fn create_buffer(
        &self,
        caller: &Caller,
        descriptor: &BufferDescriptor<'_>,
    ) -> Result<Handle, GpuError> {
        let BufferDescriptor { label, size, usage } = *descriptor;
        let most = self.gpu.limits.max_buffer_size;
        if size == 0 || !size.is_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT) || size > most {
            return Err(GpuError::validation(format!(
                "{size} bytes; expected a multiple of 4 from 4 to {most}; pad it, or split the data"
            )));
        }
        let wgpu_usage = convert::buffer_usage(usage)?;
        let charge = Arc::new(caller.state.charge(size)?);
        let buffer = self.gpu.scoped(|| {
            self.gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label.as_str()),
                size,
                usage: wgpu_usage,
                mapped_at_creation: false,
            })
        })?;
        self.insert(
            caller,
            BufferEntry {
                buffer,
                usage,
                charge: Some(charge),
            },
        )
    }

    pub(super) fn create_texture(
        &self,
        caller: &Caller,
        descriptor: &TextureDescriptor<'_>,
    ) -> Result<Handle, GpuError> {
        let granted = caller.state.granted;
        let format = convert::format(descriptor.format)?;
        let dimension = convert::texture_dimension(descriptor.dimension)?;
        let usage = convert::texture_usage(descriptor.usage)?;
        features::require_of_format(
            &self.gpu,
            granted,
            format,
            &format!("usage {:?} of {:?}", usage, descriptor.format),
            |features| features.allowed_usages.contains(usage),
        )?;
        let [width, height, depth_or_array_layers] = descriptor.size;
        self.check_texture_size(dimension, descriptor.size)?;
        let size = wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers,
        };
        let descriptor = wgpu::TextureDescriptor {
            label: Some(descriptor.label.as_str()),
            size,
            // 0 is 'default'.
            mip_level_count: descriptor.mip_level_count.max(1),
            sample_count: descriptor.sample_count.max(1),
            dimension,
            format,
            usage,
            view_formats: &[],
        };
        let most_levels = size.max_mips(dimension);
        if descriptor.mip_level_count > most_levels {
            return Err(GpuError::validation(format!(
                "{} mip levels; this size has at most {most_levels}",
                descriptor.mip_level_count
            )));
        }
        let charge = Arc::new(caller.state.charge(texture_bytes(&descriptor))?);
        let (texture, view) = self.gpu.scoped(|| {
            let texture = self.gpu.device.create_texture(&descriptor);
            let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
            (texture, view)
        })?;
        self.insert(
            caller,
            TextureEntry {
                texture,
                view,
                charge: Some(charge),
            },
        )
    }

    fn check_texture_size(
        &self,
        dimension: wgpu::TextureDimension,
        size: [u32; 3],
    ) -> Result<(), GpuError> {
        let limits = &self.gpu.limits;
        let most = match dimension {
            wgpu::TextureDimension::D1 => [limits.max_texture_dimension_1d, 1, 1],
            wgpu::TextureDimension::D2 => [
                limits.max_texture_dimension_2d,
                limits.max_texture_dimension_2d,
                limits.max_texture_array_layers,
            ],
            wgpu::TextureDimension::D3 => [limits.max_texture_dimension_3d; 3],
        };
        if size
            .iter()
            .zip(most)
            .all(|(n, most)| (1..=most).contains(n))
        {
            return Ok(());
        }
        Err(GpuError::validation(format!(
            "{} x {} x {} texels; expected 1 x 1 x 1 to {} x {} x {}",
            size[0], size[1], size[2], most[0], most[1], most[2]
        )))
    }

    pub(super) fn create_texture_view(
        &self,
        caller: &Caller,
        descriptor: &TextureViewDescriptor<'_>,
    ) -> Result<Handle, GpuError> {
        let (texture, charge) = {
            let table = self.read();
            let entry = table.texture(caller.owner, descriptor.texture)?;
            (entry.texture.clone(), entry.charge.clone())
        };
        let dimension = if descriptor.dimension == Dimension(0) {
            None
        } else {
            Some(convert::view_dimension(descriptor.dimension)?)
        };
        let view = self.gpu.scoped(|| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                label: Some(descriptor.label.as_str()),
                dimension,
                base_mip_level: descriptor.base_mip_level,
                // 0 is 'all that remain'.
                mip_level_count: (descriptor.mip_level_count != 0)
                    .then_some(descriptor.mip_level_count),
                base_array_layer: descriptor.base_layer,
                array_layer_count: (descriptor.layer_count != 0).then_some(descriptor.layer_count),
                ..Default::default()
            })
        })?;
        self.insert(caller, ViewEntry { view, charge })
    }

    pub(super) fn create_sampler(
        &self,
        caller: &Caller,
        descriptor: &SamplerDescriptor<'_>,
    ) -> Result<Handle, GpuError> {
        let [u, v, w] = descriptor.address;
        let descriptor = wgpu::SamplerDescriptor {
            label: Some(descriptor.label.as_str()),
            address_mode_u: convert::address_mode(u)?,
            address_mode_v: convert::address_mode(v)?,
            address_mode_w: convert::address_mode(w)?,
            mag_filter: convert::filter(descriptor.magnify)?,
            min_filter: convert::filter(descriptor.minify)?,
            mipmap_filter: convert::mip_filter(descriptor.mip)?,
            lod_min_clamp: descriptor.lod_min,
            lod_max_clamp: descriptor.lod_max,
            compare: if descriptor.compare == abi::Compare(0) {
                None
            } else {
                Some(convert::compare(descriptor.compare)?)
            },
            // WebGPU's own most; more is taken as the most.
            anisotropy_clamp: descriptor.anisotropy.clamp(1, 16) as u16,
            border_color: None,
        };
        let sampler = self
            .gpu
            .scoped(|| self.gpu.device.create_sampler(&descriptor))?;
        self.insert(caller, sampler)
    }

    pub(super) fn create_shader(
        &self,
        caller: &Caller,
        descriptor: &ShaderDescriptor<'_>,
    ) -> Result<Handle, GpuError> {
        let (label, wgsl) = (descriptor.label.as_str(), descriptor.wgsl.as_str());
        let interface = shader::check(&self.gpu, caller.state.granted, label, wgsl)?;
        let module = self.gpu.scoped(|| {
            self.gpu
                .device
                .create_shader_module(wgpu::ShaderModuleDescriptor {
                    label: Some(label),
                    source: wgpu::ShaderSource::Wgsl(wgsl.into()),
                })
        })?;
        self.insert(
            caller,
            ShaderEntry {
                label: label.into(),
                module,
                interface,
            },
        )
    }
}

/// The host's buffers are there for reading: the next plugin needs them as they are.
pub(super) fn hosts_buffer() -> GpuError {
    GpuError::validation("the buffer is the host's and read-only; copy it into one of your own")
}

/// Bytes of a texture with all its levels and samples. An estimate: drivers pad.
fn texture_bytes(descriptor: &wgpu::TextureDescriptor<'_>) -> u64 {
    let levels: u64 = (0..descriptor.mip_level_count)
        .filter_map(|level| descriptor.mip_level_size(level))
        .map(|size| descriptor.format.theoretical_memory_footprint(size))
        .sum();
    levels * u64::from(descriptor.sample_count)
}
