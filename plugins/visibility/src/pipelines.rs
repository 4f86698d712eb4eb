//! What all views of a renderer share: layouts, the quads' index buffer, and pipelines, each made when it is first needed.

use crate::clips::Clips;
use crate::footprint::{Footprint, Varying};
use crate::targets::TargetSet;
use pointstage_plugin_api::abi::{BufferUsage, Compare, Format, ShaderStages};
use pointstage_plugin_api::gpu::{
    BindGroupLayout, Binding, Buffer, ColourTarget, ComputePipeline, ComputePipelineOptions,
    DepthTest, Gpu, RenderPipeline, RenderPipelineOptions, Shader,
};
use pointstage_plugin_api::wgsl::{Module, WgslError, link};
use pointstage_plugin_api::{Error, Result};
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// Quads of the index buffer; `QUADS_PER_INSTANCE` in the shader.
pub const QUADS_PER_INSTANCE: u32 = 65_536;
/// Invocations of a workgroup.
const GROUP: u32 = 256;
/// The same where one thread runs a workgroup: fewer of them start.
const WIDE_GROUP: u32 = 1024;
/// Indices of a quad: two triangles.
pub(crate) const INDICES_PER_QUAD: u32 = 6;

const VISIBILITY_PASS: Module<'static> = Module::new(
    "visibility::visibility_pass",
    include_str!("../../../shaders/visibility/visibility_pass.wesl"),
);
const VISIBILITY_COMPUTE: Module<'static> = Module::new(
    "visibility::visibility_compute",
    include_str!("../../../shaders/visibility/visibility_compute.wesl"),
);
const SHADING_PASS: Module<'static> = Module::new(
    "visibility::shading_pass",
    include_str!("../../../shaders/visibility/shading_pass.wesl"),
);

/// Sums of blended splats, as whole numbers: the module `visibility::sums`. With the feature `int64_add` where [`adds_int64`].
pub const SUMS: Module<'static> = Module::new(
    "visibility::sums",
    include_str!("../../../shaders/visibility/sums.wesl"),
);

/// Which of the compute kernels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kernel {
    /// Depth and id at once, by 64-bit atomics.
    Whole,
    /// The greatest depth; the first of two passes.
    NearestDepth,
    /// The greatest id at the greatest depth; the second of two passes.
    GreatestId,
}

/// The kernel for all surfels, and the one for those of many pixels.
#[derive(Clone)]
pub struct Kernels {
    /// For all surfels of a draw.
    pub each: ComputePipeline,
    /// Invocations of a workgroup of `each`.
    pub group_size: u32,
    /// For those of many pixels, a workgroup each.
    pub large: ComputePipeline,
}

/// Where the shading pass finds what is visible.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Source {
    /// The raster path's id texture.
    Ids,
    /// The compute path's buffer.
    Pixels,
}

/// Things that are made on first use, by key.
pub type Cache<K, V> = Mutex<BTreeMap<K, V>>;

