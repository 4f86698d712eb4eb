//! The service as one plugin instance sees it: the border's object, where nothing panics and every error is a record.

use super::features;
use super::service::{Caller, GpuService};
use super::tickets::Ticket;
use super::timing::Timings;
use crate::device::GpuError;
use abi_stable::std_types::{ROption, RResult, RSlice, RStr, RVec};
use pointstage_plugin_api::abi::commands::CommandListRecord;
use pointstage_plugin_api::abi::{
    BindGroupDescriptor, BindGroupLayoutDescriptor, BufferDescriptor, ComputePipelineDescriptor,
    DeviceRecord, ErrorRecord, ExtensionBox, GpuObject, Handle, RenderPipelineDescriptor,
    SamplerDescriptor, ShaderDescriptor, TextureDescriptor, TextureViewDescriptor,
    TextureWriteRecord,
};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// One owner's way into the service.
pub(super) struct OwnerGpu {
    pub(super) service: Arc<GpuService>,
    pub(super) caller: Caller,
}

/// Runs `f`; a panic becomes an error, as one that crossed the border would end the process.
pub(super) fn catching<T>(f: impl FnOnce() -> Result<T, GpuError>) -> Result<T, GpuError> {
    catch_unwind(AssertUnwindSafe(f)).unwrap_or_else(|panic| {
        Err(GpuError::Panicked(format!(
            "the GPU service panicked ({}); this is a bug of Pointstage, please report it",
            panic_text(panic.as_ref())
        )))
    })
}

fn panic_text(panic: &(dyn Any + Send)) -> &str {
    panic
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("no message")
}

impl OwnerGpu {
    fn guarded<T>(
        &self,
        f: impl FnOnce(&GpuService, &Caller) -> Result<T, GpuError>,
    ) -> RResult<T, ErrorRecord> {
        catching(|| {
            self.service.gpu.check_not_lost()?;
            f(&self.service, &self.caller)
        })
        .map_err(ErrorRecord::from)
        .into()
    }

    /// As [`guarded`](Self::guarded), with what was to be made in the message.
    fn creating<T>(
        &self,
        what: &str,
        label: RStr<'_>,
        f: impl FnOnce(&GpuService, &Caller) -> Result<T, GpuError>,
    ) -> RResult<T, ErrorRecord> {
        self.guarded(|service, caller| {
            service.gpu.check_alive()?;
            f(service, caller).map_err(|error| error.at(format_args!("{what} '{label}'")))
        })
    }
}

impl GpuObject for OwnerGpu {
    fn device(&self) -> DeviceRecord {
        let gpu = &self.service.gpu;
        DeviceRecord {
            name: gpu.info.name.as_str().into(),
            backend: gpu.backend_name().into(),
            is_software: u32::from(gpu.is_software()),
            generation: gpu.generation,
        }
    }

    fn limit(&self, name: RStr<'_>) -> ROption<u64> {
        limit(&self.service.gpu.limits, name.as_str()).into()
    }

    fn feature(&self, name: RStr<'_>) -> u32 {
        let granted = self.caller.state.granted;
        let known = features::by_name(name.as_str());
        u32::from(known.is_some_and(|feature| granted.contains(feature)))
    }

    fn standard_layout(&self, index: u32) -> RResult<Handle, ErrorRecord> {
        self.guarded(|service, _| service.standard_layout(index))
    }

    fn create_buffer(&self, descriptor: &BufferDescriptor<'_>) -> RResult<Handle, ErrorRecord> {
        self.creating("buffer", descriptor.label, |service, caller| {
            service.create_buffer(caller, descriptor)
        })
    }

    fn create_texture(&self, descriptor: &TextureDescriptor<'_>) -> RResult<Handle, ErrorRecord> {
        self.creating("texture", descriptor.label, |service, caller| {
            service.create_texture(caller, descriptor)
        })
    }

    fn create_texture_view(
        &self,
        descriptor: &TextureViewDescriptor<'_>,
    ) -> RResult<Handle, ErrorRecord> {
        self.creating("texture view", descriptor.label, |service, caller| {
            service.create_texture_view(caller, descriptor)
        })
    }

    fn create_sampler(&self, descriptor: &SamplerDescriptor<'_>) -> RResult<Handle, ErrorRecord> {
        self.creating("sampler", descriptor.label, |service, caller| {
            service.create_sampler(caller, descriptor)
        })
    }

    fn create_shader(&self, descriptor: &ShaderDescriptor<'_>) -> RResult<Handle, ErrorRecord> {
        // The message has the label already, with line and column.
        self.guarded(|service, caller| service.create_shader(caller, descriptor))
    }

