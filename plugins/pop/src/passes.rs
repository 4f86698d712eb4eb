//! What all views share: layouts and pipelines, each made when it is first needed.

use crate::blending::BlendingPasses;
use crate::uniforms::STRIDE;
use pointstage_plugin_api::abi::{Compare, Format, ShaderStages};
use pointstage_plugin_api::gpu::{
    BindGroupLayout, Binding, ColourTarget, ComputePipeline, ComputePipelineOptions, DepthTest,
    Gpu, RenderPipeline, RenderPipelineOptions, Shader,
};
use pointstage_plugin_api::wgsl::{Module, WgslError, link};
use pointstage_plugin_api::{Error, Result};
use pointstage_visibility::{Cache, Source, TargetSet, cached, group_size, has_int64, is_wide};

pub(crate) const MODULES: [Module<'static>; 5] = [
    Module::new("pop::tree", include_str!("../../../shaders/pop/tree.wesl")),
    Module::new(
        "pop::splat",
        include_str!("../../../shaders/pop/splat.wesl"),
    ),
    Module::new(
        "pop::triangle",
        include_str!("../../../shaders/pop/triangle.wesl"),
    ),
    Module::new(
        "pop::surface",
        include_str!("../../../shaders/pop/surface.wesl"),
    ),
    Module::new(
        "pop::blending",
        include_str!("../../../shaders/pop/blending.wesl"),
    ),
];
pub(crate) const COMPUTE: Module<'static> = Module::new(
    "pop::primitives_compute",
    include_str!("../../../shaders/pop/primitives_compute.wesl"),
);
const JUDGE: Module<'static> = Module::new(
    "pop::judge",
    include_str!("../../../shaders/pop/judge.wesl"),
);
pub(crate) const SELECT_LEVEL: Module<'static> = Module::new(
    "pop::select_level",
    include_str!("../../../shaders/pop/select_level.wesl"),
);
const SELECT_DRAWS: Module<'static> = Module::new(
    "pop::select_draws",
    include_str!("../../../shaders/pop/select_draws.wesl"),
);
const RASTER: Module<'static> = Module::new(
    "pop::primitives_pass",
    include_str!("../../../shaders/pop/primitives_pass.wesl"),
);
const SHADING: Module<'static> = Module::new(
    "pop::primitive_shading",
    include_str!("../../../shaders/pop/primitive_shading.wesl"),
);

/// The compute path's kernels, in the order that they run in over all trees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kernel {
    /// Depth and primitive at once, by 64-bit atomics.
    Whole,
    /// The greatest depth; the first of two passes.
    NearestDepth,
    /// The greatest primitive at the greatest depth; the second of two passes.
    GreatestPrimitive,
}

/// Feature of the shading pass where splats are blended.
pub(crate) const BLENDED: &str = "blended";

/// What a draw draws: the features of the shaders.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    /// Nodes of a list.
    Splats,
    /// Triangles of a list.
    Triangles,
    /// All triangles of the mesh.
    AllTriangles,
    /// All vertices of the mesh.
    Points,
}

/// The kernel for all primitives, and for triangles the one for those of many pixels.
#[derive(Clone)]
pub(crate) struct Kernels {
    pub(crate) each: ComputePipeline,
    pub(crate) large: Option<ComputePipeline>,
}

/// The pipelines.
pub(crate) struct Passes {
    pub(crate) gpu: Gpu,
    /// Group 0.
    pub(crate) frame_layout: BindGroupLayout,
    /// Group 1: nodes, triangles, positions, normals, colours.
    pub(crate) tree_layout: BindGroupLayout,
    /// Group 2: a tree's uniform, the list.
    pub(crate) list_layout: BindGroupLayout,
    /// Group 3 of the compute path: pixels, large triangles.
    pub(crate) pixels_layout: BindGroupLayout,
    /// Group 3 of shading, by [`Source`].
    pub(crate) visible_layout: BindGroupLayout,
    pub(crate) textures_layout: BindGroupLayout,
    /// Group 2 of the selection: a tree's uniform alone.
    pub(crate) uniform_layout: BindGroupLayout,
    /// Group 3 of the selection: view, counts, queue, list, level.
    pub(crate) select_layout: BindGroupLayout,
    /// Group 0 of the selection's end: list, arguments.
    pub(crate) draws_layout: BindGroupLayout,
    pub(crate) blending: BlendingPasses,
    select: Cache<(), [ComputePipeline; 2]>,
    compute: Cache<(Kind, bool, Kernel), Kernels>,
    raster: Cache<(Kind, bool), RenderPipeline>,
    shading: Cache<(Source, TargetSet, Vec<&'static str>), RenderPipeline>,
}

impl Kind {
    /// Features of the shaders.
    pub(crate) fn features(self, is_disk: bool) -> Vec<&'static str> {
        let mut features = match self {
            Self::Splats => vec!["splats"],
            Self::Triangles => vec!["triangles"],
            Self::AllTriangles => vec!["triangles", "whole"],
            Self::Points => vec!["points"],
        };
        let is_round = is_disk && !self.is_triangles();
        features.extend(is_round.then_some("disk"));
        features
    }

