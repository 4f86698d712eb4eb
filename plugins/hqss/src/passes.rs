//! What all views share: layouts and pipelines, each made when it is first needed.

use crate::settings::SplatUniform;
use pointstage_plugin_api::abi::{BlendFactor, BlendOperation, Compare, Format, ShaderStages};
use pointstage_plugin_api::gpu::{
    BindGroupLayout, Binding, Blend, ColourTarget, DepthTest, Gpu, RenderPipeline,
    RenderPipelineOptions, Shader,
};
use pointstage_plugin_api::wgsl::{Module, WgslError, link};
use pointstage_plugin_api::{Error, Result, Scene};
use pointstage_visibility::{
    Cache, Footprint, Kernels, Prepared, SUMS, TargetSet, Varying, adds_int64, cached,
};

/// The splat's footprint, `shaders/hqss/splat.wesl`.
pub(crate) const SPLAT: Footprint = Footprint {
    name: "hqss",
    source: include_str!("../../../shaders/hqss/splat.wesl"),
    varying: Varying::Both,
    uniform_size: size_of::<SplatUniform>() as u64,
};

pub(crate) const ATTRIBUTES: Module<'static> = Module::new(
    "hqss::attributes",
    include_str!("../../../shaders/hqss/attributes.wesl"),
);
pub(crate) const ATTRIBUTES_PASS: Module<'static> = Module::new(
    "hqss::attributes_pass",
    include_str!("../../../shaders/hqss/attributes_pass.wesl"),
);
pub(crate) const ATTRIBUTES_COMPUTE: Module<'static> = Module::new(
    "hqss::attributes_compute",
    include_str!("../../../shaders/hqss/attributes_compute.wesl"),
);
const SHADING: Module<'static> = Module::new(
    "hqss::blended_shading",
    include_str!("../../../shaders/hqss/blended_shading.wesl"),
);

/// Weights and normals add, the greatest coverage stays.
const NORMAL_SUMS: Blend = Blend {
    colour: Blend::ADD.colour,
    alpha: Blend::both(BlendFactor::ONE, BlendFactor::ONE, BlendOperation::MAX).alpha,
};

/// Where the shading pass finds what splats gave each pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Sums {
    /// The raster path's textures.
    Textures,
    /// The compute path's buffers.
    Buffers,
    /// The same buffers, with what the CPU has made of the sums.
    Resolved,
}

impl Sums {
    /// Features of the shading shader.
    fn features(self) -> &'static [&'static str] {
        match self {
            Self::Textures => &[],
            Self::Buffers => &["pixels"],
            Self::Resolved => &["pixels", "resolved"],
        }
    }
}

