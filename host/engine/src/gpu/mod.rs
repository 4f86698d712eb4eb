//! The GPU service: what plugins may do with the device, checked.
//!
//! A plugin holds handles only. What it asks for arrives as a descriptor ([`GpuObject`](pointstage_plugin_api::abi)'s
//! methods, in `object`), is checked and converted (`create`, `pipelines`, `shader`, `convert`, `features`), made inside
//! an error scope and kept in one table (`handles`), charged to its owner (`bytes`). What it draws arrives as a list of
//! recorded commands, which `replay` walks once: every handle, state and number is checked before wgpu sees it, and
//! nothing is submitted unless all of it is right. Read-backs are tickets (`tickets`), pass times come from timestamps
//! (`timing`); neither ever waits.
//!
//! The host's own resources (scene columns, targets, groups 0 and 1) are imported; every owner may use them, but none
//! may write the buffers among them.

mod bindings;
mod bytes;
mod convert;
mod create;
mod features;
mod handles;
mod object;
mod pipelines;
mod replay;
mod service;
mod shader;
mod tickets;
mod timing;
mod walk;
mod write;

pub(crate) use features::by_name as feature_by_name;
pub use handles::Owner;
pub(crate) use object::limit as limit_by_name;
pub use replay::Replay;
pub use service::GpuService;
pub use timing::{PassTime, PassTimes, Timings};

/// wgpu's name for a texel format of the border.
///
/// # Errors
/// The number is not known to this host.
pub(crate) fn texture_format(
    format: pointstage_plugin_api::abi::Format,
) -> Result<wgpu::TextureFormat, crate::device::GpuError> {
    convert::format(format)
}