    /// Whether triangles are drawn.
    pub(crate) fn is_triangles(self) -> bool {
        matches!(self, Self::Triangles | Self::AllTriangles)
    }
}

impl Passes {
    /// # Errors
    /// If the device refuses a resource.
    pub(crate) fn new(gpu: &Gpu) -> Result<Self> {
        let any = ShaderStages::VERTEX | ShaderStages::FRAGMENT | ShaderStages::COMPUTE;
        let compute = ShaderStages::COMPUTE;
        let fragment = ShaderStages::FRAGMENT;
        let read = Binding::StorageRead;
        let layout = |label, entries: &[_]| gpu.bind_group_layout(label, entries);
        Ok(Self {
            frame_layout: gpu.frame_layout()?,
            tree_layout: layout(
                "tree and mesh",
                &[
                    (0, any, read),
                    (1, any, read),
                    (2, any, read),
                    (3, any, read),
                    (4, any, read),
                ],
            )?,
            list_layout: layout("list", &[(0, any, Binding::UniformDynamic), (1, any, read)])?,
            pixels_layout: layout(
                "pixels and large triangles",
                &[
                    (0, compute, Binding::Storage),
                    (1, compute, Binding::Storage),
                ],
            )?,
            visible_layout: layout("visible pixels", &[(0, fragment, read)])?,
            textures_layout: layout(
                "visible primitives",
                &[
                    (0, fragment, Binding::TextureUint),
                    (1, fragment, Binding::TextureDepth),
                ],
            )?,
            uniform_layout: layout("tree", &[(0, compute, Binding::UniformDynamic)])?,
            select_layout: layout(
                "selection",
                &[
                    (0, compute, Binding::Uniform),
                    (1, compute, Binding::Storage),
                    (2, compute, Binding::Storage),
                    (3, compute, Binding::Storage),
                    (4, compute, Binding::UniformDynamic),
                ],
            )?,
            draws_layout: layout(
                "draws",
                &[(0, compute, read), (1, compute, Binding::Storage)],
            )?,
            blending: BlendingPasses::new(gpu)?,
            gpu: gpu.clone(),
            select: Cache::default(),
            compute: Cache::default(),
            raster: Cache::default(),
            shading: Cache::default(),
        })
    }

