//! Blended splats: their attribute pass, and where it adds up, for pictures of a size.

use crate::passes::{Kind, MODULES, Passes};
use pointstage_plugin_api::abi::{self, BufferUsage, Compare, Format, ShaderStages};
use pointstage_plugin_api::gpu::{
    AsHandle as _, BindGroup, BindGroupLayout, Binding, Blend, Buffer, ColourTarget,
    ComputePipeline, ComputePipelineOptions, DepthTest, Gpu, RenderPipeline, RenderPipelineOptions,
    Texture,
};
use pointstage_plugin_api::wgsl::{Module, WgslError, link};
use pointstage_plugin_api::{Error, Result};
use pointstage_visibility::{
    Cache, SUMS, adds_int64, blends_float32, cached, is_wide, picture_texture,
};

const COMPUTE: Module<'static> = Module::new(
    "pop::blending_compute",
    include_str!("../../../shaders/pop/blending_compute.wesl"),
);
const RASTER: Module<'static> = Module::new(
    "pop::blending_pass",
    include_str!("../../../shaders/pop/blending_pass.wesl"),
);

/// Bytes of a pixel in each of the two sums.
pub(crate) const SUM_BYTES: u64 = 16;
/// Storage buffers that shading binds at once: tree and mesh, the list, triangles, splats and two sums.
const STORAGE_BUFFERS: u64 = 10;

/// Layouts and pipelines, each made when it is first needed.
pub(crate) struct BlendingPasses {
    /// Group 3 of the attribute kernel: splats of the pixels, sums.
    sums_layout: BindGroupLayout,
    /// Group 3 of shading: the same of triangles and of splats, and the sums.
    pub(crate) buffers_layout: BindGroupLayout,
    pub(crate) textures_layout: BindGroupLayout,
    compute: Cache<(Kind, bool), ComputePipeline>,
    raster: Cache<(Kind, bool), RenderPipeline>,
}

/// The compute path's buffers.
pub(crate) struct BlendedBuffers {
    /// Nearest splat and its depth.
    pub(crate) splats: Buffer,
    /// Sums of colours and of normals.
    pub(crate) sums: [Buffer; 2],
    /// Group 3 of the visibility kernels over splats.
    pub(crate) group: BindGroup,
    /// Group 3 of the attribute kernel.
    pub(crate) adding: BindGroup,
}

/// The raster path's textures.
pub(crate) struct BlendedTextures {
    /// Nearest splat, and its depth.
    pub(crate) splats: Texture,
    pub(crate) depth: Texture,
    /// Sums of colours and of normals.
    pub(crate) sums: [Texture; 2],
}

/// Whether the compute path can blend on the device.
pub(crate) fn binds_enough(gpu: &Gpu) -> bool {
    gpu.limit("max_storage_buffers_per_shader_stage") >= Some(STORAGE_BUFFERS)
}

/// Sums of the raster path. Half floats stand still at 2,048, which is more splats than meet in a pixel.
fn sums_format(gpu: &Gpu) -> Format {
    if blends_float32(gpu) {
        Format::RGBA32_FLOAT
    } else {
        Format::RGBA16_FLOAT
    }
}

impl BlendingPasses {
    /// # Errors
    /// If the device refuses a layout.
    pub(crate) fn new(gpu: &Gpu) -> Result<Self> {
        let compute = ShaderStages::COMPUTE;
        let fragment = ShaderStages::FRAGMENT;
        let read = Binding::StorageRead;
        Ok(Self {
            sums_layout: gpu.bind_group_layout(
                "splats and sums",
                &[
                    (0, compute, read),
                    (2, compute, Binding::Storage),
                    (3, compute, Binding::Storage),
                ],
            )?,
            buffers_layout: gpu.bind_group_layout(
                "visible pixels and sums",
                &[
                    (0, fragment, read),
                    (1, fragment, read),
                    (2, fragment, read),
                    (3, fragment, read),
                ],
            )?,
            textures_layout: gpu.bind_group_layout(
                "visible primitives and sums",
                &[
                    (0, fragment, Binding::TextureUint),
                    (1, fragment, Binding::TextureDepth),
                    (2, fragment, Binding::TextureUint),
                    (3, fragment, Binding::TextureDepth),
                    (4, fragment, Binding::TextureUnfilterable),
                    (5, fragment, Binding::TextureUnfilterable),
                ],
            )?,
            compute: Cache::default(),
            raster: Cache::default(),
        })
    }
}

impl Passes {
    /// The attribute kernel for splats of a kind.
    pub(crate) fn blending_compute(
        &self,
        kind: Kind,
        has_pop_colours: bool,
    ) -> Result<ComputePipeline> {
        cached(&self.blending.compute, (kind, has_pop_colours), || {
            let adds = adds_int64(&self.gpu);
            let wgsl = link_compute(kind, has_pop_colours, adds, is_wide(&self.gpu))
                .map_err(Error::failed)?;
            let shader = self.gpu.shader("blended splats, compute", &wgsl)?;
            self.gpu.compute_pipeline(&ComputePipelineOptions {
                label: "blended splats",
                layouts: &[
                    &self.frame_layout,
                    &self.tree_layout,
                    &self.list_layout,
                    &self.blending.sums_layout,
                ],
                immediate_size: 0,
                shader: &shader,
                entry_point: "blending_compute",
                constants: &[],
            })
        })
    }

