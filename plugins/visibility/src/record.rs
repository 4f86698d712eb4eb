//! The passes of a frame, recorded.

use crate::buffers::Large;
use crate::clips::{FootprintGroups, Variants};
use crate::draws::DrawList;
use crate::pipelines::{INDICES_PER_QUAD, Kernels, Prepared, QUADS_PER_INSTANCE};
use crate::request::Extent;
use crate::shading_inputs::BLOCK_STRIDE;
use crate::targets::{TargetSet, Targets};
use crate::view::VisibilityView;
use pointstage_plugin_api::abi::Handle;
use pointstage_plugin_api::gpu::{
    AsHandle, BindGroup, ColourAttachment, ComputePass, DepthAttachment, GroupRef, Recorder,
    RenderPass, RenderPipeline,
};
use pointstage_plugin_api::{Error, Result, Target};

/// Visibility by the raster pipeline; where the ids and the depths are. What has no target goes to the view's own textures.
pub(crate) fn record_raster(
    recorder: &mut Recorder,
    view: &VisibilityView,
    prepared: &Prepared,
    frame_group: GroupRef,
    list: &DrawList,
    [id, level, depth]: [Option<Target>; 3],
    pipelines: &Variants<RenderPipeline>,
) -> Result<[Handle; 2]> {
    let own = view.raster.as_ref().ok_or_else(missing)?;
    let (ids, id_attachment) = match id {
        Some(target) => (
            target.texture.as_handle(),
            ColourAttachment::load(&target.texture),
        ),
        None => (
            own.ids.as_handle(),
            ColourAttachment::clear(&own.ids, [0.0; 4]),
        ),
    };
    let (depths, depth_attachment) = match depth {
        Some(target) => (
            target.texture.as_handle(),
            DepthAttachment::load(&target.texture),
        ),
        None => (own.depth.as_handle(), DepthAttachment::clear(&own.depth)),
    };
    let mut colours = vec![Some(id_attachment)];
    if let Some(level) = level {
        colours.push(Some(ColourAttachment::load(&level.texture)));
    }

    let mut pass = recorder.render_pass("visibility", &colours, Some(depth_attachment));
    let groups = &view.footprint_groups;
    record_quads(&mut pass, prepared, frame_group, groups, pipelines, list);
    Ok([ids, depths])
}

/// A quad for each surfel of all draws: pipelines, groups 0 to 2, and the index buffer.
pub fn record_quads(
    pass: &mut RenderPass<'_>,
    prepared: &Prepared,
    frame_group: GroupRef,
    footprint_groups: &FootprintGroups,
    pipelines: &Variants<RenderPipeline>,
    list: &DrawList,
) {
    pass.set_index_buffer(&prepared.quads);
    let mut last = None;
    for draw in &list.draws {
        if last.replace(draw.clip) != Some(draw.clip) {
            pass.set_pipeline(pipelines.of_draw(draw));
            pass.set_bind_group(2, footprint_groups.of_draw(draw), &[]);
        }
        pass.set_bind_group(0, &frame_group, &[draw.uniform_offset]);
        pass.set_bind_group(1, &draw.columns, &[]);
        let whole = draw.count / QUADS_PER_INSTANCE;
        let rest = draw.count % QUADS_PER_INSTANCE;
        if whole > 0 {
            pass.draw_indexed(0..INDICES_PER_QUAD * QUADS_PER_INSTANCE, 0, 0..whole);
        }
        if rest > 0 {
            pass.draw_indexed(0..INDICES_PER_QUAD * rest, 0, whole..whole + 1);
        }
    }
}

/// Visibility by compute kernels, each over all draws; the buffer with the pixels.
pub(crate) fn record_compute(
    recorder: &mut Recorder,
    view: &VisibilityView,
    frame_group: GroupRef,
    list: &DrawList,
    kernels: &[Variants<Kernels>],
    extent: Extent,
) -> Result<Handle> {
    let buffers = view.compute.as_ref().ok_or_else(missing)?;
    recorder.clear_buffer(&buffers.pixels);
    let groups = KernelGroups {
        frame: frame_group,
        footprint: &view.footprint_groups,
        pixels: &buffers.group,
        large: (extent == Extent::Any).then_some(&buffers.large),
    };
    for kernel in kernels {
        record_kernels(recorder, "visibility", kernel, list, &groups);
    }
    Ok(buffers.pixels.as_handle())
}

/// What kernels are bound to.
#[derive(Clone, Copy)]
pub struct KernelGroups<'a> {
    /// Group 0.
    pub frame: GroupRef,
    /// Group 2.
    pub footprint: &'a FootprintGroups,
    /// Group 3.
    pub pixels: &'a BindGroup,
    /// Of large surfels; none if no surfel is large.
    pub large: Option<&'a Large>,
}

/// Kernels over all draws, one after the other.
pub fn record_kernels(
    recorder: &mut Recorder,
    label: &str,
    kernels: &Variants<Kernels>,
    list: &DrawList,
    groups: &KernelGroups<'_>,
) {
    for draw in &list.draws {
        let kernels = kernels.of_draw(draw);
        if let Some(large) = groups.large {
            large.clear(recorder);
        }
        let bind = |pass: &mut ComputePass<'_>| {
            pass.set_bind_group(0, &groups.frame, &[draw.uniform_offset]);
            pass.set_bind_group(1, &draw.columns, &[]);
            pass.set_bind_group(2, groups.footprint.of_draw(draw), &[]);
            pass.set_bind_group(3, groups.pixels, &[]);
        };
        let mut pass = recorder.compute_pass(label);
        pass.set_pipeline(&kernels.each);
        bind(&mut pass);
        pass.dispatch_linear(draw.count, kernels.group_size);
        drop(pass);
        let Some(large) = groups.large else {
            continue;
        };
        let arguments = large.dispatch_arguments(recorder);
        let mut pass = recorder.compute_pass(&format!("{label}, large"));
        pass.set_pipeline(&kernels.large);
        bind(&mut pass);
        pass.dispatch_indirect(arguments, 0);
    }
}

/// Shading: each block lights its own pixels.
pub(crate) fn record_shading(
    recorder: &mut Recorder,
    visible: &BindGroup,
    frame_group: GroupRef,
    list: &DrawList,
    targets: &Targets,
    set: TargetSet,
    pipeline: &RenderPipeline,
) {
    let mut pass = targets.shading_pass(set, recorder);
    pass.set_pipeline(pipeline);
    for (block, offset) in list.blocks.iter().zip((0..).step_by(BLOCK_STRIDE as usize)) {
        if block.pixels.size.contains(&0) {
            continue;
        }
        pass.set_bind_group(0, &frame_group, &[block.uniform_offset]);
        pass.set_bind_group(1, &block.columns, &[]);
        pass.set_bind_group(2, visible, &[offset]);
        pass.set_scissor(block.pixels.origin, block.pixels.size);
        pass.draw(0..3, 0..1);
    }
}

/// The view readies its buffers before it records; not reached.
pub(crate) fn missing() -> Error {
    Error::failed("the view's buffers were not made before recording")
}