    fn create_bind_group_layout(
        &self,
        descriptor: &BindGroupLayoutDescriptor<'_>,
    ) -> RResult<Handle, ErrorRecord> {
        self.creating("bind group layout", descriptor.label, |service, caller| {
            service.create_bind_group_layout(caller, descriptor)
        })
    }

    fn create_bind_group(
        &self,
        descriptor: &BindGroupDescriptor<'_>,
    ) -> RResult<Handle, ErrorRecord> {
        self.creating("bind group", descriptor.label, |service, caller| {
            service.create_bind_group(caller, descriptor)
        })
    }

    fn create_render_pipeline(
        &self,
        descriptor: &RenderPipelineDescriptor<'_>,
    ) -> RResult<Handle, ErrorRecord> {
        self.creating("render pipeline", descriptor.label, |service, caller| {
            service.create_render_pipeline(caller, descriptor)
        })
    }

    fn create_compute_pipeline(
        &self,
        descriptor: &ComputePipelineDescriptor<'_>,
    ) -> RResult<Handle, ErrorRecord> {
        self.creating("compute pipeline", descriptor.label, |service, caller| {
            service.create_compute_pipeline(caller, descriptor)
        })
    }

    fn write_buffer(
        &self,
        buffer: Handle,
        offset: u64,
        data: RSlice<'_, u8>,
    ) -> RResult<(), ErrorRecord> {
        self.guarded(|service, caller| {
            service
                .write_buffer(caller, buffer, offset, data.as_slice())
                .map_err(|error| error.at("writing a buffer"))
        })
    }

    fn write_texture(
        &self,
        target: &TextureWriteRecord,
        data: RSlice<'_, u8>,
    ) -> RResult<(), ErrorRecord> {
        self.guarded(|service, caller| {
            service
                .write_texture(caller, target, data.as_slice())
                .map_err(|error| error.at("writing a texture"))
        })
    }

    fn submit(&self, commands: &CommandListRecord) -> RResult<(), ErrorRecord> {
        self.guarded(|service, caller| service.run(caller, commands, Timings::Off).map(|_| ()))
    }

    fn create_ticket(&self) -> RResult<Handle, ErrorRecord> {
        self.guarded(|service, caller| service.insert(caller, Arc::new(Ticket::default())))
    }

    fn poll_ticket(&self, ticket: Handle) -> RResult<ROption<RVec<u8>>, ErrorRecord> {
        self.guarded(|service, caller| {
            // Runs the callbacks of finished copies.
            service.gpu.check_alive()?;
            let ticket = Arc::clone(service.read().ticket(caller.owner, ticket)?);
            Ok(ticket.take()?.map(RVec::from).into())
        })
    }

    fn destroy(&self, handle: Handle) {
        // There is nobody to tell, and a resource that could not be freed goes with its owner.
        catching(|| {
            self.service.remove(self.caller.owner, handle);
            Ok(())
        })
        .ok();
    }

    fn extension(&self, _name: RStr<'_>) -> ROption<ExtensionBox> {
        ROption::RNone
    }
}

/// Declares the limits that plugins may ask for: wgpu's fields by their names.
macro_rules! limits {
    ($($name:ident)*) => {
        pub(crate) fn limit(limits: &wgpu::Limits, name: &str) -> Option<u64> {
            match name {
                $(stringify!($name) => Some(u64::from(limits.$name)),)*
                _ => None,
            }
        }
    };
}

limits! {
    max_texture_dimension_1d max_texture_dimension_2d max_texture_dimension_3d max_texture_array_layers
    max_bind_groups max_bind_groups_plus_vertex_buffers max_bindings_per_bind_group
    max_dynamic_uniform_buffers_per_pipeline_layout max_dynamic_storage_buffers_per_pipeline_layout
    max_sampled_textures_per_shader_stage max_samplers_per_shader_stage
    max_storage_buffers_per_shader_stage max_storage_textures_per_shader_stage
    max_uniform_buffers_per_shader_stage max_uniform_buffer_binding_size max_storage_buffer_binding_size
    max_vertex_buffers max_buffer_size max_vertex_attributes max_vertex_buffer_array_stride
    max_inter_stage_shader_variables min_uniform_buffer_offset_alignment min_storage_buffer_offset_alignment
    max_color_attachments max_color_attachment_bytes_per_sample max_compute_workgroup_storage_size
    max_compute_invocations_per_workgroup max_compute_workgroup_size_x max_compute_workgroup_size_y
    max_compute_workgroup_size_z max_compute_workgroups_per_dimension max_immediate_size
}
