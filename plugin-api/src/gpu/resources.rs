//! Handles that own: a resource is freed when its last clone is dropped.

use super::Gpu;
use crate::abi::Handle;
use crate::error::Result;
use std::sync::Arc;

/// A resource of the plugin, or one that the host lends.
#[derive(Clone)]
struct Owned(Arc<Inner>);

struct Inner {
    handle: Handle,
    /// Absent for what the host lends.
    gpu: Option<Gpu>,
}

impl Drop for Inner {
    fn drop(&mut self) {
        if let Some(gpu) = &self.gpu {
            gpu.destroy(self.handle);
        }
    }
}

macro_rules! resource {
    ($($(#[$meta:meta])* $name:ident;)*) => {$(
        $(#[$meta])*
        ///
        /// Cheap to clone; freed when the last clone is dropped.
        #[derive(Clone)]
        pub struct $name(Owned);

        impl $name {
            pub(super) fn own(handle: Handle, gpu: &Gpu) -> Self {
                Self(Owned(Arc::new(Inner { handle, gpu: Some(gpu.clone()) })))
            }

            #[allow(dead_code, reason = "only layouts are lent")]
            pub(super) fn lent(handle: Handle) -> Self {
                Self(Owned(Arc::new(Inner { handle, gpu: None })))
            }

            /// The border's handle.
            pub fn handle(&self) -> Handle {
                self.0.0.handle
            }
        }
    )*};
}

resource! {
    /// A buffer.
    Buffer;
    /// A texture.
    Texture;
    /// A view of some levels or layers of a texture.
    TextureView;
    /// A sampler.
    Sampler;
    /// A shader module.
    Shader;
    /// A bind group layout.
    BindGroupLayout;
    /// A bind group.
    BindGroup;
    /// A render pipeline.
    RenderPipeline;
    /// A compute pipeline.
    ComputePipeline;
    /// The claim on a read-back.
    Ticket;
}

impl Ticket {
    /// The bytes, once they have arrived; never waits.
    pub fn poll(&self) -> Result<Option<Vec<u8>>> {
        match &self.0.0.gpu {
            Some(gpu) => gpu.poll(self),
            None => Ok(None),
        }
    }
}

/// A buffer of the host: a column of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BufferRef(pub(crate) Handle);

/// A bind group of the host: group 0 of a frame, group 1 of a draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GroupRef(pub(crate) Handle);

/// A texture of the host: a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextureRef(pub(crate) Handle);

/// What can be bound, drawn from or rendered to, by its handle.
pub trait AsHandle {
    /// The border's handle.
    fn as_handle(&self) -> Handle;
}

macro_rules! as_handle {
    ($($name:ty => |$value:ident| $handle:expr;)*) => {$(
        impl AsHandle for $name {
            fn as_handle(&self) -> Handle {
                let $value = self;
                $handle
            }
        }
    )*};
}

as_handle! {
    Buffer => |value| value.handle();
    Texture => |value| value.handle();
    TextureView => |value| value.handle();
    Sampler => |value| value.handle();
    BindGroup => |value| value.handle();
    BufferRef => |value| value.0;
    GroupRef => |value| value.0;
    TextureRef => |value| value.0;
    Handle => |value| *value;
}