/// A renderer, prepared: shared by its views. Nothing in it but clip lines depends on the scene.
pub struct Prepared {
    /// The device.
    pub gpu: Gpu,
    pub(crate) footprint: Footprint,
    pub(crate) quads: Buffer,
    /// Group 2 of visibility: the footprint's uniform.
    pub footprint_layout: BindGroupLayout,
    /// The same with clip lines.
    pub clipped_layout: BindGroupLayout,
    /// Clip lines of the scene, if the renderer's footprint clips.
    pub clips: Clips,
    /// Group 3 of the compute path: pixels, large surfels.
    pub(crate) pixels_layout: BindGroupLayout,
    /// Group 2 of shading, by [`Source`]: what is visible, and the block.
    pub(crate) ids_layout: BindGroupLayout,
    pub(crate) visible_layout: BindGroupLayout,
    /// Group 0 of all passes.
    pub frame_layout: BindGroupLayout,
    /// Group 1 of all passes.
    pub columns_layout: BindGroupLayout,
    raster: Cache<(Vec<&'static str>, bool), RenderPipeline>,
    compute: Cache<(Vec<&'static str>, Kernel), Kernels>,
    shading: Cache<(Source, TargetSet), RenderPipeline>,
}

impl Prepared {
    /// Makes what the views of a renderer with this footprint share.
    ///
    /// # Errors
    /// If the device refuses a resource.
    pub fn new(gpu: &Gpu, footprint: Footprint) -> Result<Self> {
        let any = ShaderStages::VERTEX | ShaderStages::FRAGMENT | ShaderStages::COMPUTE;
        let fragment = ShaderStages::FRAGMENT;
        let layout = |label, entries: &[_]| gpu.bind_group_layout(label, entries);
        Ok(Self {
            quads: quads(gpu)?,
            footprint_layout: layout("footprint", &[(0, any, Binding::Uniform)])?,
            clipped_layout: layout(
                "footprint and clip lines",
                &[
                    (0, any, Binding::Uniform),
                    (
                        1,
                        ShaderStages::VERTEX | ShaderStages::COMPUTE,
                        Binding::StorageRead,
                    ),
                ],
            )?,
            clips: Clips::default(),
            pixels_layout: layout(
                "pixels and large surfels",
                &[
                    (0, ShaderStages::COMPUTE, Binding::Storage),
                    (1, ShaderStages::COMPUTE, Binding::Storage),
                ],
            )?,
            ids_layout: layout(
                "visible ids",
                &[
                    (0, fragment, Binding::TextureUint),
                    (1, fragment, Binding::UniformDynamic),
                ],
            )?,
            visible_layout: layout(
                "visible pixels",
                &[
                    (0, fragment, Binding::StorageRead),
                    (1, fragment, Binding::UniformDynamic),
                ],
            )?,
            frame_layout: gpu.frame_layout()?,
            columns_layout: gpu.columns_layout()?,
            gpu: gpu.clone(),
            footprint,
            raster: Mutex::default(),
            compute: Mutex::default(),
            shading: Mutex::default(),
        })
    }

    /// The raster path's visibility pipeline, with or without a level target.
    pub(crate) fn raster(&self, features: &[&'static str], level: bool) -> Result<RenderPipeline> {
        cached(&self.raster, (features.to_vec(), level), || {
            let shader = self.shader(
                VISIBILITY_PASS,
                &raster_features(&self.footprint, features, level),
            )?;
            let target = |format| {
                Some(ColourTarget {
                    format,
                    blend: None,
                })
            };
            let targets = [target(Format::R32_UINT), target(Format::R8_UINT)];
            self.gpu.render_pipeline(&RenderPipelineOptions {
                layouts: &[
                    &self.frame_layout,
                    &self.columns_layout,
                    self.footprint_layout_for(features),
                ],
                vertex: "visibility_pass_vertex",
                fragment: Some("visibility_pass_fragment"),
                // Of equal depths the last drawn stays, which is the greatest id, as on the compute path.
                depth: Some(DepthTest {
                    compare: Compare::GREATER_EQUAL,
                    ..DepthTest::NEARER
                }),
                targets: if level { &targets } else { &targets[..1] },
                ..RenderPipelineOptions::new("visibility pass", &shader)
            })
        })
    }

    /// The compute path's kernels.
    pub(crate) fn compute(&self, features: &[&'static str], kernel: Kernel) -> Result<Kernels> {
        cached(&self.compute, (features.to_vec(), kernel), || {
            let mut features = compute_features(features, kernel);
            features.extend(self.is_wide().then_some("wide"));
            let pairs = self.gpu.is_software() && kernel == Kernel::Whole;
            features.extend(pairs.then_some("pairs"));
            let shader = self.shader(VISIBILITY_COMPUTE, &features)?;
            let names = ["visibility_compute", "visibility_compute_large"];
            self.kernels(&shader, &features, &self.pixels_layout, names)
        })
    }

    /// Kernels of a shader: for all surfels, and for those of many pixels.
    ///
    /// * `features`: of the shader.
    /// * `pixels_layout`: of group 3.
    ///
    /// # Errors
    /// If the device refuses one.
    pub fn kernels(
        &self,
        shader: &Shader,
        features: &[&'static str],
        pixels_layout: &BindGroupLayout,
        [each, large]: [&str; 2],
    ) -> Result<Kernels> {
        let pipeline = |entry_point| {
            self.gpu.compute_pipeline(&ComputePipelineOptions {
                label: entry_point,
                layouts: &[
                    &self.frame_layout,
                    &self.columns_layout,
                    self.footprint_layout_for(features),
                    pixels_layout,
                ],
                immediate_size: 0,
                shader,
                entry_point,
                constants: &[],
            })
        };
        Ok(Kernels {
            each: pipeline(each)?,
            group_size: group_size(&self.gpu),
            large: pipeline(large)?,
        })
    }

    /// Whether the compute kernels have large workgroups: the feature `wide` of their shaders.
    pub fn is_wide(&self) -> bool {
        is_wide(&self.gpu)
    }

    /// The shading pipeline for a set of targets.
    pub(crate) fn shading(&self, source: Source, set: TargetSet) -> Result<RenderPipeline> {
        cached(&self.shading, (source, set), || {
            let wgsl = link_shading(source, set).map_err(Error::failed)?;
            let shader = self.gpu.shader("shading pass", &wgsl)?;
            let visible = match source {
                Source::Ids => &self.ids_layout,
                Source::Pixels => &self.visible_layout,
            };
            self.gpu.render_pipeline(&RenderPipelineOptions {
                layouts: &[&self.frame_layout, &self.columns_layout, visible],
                vertex: "shading_pass_vertex",
                fragment: Some("shading_pass_fragment"),
                depth: set.depth_test(),
                targets: &set.colour_targets(),
                ..RenderPipelineOptions::new("shading pass", &shader)
            })
        })
    }

    fn shader(&self, main: Module<'_>, features: &[&str]) -> Result<Shader> {
        let wgsl = link(main, &[self.footprint.module()], features).map_err(Error::failed)?;
        self.gpu.shader(main.path, &wgsl)
    }
}

/// Invocations of a workgroup of compute kernels; `GROUP_SIZE` in the shaders.
pub fn group_size(gpu: &Gpu) -> u32 {
    if is_wide(gpu) { WIDE_GROUP } else { GROUP }
}

/// Whether compute kernels have large workgroups: the feature `wide` of their shaders.
pub fn is_wide(gpu: &Gpu) -> bool {
    let limits = [
        "max_compute_invocations_per_workgroup",
        "max_compute_workgroup_size_x",
    ];
    let fits = |limit| gpu.limit(limit) >= Some(WIDE_GROUP.into());
    gpu.is_software() && limits.into_iter().all(fits)
}

/// Whether one 64-bit maximum can hold depth and id.
pub fn has_int64(gpu: &Gpu) -> bool {
    gpu.has_feature("shader-int64") && gpu.has_feature("shader-int64-atomic-min-max")
}

/// Whether the device adds 64 bits at once: the feature `int64_add` of shaders.
pub fn adds_int64(gpu: &Gpu) -> bool {
    gpu.has_feature("shader-int64-atomic-all-ops")
}

/// Whether the raster pipeline adds up in 32-bit floats.
pub fn blends_float32(gpu: &Gpu) -> bool {
    gpu.has_feature("float32-blendable")
}

fn raster_features<'a>(footprint: &Footprint, features: &[&'a str], level: bool) -> Vec<&'a str> {
    let varying = match footprint.varying {
        Varying::Flat => "flat",
        Varying::Linear => "linear",
        Varying::Both => "both",
    };
    features
        .iter()
        .copied()
        .chain([varying])
        .chain(level.then_some("level"))
        .collect()
}

fn compute_features<'a>(features: &[&'a str], kernel: Kernel) -> Vec<&'a str> {
    let variant = match kernel {
        Kernel::Whole => Some("int64"),
        Kernel::NearestDepth => Some("nearest_depth"),
        Kernel::GreatestId => None,
    };
    features.iter().copied().chain(variant).collect()
}

