//! The passes of a frame, recorded.

use crate::draws::DrawList;
use crate::pipelines::{INDICES_PER_QUAD, Kernels, Prepared, QUADS_PER_INSTANCE};
use crate::request::Extent;
use crate::targets::{TargetSet, Targets};
use crate::view::{BLOCK_STRIDE, VisibilityView};
use pointstage_plugin_api::abi::Handle;
use pointstage_plugin_api::abi::commands::{ClearBuffer, CopyBufferToBuffer};
use pointstage_plugin_api::gpu::{
    AsHandle, BindGroup, ColourAttachment, DepthAttachment, GroupRef, Recorder, RenderPipeline,
};
use pointstage_plugin_api::{Error, Result};

/// Visibility by the raster pipeline; the texture with the ids.
pub(crate) fn record_raster(
    recorder: &mut Recorder,
    view: &VisibilityView,
    prepared: &Prepared,
    frame_group: GroupRef,
    list: &DrawList,
    targets: &Targets,
    pipeline: &RenderPipeline,
) -> Result<Handle> {
    let own = view.raster.as_ref().ok_or_else(missing)?;
    let (ids, id_attachment) = match targets.id() {
        Some(target) => (
            target.texture.as_handle(),
            ColourAttachment::load(&target.texture),
        ),
        None => (
            own.ids.as_handle(),
            ColourAttachment::clear(&own.ids, [0.0; 4]),
        ),
    };
    let depth_attachment = match targets.depth {
        Some(target) => DepthAttachment::load(&target.texture),
        None => DepthAttachment::clear(&own.depth),
    };
    let mut colours = vec![Some(id_attachment)];
    if let Some(level) = targets.level() {
        colours.push(Some(ColourAttachment::load(&level.texture)));
    }

    let mut pass = recorder.render_pass("visibility", &colours, Some(depth_attachment));
    pass.set_pipeline(pipeline);
    pass.set_index_buffer(&prepared.quads);
    pass.set_bind_group(2, &view.footprint_group, &[]);
    for draw in &list.draws {
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
    Ok(ids)
}

/// Visibility by compute kernels, each over all draws; the buffer with the pixels.
pub(crate) fn record_compute(
    recorder: &mut Recorder,
    view: &VisibilityView,
    frame_group: GroupRef,
    list: &DrawList,
    kernels: &[Kernels],
    extent: Extent,
) -> Result<Handle> {
    let buffers = view.compute.as_ref().ok_or_else(missing)?;
    recorder.clear_buffer(&buffers.pixels);
    for kernel in kernels {
        for draw in &list.draws {
            let has_large = extent == Extent::Any;
            if has_large {
                recorder.push(ClearBuffer {
                    buffer: buffers.large.as_handle(),
                    offset: 0,
                    size: 4,
                });
            }
            let mut pass = recorder.compute_pass("visibility");
            let groups = |pass: &mut pointstage_plugin_api::gpu::ComputePass<'_>| {
                pass.set_bind_group(0, &frame_group, &[draw.uniform_offset]);
                pass.set_bind_group(1, &draw.columns, &[]);
                pass.set_bind_group(2, &view.footprint_group, &[]);
                pass.set_bind_group(3, &buffers.group, &[]);
            };
            pass.set_pipeline(&kernel.each);
            groups(&mut pass);
            pass.dispatch_linear(draw.count, kernel.group_size);
            drop(pass);
            if !has_large {
                continue;
            }

            // A buffer cannot be written and give a dispatch its arguments at once.
            recorder.push(CopyBufferToBuffer {
                source: buffers.large.as_handle(),
                source_offset: 0,
                target: buffers.arguments.as_handle(),
                target_offset: 0,
                size: 4,
            });
            let mut pass = recorder.compute_pass("visibility, large");
            pass.set_pipeline(&kernel.large);
            groups(&mut pass);
            pass.dispatch_indirect(&buffers.arguments, 0);
        }
    }
    Ok(buffers.pixels.as_handle())
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
    let colours: Vec<_> = targets
        .attachments(set)
        .map(|target| Some(ColourAttachment::load(&target.texture)))
        .collect();
    let depth = targets.depth.filter(|_| set.has_depth());
    let mut pass = recorder.render_pass(
        "shading",
        &colours,
        depth.map(|target| DepthAttachment::load(&target.texture)),
    );
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
fn missing() -> Error {
    Error::failed("the view's buffers were not made before recording")
}
