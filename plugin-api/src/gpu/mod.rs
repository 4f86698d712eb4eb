//! The GPU service: typed resources that free themselves, and recorded commands.
//!
//! Everything is made through [`Gpu`], which mirrors WebGPU: buffers, textures, shaders in plain WGSL, explicit bind
//! group layouts, pipelines. Work is recorded with a [`Recorder`] and handed to the frame (or, in `prepare`, to
//! [`Gpu::submit`]); the host checks and replays it.

mod options;
mod recorder;
mod resources;
mod service;

pub use options::{
    Binding, Blend, ColourTarget, ComputePipelineOptions, DepthTest, Layout, RenderPipelineOptions,
    TextureOptions, VertexBuffer,
};
pub use recorder::{ColourAttachment, ComputePass, DepthAttachment, Recorder, RenderPass};
pub use resources::{
    AsHandle, BindGroup, BindGroupLayout, Buffer, BufferRef, ComputePipeline, GroupRef,
    RenderPipeline, Sampler, Shader, Texture, TextureRef, TextureView, Ticket,
};
pub use service::Gpu;
