//! Making buffers, textures, views, samplers, shaders, layouts and bind groups from the border's descriptors.

use super::bytes::Charge;
use super::handles::{
    BufferEntry, GroupEntry, LayoutEntry, Resource, ShaderEntry, SharedCharge, Table, TextureEntry,
    ViewEntry,
};
use super::service::{Caller, GpuService};
use super::{convert, features, shader};
use crate::device::GpuError;
use pointstage_plugin_api::abi::{
    self, BindGroupDescriptor, BindGroupLayoutDescriptor, BindingKind, BindingLayoutRecord,
    BindingRecord, BufferDescriptor, Dimension, Handle, SamplerDescriptor, ShaderDescriptor,
    ShaderStages, TextureDescriptor, TextureViewDescriptor,
};
use std::sync::Arc;
use wgpu::{Features, TextureFormatFeatureFlags};

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

    pub(super) fn create_bind_group_layout(
        &self,
        caller: &Caller,
        descriptor: &BindGroupLayoutDescriptor<'_>,
    ) -> Result<Handle, GpuError> {
        let bindings = descriptor.entries.to_vec();
        let mut entries = Vec::with_capacity(bindings.len());
        for binding in &bindings {
            let at = |error: GpuError| error.at(format_args!("binding {}", binding.binding));
            self.check_binding_features(caller, binding).map_err(at)?;
            entries.push(layout_entry(binding).map_err(at)?);
        }
        let layout = self.gpu.scoped(|| {
            self.gpu
                .device
                .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                    label: Some(descriptor.label.as_str()),
                    entries: &entries,
                })
        })?;
        self.insert(caller, LayoutEntry { layout, bindings })
    }

    fn check_binding_features(
        &self,
        caller: &Caller,
        binding: &BindingLayoutRecord,
    ) -> Result<(), GpuError> {
        let granted = caller.state.granted;
        let reads = abi::StorageAccess::READ;
        let writes = binding.kind == BindingKind::STORAGE_BUFFER
            || binding.kind == BindingKind::STORAGE_TEXTURE && binding.access != reads;
        if writes && binding.visibility.contains(ShaderStages::VERTEX) {
            let what = "writing in a vertex shader";
            features::require(&self.gpu, granted, Features::VERTEX_WRITABLE_STORAGE, what)?;
        }
        if binding.kind != BindingKind::STORAGE_TEXTURE {
            return Ok(());
        }
        use TextureFormatFeatureFlags as Flags;
        let needed = match convert::storage_access(binding.access)? {
            wgpu::StorageTextureAccess::WriteOnly => Flags::STORAGE_WRITE_ONLY,
            wgpu::StorageTextureAccess::ReadOnly => Flags::STORAGE_READ_ONLY,
            wgpu::StorageTextureAccess::ReadWrite => Flags::STORAGE_READ_WRITE,
            wgpu::StorageTextureAccess::Atomic => Flags::STORAGE_ATOMIC,
        };
        features::require_of_format(
            &self.gpu,
            granted,
            convert::format(binding.format)?,
            &format!(
                "a {:?} storage texture of {:?}",
                binding.access, binding.format
            ),
            |features| features.flags.contains(needed),
        )
    }

    pub(super) fn create_bind_group(
        &self,
        caller: &Caller,
        descriptor: &BindGroupDescriptor<'_>,
    ) -> Result<Handle, GpuError> {
        let table = self.read();
        let layout = table.layout(caller.owner, descriptor.layout)?;
        let mut entries = Vec::with_capacity(descriptor.entries.len());
        let mut charges = Vec::new();
        for record in descriptor.entries {
            let at = |error: GpuError| error.at(format_args!("binding {}", record.binding));
            let (resource, charge) = self
                .binding(&table, caller, &layout.bindings, record)
                .map_err(at)?;
            charges.extend(charge.cloned());
            entries.push(wgpu::BindGroupEntry {
                binding: record.binding,
                resource,
            });
        }
        let group = self.gpu.scoped(|| {
            self.gpu
                .device
                .create_bind_group(&wgpu::BindGroupDescriptor {
                    label: Some(descriptor.label.as_str()),
                    layout: &layout.layout,
                    entries: &entries,
                })
        })?;
        let dynamic_offsets = layout
            .bindings
            .iter()
            .filter(|binding| binding.dynamic_offset != 0)
            .count();
        drop(entries);
        drop(table);
        self.insert(
            caller,
            GroupEntry {
                group,
                dynamic_offsets,
                charges,
            },
        )
    }

    /// One resource of a bind group, checked against its entry of the layout.
    fn binding<'t>(
        &self,
        table: &'t Table,
        caller: &Caller,
        layout: &[BindingLayoutRecord],
        record: &BindingRecord,
    ) -> Result<(wgpu::BindingResource<'t>, Option<&'t Arc<Charge>>), GpuError> {
        let owner = caller.owner;
        let Some(entry) = layout.iter().find(|entry| entry.binding == record.binding) else {
            return Err(GpuError::validation("the layout has no such binding"));
        };
        match entry.kind {
            BindingKind::UNIFORM_BUFFER
            | BindingKind::STORAGE_BUFFER
            | BindingKind::STORAGE_BUFFER_READ => {
                let buffer = table.buffer(owner, record.resource)?;
                if entry.kind == BindingKind::STORAGE_BUFFER && table.is_hosts(record.resource) {
                    return Err(hosts_buffer());
                }
                let binding = wgpu::BufferBinding {
                    buffer: &buffer.buffer,
                    offset: record.offset,
                    // 0 is 'all that remain'.
                    size: wgpu::BufferSize::new(record.size),
                };
                Ok((
                    wgpu::BindingResource::Buffer(binding),
                    shared(&buffer.charge),
                ))
            }
            BindingKind::SAMPLER
            | BindingKind::SAMPLER_NON_FILTERING
            | BindingKind::SAMPLER_COMPARISON => {
                let sampler = table.sampler(owner, record.resource)?;
                Ok((wgpu::BindingResource::Sampler(sampler), None))
            }
            _ => {
                let (view, charge) = table.any_view(owner, record.resource)?;
                if entry.kind == BindingKind::TEXTURE {
                    self.check_filterable(caller, entry, view)?;
                }
                Ok((wgpu::BindingResource::TextureView(view), shared(charge)))
            }
        }
    }

    /// Refuses filtered reads of 32-bit floats without the feature.
    fn check_filterable(
        &self,
        caller: &Caller,
        entry: &BindingLayoutRecord,
        view: &wgpu::TextureView,
    ) -> Result<(), GpuError> {
        use wgpu::TextureFormat as F;
        let filtered = matches!(
            entry.sample_type,
            abi::SampleType::FLOAT | abi::SampleType(0)
        ) && entry.multisampled == 0;
        let format = view.texture().format();
        if !filtered || !matches!(format, F::R32Float | F::Rg32Float | F::Rgba32Float) {
            return Ok(());
        }
        let what = format!("{format:?} with the sample type FLOAT (FLOAT_UNFILTERABLE needs none)");
        let granted = caller.state.granted;
        features::require(&self.gpu, granted, Features::FLOAT32_FILTERABLE, &what)
    }
}

