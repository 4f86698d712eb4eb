//! Making layouts and bind groups from the border's descriptors.

use super::bytes::Charge;
use super::create::hosts_buffer;
use super::handles::{GroupEntry, LayoutEntry, Resource, SharedCharge, Table};
use super::service::{Caller, GpuService};
use super::{convert, features};
use crate::device::GpuError;
use pointstage_plugin_api::abi::{
    self, BindGroupDescriptor, BindGroupLayoutDescriptor, BindingKind, BindingLayoutRecord,
    BindingRecord, Handle, ShaderStages,
};
use std::sync::Arc;
use wgpu::{Features, TextureFormatFeatureFlags};

impl GpuService {
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