fn link_shading(source: Source, set: TargetSet) -> Result<String, WgslError> {
    let slots = set.slots_module();
    let mut features = set.features();
    if source == Source::Pixels {
        features.push("pixels");
    }
    link(
        SHADING_PASS,
        &[Module::new("visibility::slots", &slots)],
        &features,
    )
}

/// Every variant of the passes that draw a footprint with these features, linked: a name, and the WGSL. For tests: a
/// renderer validates them all without a device.
///
/// # Errors
/// If one of them does not link.
pub fn linked_variants(
    footprint: &Footprint,
    features: &[&str],
) -> Result<Vec<(String, String)>, WgslError> {
    let modules = [footprint.module()];
    let raster = [false, true].into_iter().map(|level| {
        let features = raster_features(footprint, features, level);
        let wgsl = link(VISIBILITY_PASS, &modules, &features)?;
        Ok((format!("{}, raster, {features:?}", footprint.name), wgsl))
    });
    let kernels = [Kernel::Whole, Kernel::NearestDepth, Kernel::GreatestId];
    let sizes: [&[&str]; 4] = [&[], &["small"], &["one_pixel"], &["wide", "pairs"]];
    let pairs = kernels
        .into_iter()
        .flat_map(|kernel| sizes.map(|size| (kernel, size)));
    let compute = pairs.map(|(kernel, size)| {
        let features = [&compute_features(features, kernel), size].concat();
        let wgsl = link(VISIBILITY_COMPUTE, &modules, &features)?;
        Ok((format!("{}, compute, {features:?}", footprint.name), wgsl))
    });
    raster.chain(compute).collect()
}

/// The value for a key, made on first use. A view that finds another making it waits: both need it.
///
/// # Errors
/// What `make` says.
pub fn cached<K: Ord + Clone, V: Clone>(
    cache: &Cache<K, V>,
    key: K,
    make: impl FnOnce() -> Result<V>,
) -> Result<V> {
    // A panic in `make` leaves the map as it was.
    let mut cache = cache.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(value) = cache.get(&key) {
        return Ok(value.clone());
    }
    let value = make()?;
    cache.insert(key, value.clone());
    Ok(value)
}

/// Indices of quads of four vertices: upper left, upper right, lower left, lower right.
fn quads(gpu: &Gpu) -> Result<Buffer> {
    let indices: Vec<u32> = (0..QUADS_PER_INSTANCE)
        .flat_map(|quad| [0, 1, 2, 2, 1, 3].map(|corner| 4 * quad + corner))
        .collect();
    gpu.buffer_with("quads", BufferUsage::INDEX, &indices)
}

#[cfg(test)]
#[path = "pipelines_tests.rs"]
mod tests;