/// The host's buffers are there for reading: the next plugin needs them as they are.
pub(super) fn hosts_buffer() -> GpuError {
    GpuError::validation("the buffer is the host's and read-only; copy it into one of your own")
}

fn shared(charge: &SharedCharge) -> Option<&Arc<Charge>> {
    charge.as_ref()
}

impl Table {
    /// The view of a texture view, or the whole view of a texture.
    pub(super) fn any_view(
        &self,
        owner: super::Owner,
        handle: Handle,
    ) -> Result<(&wgpu::TextureView, &SharedCharge), GpuError> {
        match self.get(owner, handle) {
            Some(Resource::Texture(entry)) => Ok((&entry.view, &entry.charge)),
            Some(Resource::View(entry)) => Ok((&entry.view, &entry.charge)),
            _ => Err(self.refusal(owner, handle, "a texture or a texture view")),
        }
    }
}

/// One entry of a layout in wgpu's words.
pub(super) fn layout_entry(
    binding: &BindingLayoutRecord,
) -> Result<wgpu::BindGroupLayoutEntry, GpuError> {
    use wgpu::{BindingType as Type, BufferBindingType as Buffer, SamplerBindingType as Sampler};
    let buffer = |ty| Type::Buffer {
        ty,
        has_dynamic_offset: binding.dynamic_offset != 0,
        min_binding_size: wgpu::BufferSize::new(binding.min_size),
    };
    let ty = match binding.kind {
        BindingKind::UNIFORM_BUFFER => buffer(Buffer::Uniform),
        BindingKind::STORAGE_BUFFER_READ => buffer(Buffer::Storage { read_only: true }),
        BindingKind::STORAGE_BUFFER => buffer(Buffer::Storage { read_only: false }),
        BindingKind::SAMPLER => Type::Sampler(Sampler::Filtering),
        BindingKind::SAMPLER_NON_FILTERING => Type::Sampler(Sampler::NonFiltering),
        BindingKind::SAMPLER_COMPARISON => Type::Sampler(Sampler::Comparison),
        BindingKind::TEXTURE => Type::Texture {
            sample_type: convert::sample_type(binding.sample_type)?,
            view_dimension: convert::view_dimension(binding.dimension)?,
            multisampled: binding.multisampled != 0,
        },
        BindingKind::STORAGE_TEXTURE => Type::StorageTexture {
            access: convert::storage_access(binding.access)?,
            format: convert::format(binding.format)?,
            view_dimension: convert::view_dimension(binding.dimension)?,
        },
        BindingKind(number) => {
            return Err(GpuError::Unsupported(format!(
                "binding kind {number} is not known to this host; update the host, or choose another"
            )));
        }
    };
    Ok(wgpu::BindGroupLayoutEntry {
        binding: binding.binding,
        visibility: convert::stages(binding.visibility)?,
        ty,
        count: None,
    })
}

/// Bytes of a texture with all its levels and samples. An estimate: drivers pad.
fn texture_bytes(descriptor: &wgpu::TextureDescriptor<'_>) -> u64 {
    let levels: u64 = (0..descriptor.mip_level_count)
        .filter_map(|level| descriptor.mip_level_size(level))
        .map(|size| descriptor.format.theoretical_memory_footprint(size))
        .sum();
    levels * u64::from(descriptor.sample_count)
}