/// The pipelines.
pub(crate) struct Passes {
    pub(crate) visibility: Prepared,
    /// Group 3 of the attribute kernels.
    pub(crate) sums_layout: BindGroupLayout,
    /// Group 3 of shading after the raster path.
    pub(crate) textures_layout: BindGroupLayout,
    /// Group 3 of shading after the compute path.
    pub(crate) buffers_layout: BindGroupLayout,
    raster: Cache<(Vec<&'static str>, u32), RenderPipeline>,
    compute: Cache<Vec<&'static str>, Kernels>,
    shading: Cache<(Sums, TargetSet, Vec<&'static str>), RenderPipeline>,
}

impl Passes {
    /// # Errors
    /// If the device refuses a resource.
    pub(crate) fn new(gpu: &Gpu, scene: Scene<'_>) -> Result<Self> {
        let compute = ShaderStages::COMPUTE;
        let fragment = ShaderStages::FRAGMENT;
        Ok(Self {
            visibility: Prepared::new(gpu, SPLAT)?.clipped_by(scene)?,
            sums_layout: gpu.bind_group_layout(
                "pixels, large surfels and sums",
                &[
                    (0, compute, Binding::StorageRead),
                    (1, compute, Binding::Storage),
                    (2, compute, Binding::Storage),
                    (3, compute, Binding::Storage),
                ],
            )?,
            textures_layout: gpu.bind_group_layout(
                "sums in textures",
                &[
                    (0, fragment, Binding::UniformDynamic),
                    (1, fragment, Binding::TextureUint),
                    (2, fragment, Binding::TextureDepth),
                    (3, fragment, Binding::TextureUnfilterable),
                    (4, fragment, Binding::TextureUnfilterable),
                ],
            )?,
            buffers_layout: gpu.bind_group_layout(
                "sums in buffers",
                &[
                    (0, fragment, Binding::UniformDynamic),
                    (1, fragment, Binding::StorageRead),
                    (2, fragment, Binding::StorageRead),
                    (3, fragment, Binding::StorageRead),
                ],
            )?,
            raster: Cache::default(),
            compute: Cache::default(),
            shading: Cache::default(),
        })
    }

    /// The attribute pass of the raster path, into sums of this format.
    pub(crate) fn raster(
        &self,
        features: &[&'static str],
        format: Format,
    ) -> Result<RenderPipeline> {
        cached(&self.raster, (features.to_vec(), format.0), || {
            let wgsl = link_raster(features).map_err(Error::failed)?;
            let shader = self.shader("attribute pass", &wgsl)?;
            let target = |blend| {
                Some(ColourTarget {
                    format,
                    blend: Some(blend),
                })
            };
            self.visibility.gpu.render_pipeline(&RenderPipelineOptions {
                layouts: &[
                    &self.visibility.frame_layout,
                    &self.visibility.columns_layout,
                    self.visibility.footprint_layout_for(features),
                ],
                vertex: "attributes_pass_vertex",
                fragment: Some("attributes_pass_fragment"),
                depth: Some(DepthTest {
                    writes: false,
                    compare: Compare::GREATER_EQUAL,
                    ..DepthTest::NEARER
                }),
                targets: &[target(Blend::ADD), target(NORMAL_SUMS)],
                ..RenderPipelineOptions::new("attribute pass", &shader)
            })
        })
    }

    /// The attribute pass of the compute path.
    pub(crate) fn compute(&self, features: &[&'static str]) -> Result<Kernels> {
        cached(&self.compute, features.to_vec(), || {
            let adds = adds_int64(&self.visibility.gpu).then_some("int64_add");
            let wide = self.visibility.is_wide().then_some("wide");
            let features: Vec<_> = features.iter().copied().chain(adds).chain(wide).collect();
            let wgsl = link_compute(&features).map_err(Error::failed)?;
            let shader = self.shader("attribute kernels", &wgsl)?;
            let names = ["attributes_compute", "attributes_compute_large"];
            self.visibility
                .kernels(&shader, &features, &self.sums_layout, names)
        })
    }

    /// The shading pass for a set of targets.
    pub(crate) fn shading(
        &self,
        sums: Sums,
        set: TargetSet,
        features: &[&'static str],
    ) -> Result<RenderPipeline> {
        cached(&self.shading, (sums, set, features.to_vec()), || {
            let wgsl = link_shading(sums, set, features).map_err(Error::failed)?;
            let shader = self.shader("shading pass", &wgsl)?;
            let layout = match sums {
                Sums::Textures => &self.textures_layout,
                Sums::Buffers | Sums::Resolved => &self.buffers_layout,
            };
            self.visibility.gpu.render_pipeline(&RenderPipelineOptions {
                layouts: &[
                    &self.visibility.frame_layout,
                    &self.visibility.columns_layout,
                    &self.visibility.footprint_layout,
                    layout,
                ],
                vertex: "blended_shading_vertex",
                fragment: Some("blended_shading_fragment"),
                depth: set.depth_test(),
                targets: &set.colour_targets(),
                ..RenderPipelineOptions::new("shading pass", &shader)
            })
        })
    }

    fn shader(&self, label: &str, wgsl: &str) -> Result<Shader> {
        self.visibility.gpu.shader(label, wgsl)
    }
}

fn splat() -> Module<'static> {
    Module::new("footprint::shape", SPLAT.source)
}

pub(crate) fn link_raster(features: &[&str]) -> core::result::Result<String, WgslError> {
    link(ATTRIBUTES_PASS, &[splat(), ATTRIBUTES], features)
}

pub(crate) fn link_compute(features: &[&str]) -> core::result::Result<String, WgslError> {
    link(ATTRIBUTES_COMPUTE, &[splat(), ATTRIBUTES, SUMS], features)
}

pub(crate) fn link_shading(
    sums: Sums,
    set: TargetSet,
    features: &[&str],
) -> core::result::Result<String, WgslError> {
    let slots = set.slots_module();
    let features = [features, &set.features(), sums.features()].concat();
    let slots = Module::new("visibility::slots", &slots);
    link(SHADING, &[splat(), ATTRIBUTES, slots], &features)
}