    /// The attribute pass for splats of a kind.
    pub(crate) fn blending_raster(
        &self,
        kind: Kind,
        has_pop_colours: bool,
    ) -> Result<RenderPipeline> {
        cached(&self.blending.raster, (kind, has_pop_colours), || {
            let wgsl = link_raster(kind, has_pop_colours).map_err(Error::failed)?;
            let shader = self.gpu.shader("blended splats, raster", &wgsl)?;
            let target = Some(ColourTarget {
                format: sums_format(&self.gpu),
                blend: Some(Blend::ADD),
            });
            self.gpu.render_pipeline(&RenderPipelineOptions {
                layouts: &[&self.frame_layout, &self.tree_layout, &self.list_layout],
                vertex: "blending_pass_vertex",
                fragment: Some("blending_pass_fragment"),
                depth: Some(DepthTest {
                    writes: false,
                    compare: Compare::GREATER_EQUAL,
                    ..DepthTest::NEARER
                }),
                targets: &[target, target],
                ..RenderPipelineOptions::new("blended splats", &shader)
            })
        })
    }
}

impl BlendedBuffers {
    /// * `bytes`: of the nearest splats of a picture.
    /// * `large`: of the visibility kernels.
    ///
    /// # Errors
    /// If the device refuses one.
    pub(crate) fn new(
        passes: &Passes,
        size_px: [u32; 2],
        bytes: u64,
        large: &Buffer,
    ) -> Result<Self> {
        let gpu = &passes.gpu;
        let usage = BufferUsage::STORAGE | BufferUsage::COPY_DST;
        let sum_bytes = SUM_BYTES * u64::from(size_px[0]) * u64::from(size_px[1]);
        let splats = gpu.buffer("visible splats", bytes, usage)?;
        let colours = gpu.buffer("sums of colours", sum_bytes, usage)?;
        let normals = gpu.buffer("sums of normals", sum_bytes, usage)?;
        let group = gpu.bind_group(
            "visible splats",
            &passes.pixels_layout,
            &[(0, &splats), (1, large)],
        )?;
        let adding = gpu.bind_group(
            "splats and sums",
            &passes.blending.sums_layout,
            &[(0, &splats), (2, &colours), (3, &normals)],
        )?;
        Ok(Self {
            splats,
            sums: [colours, normals],
            group,
            adding,
        })
    }

    /// Group 3 of shading.
    ///
    /// * `triangles`: the nearest ones.
    ///
    /// # Errors
    /// If the device refuses it.
    pub(crate) fn shading(&self, passes: &Passes, triangles: &Buffer) -> Result<BindGroup> {
        let [colours, normals] = &self.sums;
        passes.gpu.bind_group(
            "visible pixels and sums",
            &passes.blending.buffers_layout,
            &[
                (0, triangles),
                (1, &self.splats),
                (2, colours),
                (3, normals),
            ],
        )
    }
}

impl BlendedTextures {
    /// # Errors
    /// If the device refuses one.
    pub(crate) fn new(gpu: &Gpu, size_px: [u32; 2]) -> Result<Self> {
        let texture = |label, format| picture_texture(gpu, label, size_px, format);
        Ok(Self {
            splats: texture("visible splats", Format::R32_UINT)?,
            depth: texture("depth of splats", Format::DEPTH32_FLOAT)?,
            sums: [
                texture("sums of colours", sums_format(gpu))?,
                texture("sums of normals", sums_format(gpu))?,
            ],
        })
    }

    /// Group 3 of shading.
    ///
    /// * `triangles`: the nearest ones, and their depth.
    ///
    /// # Errors
    /// If the device refuses it.
    pub(crate) fn shading(
        &self,
        passes: &Passes,
        [triangles, depth]: [&Texture; 2],
    ) -> Result<BindGroup> {
        let [colours, normals] = &self.sums;
        let all = [
            triangles,
            depth,
            &self.splats,
            &self.depth,
            colours,
            normals,
        ];
        let entries: Vec<_> = (0..)
            .zip(all)
            .map(|(binding, texture)| abi::BindingRecord {
                binding,
                resource: texture.as_handle(),
                ..Default::default()
            })
            .collect();
        passes.gpu.bind_group_from(&abi::BindGroupDescriptor {
            label: "visible primitives and sums".into(),
            layout: passes.blending.textures_layout.handle(),
            entries: entries.as_slice().into(),
        })
    }
}

fn features_of(kind: Kind, has_pop_colours: bool) -> Vec<&'static str> {
    let mut features = kind.features(false);
    features.extend(has_pop_colours.then_some("pop_colours"));
    features
}

/// The attribute kernel's WGSL.
pub(crate) fn link_compute(
    kind: Kind,
    has_pop_colours: bool,
    adds_64: bool,
    is_wide: bool,
) -> Result<String, WgslError> {
    let mut features = features_of(kind, has_pop_colours);
    features.extend(adds_64.then_some("int64_add"));
    features.extend(is_wide.then_some("wide"));
    link(COMPUTE, &[&MODULES[..], &[SUMS]].concat(), &features)
}

/// The attribute pass's WGSL.
pub(crate) fn link_raster(kind: Kind, has_pop_colours: bool) -> Result<String, WgslError> {
    link(RASTER, &MODULES, &features_of(kind, has_pop_colours))
}