    /// Kernels that run one after the other.
    pub(crate) fn kernel_order(&self) -> &'static [Kernel] {
        if has_int64(&self.gpu) {
            &[Kernel::Whole]
        } else {
            &[Kernel::NearestDepth, Kernel::GreatestPrimitive]
        }
    }

    /// Kernels of the compute path.
    pub(crate) fn compute(&self, kind: Kind, is_disk: bool, kernel: Kernel) -> Result<Kernels> {
        cached(&self.compute, (kind, is_disk, kernel), || {
            let wgsl =
                link_compute(kind, is_disk, kernel, is_wide(&self.gpu)).map_err(Error::failed)?;
            let shader = self.gpu.shader("primitives, compute", &wgsl)?;
            let pipeline = |entry_point| {
                self.gpu.compute_pipeline(&ComputePipelineOptions {
                    label: entry_point,
                    layouts: &[
                        &self.frame_layout,
                        &self.tree_layout,
                        &self.list_layout,
                        &self.pixels_layout,
                    ],
                    immediate_size: 0,
                    shader: &shader,
                    entry_point,
                    constants: &[],
                })
            };
            let large = kind
                .is_triangles()
                .then(|| pipeline("primitives_compute_large"));
            Ok(Kernels {
                each: pipeline("primitives_compute")?,
                large: large.transpose()?,
            })
        })
    }

    /// The kernels of the selection: of a level, and of the arguments of the draws.
    pub(crate) fn select(&self) -> Result<[ComputePipeline; 2]> {
        cached(&self.select, (), || {
            let link = |(module, wide)| link_select(module, wide).map_err(Error::failed);
            let level = self
                .gpu
                .shader("selection", &link((SELECT_LEVEL, is_wide(&self.gpu)))?)?;
            let draws = self
                .gpu
                .shader("draws of the selection", &link((SELECT_DRAWS, false))?)?;
            let pipeline = |shader: &Shader, entry_point, layouts: &[_], constants: &[_]| {
                self.gpu.compute_pipeline(&ComputePipelineOptions {
                    label: entry_point,
                    layouts,
                    immediate_size: 0,
                    shader,
                    entry_point,
                    constants,
                })
            };
            let layouts = [
                &self.frame_layout,
                &self.tree_layout,
                &self.uniform_layout,
                &self.select_layout,
            ];
            let constants = [("GROUP_SIZE", f64::from(group_size(&self.gpu)))];
            Ok([
                pipeline(&level, "select_level", &layouts, &[])?,
                pipeline(&draws, "select_draws", &[&self.draws_layout], &constants)?,
            ])
        })
    }

    /// The raster path's pipeline.
    pub(crate) fn raster(&self, kind: Kind, is_disk: bool) -> Result<RenderPipeline> {
        cached(&self.raster, (kind, is_disk), || {
            let wgsl = link_raster(kind, is_disk).map_err(Error::failed)?;
            let shader = self.gpu.shader("primitives, raster", &wgsl)?;
            self.gpu.render_pipeline(&RenderPipelineOptions {
                layouts: &[&self.frame_layout, &self.tree_layout, &self.list_layout],
                vertex: "primitives_pass_vertex",
                fragment: Some("primitives_pass_fragment"),
                depth: Some(DepthTest {
                    compare: Compare::GREATER_EQUAL,
                    ..DepthTest::NEARER
                }),
                targets: &[Some(ColourTarget {
                    format: Format::R32_UINT,
                    blend: None,
                })],
                ..RenderPipelineOptions::new("primitives", &shader)
            })
        })
    }

    /// The shading pipeline for a set of targets.
    pub(crate) fn shading(
        &self,
        source: Source,
        set: TargetSet,
        look: &[&'static str],
    ) -> Result<RenderPipeline> {
        cached(&self.shading, (source, set, look.to_vec()), || {
            let wgsl = link_shading(source, set, look).map_err(Error::failed)?;
            let shader: Shader = self.gpu.shader("primitive shading", &wgsl)?;
            let visible = match (source, look.contains(&BLENDED)) {
                (Source::Ids, false) => &self.textures_layout,
                (Source::Ids, true) => &self.blending.textures_layout,
                (Source::Pixels, false) => &self.visible_layout,
                (Source::Pixels, true) => &self.blending.buffers_layout,
            };
            self.gpu.render_pipeline(&RenderPipelineOptions {
                layouts: &[
                    &self.frame_layout,
                    &self.tree_layout,
                    &self.list_layout,
                    visible,
                ],
                vertex: "primitive_shading_vertex",
                fragment: Some("primitive_shading_fragment"),
                depth: set.depth_test(),
                targets: &set.colour_targets(),
                ..RenderPipelineOptions::new("primitive shading", &shader)
            })
        })
    }
}

/// The visibility kernels' WGSL.
pub(crate) fn link_compute(
    kind: Kind,
    is_disk: bool,
    kernel: Kernel,
    is_wide: bool,
) -> Result<String, WgslError> {
    let mut features = kind.features(is_disk);
    features.extend(match kernel {
        Kernel::Whole => Some("int64"),
        Kernel::NearestDepth => Some("nearest_depth"),
        Kernel::GreatestPrimitive => None,
    });
    features.extend(is_wide.then_some("wide"));
    link(COMPUTE, &MODULES, &features)
}

/// The selection's WGSL.
fn link_select(module: Module<'static>, is_wide: bool) -> Result<String, WgslError> {
    let [tree, ..] = MODULES;
    let wide: &[&str] = if is_wide { &["wide"] } else { &[] };
    link(module, &[tree, JUDGE], wide)
}

/// All WGSL of the selection, for tests.
#[cfg(test)]
pub(crate) fn linked_selection() -> Result<[String; 3], WgslError> {
    Ok([
        link_select(SELECT_LEVEL, false)?,
        link_select(SELECT_LEVEL, true)?,
        link_select(SELECT_DRAWS, false)?,
    ])
}

/// The visibility pass's WGSL.
pub(crate) fn link_raster(kind: Kind, is_disk: bool) -> Result<String, WgslError> {
    link(RASTER, &MODULES, &kind.features(is_disk))
}

/// The shading pass's WGSL.
pub(crate) fn link_shading(
    source: Source,
    set: TargetSet,
    look: &[&'static str],
) -> Result<String, WgslError> {
    let slots = set.slots_module();
    let mut features = [&set.features(), look].concat();
    features.extend((source == Source::Pixels).then_some("pixels"));
    let modules = [&MODULES[..], &[Module::new("visibility::slots", &slots)]].concat();
    link(SHADING, &modules, &features)
}

/// Bytes of a uniform that a draw sees.
pub(crate) const UNIFORM_BYTES: u64 = STRIDE as u64;
