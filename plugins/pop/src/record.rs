//! The passes of a frame, recorded.

use crate::passes::{Kernels, Kind};
use crate::uniforms::STRIDE;
use pointstage_plugin_api::gpu::{
    BindGroup, Buffer, ComputePass, ComputePipeline, GroupRef, Recorder, RenderPass, RenderPipeline,
};
use pointstage_visibility::{Large, PixelRectangle, TargetSet, Targets};

/// How many primitives there are.
#[derive(Clone, Copy)]
pub(crate) enum Count<'a> {
    Known(u32),
    /// Arguments of the dispatch and of the draw, at these places; bytes.
    OnDevice {
        arguments: &'a Buffer,
        dispatch: u64,
        draw: u64,
    },
}

/// Primitives of one kind, of one tree.
#[derive(Clone, Copy)]
pub(crate) struct Draw<'a> {
    pub(crate) kind: Kind,
    /// Which tree.
    pub(crate) part: usize,
    /// Whether the CPU has drawn it: it is only lit.
    pub(crate) is_drawn: bool,
    pub(crate) count: Count<'a>,
    /// Which uniform of group 2.
    pub(crate) uniform: u32,
    /// Of the object's draw, for group 0.
    pub(crate) frame_offset: u32,
    /// Group 1.
    pub(crate) tree: &'a BindGroup,
    /// Group 2.
    pub(crate) list: &'a BindGroup,
    /// Where the object can be seen.
    pub(crate) pixels: PixelRectangle,
}

/// What the compute path is bound to.
#[derive(Clone, Copy)]
pub(crate) struct Pixels<'a> {
    /// Group 3.
    pub(crate) group: &'a BindGroup,
    /// Large triangles.
    pub(crate) large: &'a Large,
}

/// Groups 0 to 2 of a pass.
macro_rules! bind {
    ($pass:expr, $frame:expr, $draw:expr) => {
        $pass.set_bind_group(0, &$frame, &[$draw.frame_offset]);
        $pass.set_bind_group(1, $draw.tree, &[]);
        $pass.set_bind_group(2, $draw.list, &[$draw.uniform * STRIDE]);
    };
}

/// The kernels of one draw.
pub(crate) fn record_kernels(
    recorder: &mut Recorder,
    frame: GroupRef,
    draw: &Draw<'_>,
    kernels: &Kernels,
    group_size: u32,
    pixels: &Pixels<'_>,
) {
    if kernels.large.is_some() {
        pixels.large.clear(recorder);
    }
    let bind = |pass: &mut ComputePass<'_>| {
        bind!(pass, frame, draw);
        pass.set_bind_group(3, pixels.group, &[]);
    };
    let mut pass = recorder.compute_pass(label(draw.kind));
    pass.set_pipeline(&kernels.each);
    bind(&mut pass);
    dispatch(&mut pass, draw.count, group_size);
    drop(pass);
    let Some(large) = &kernels.large else { return };
    let arguments = pixels.large.dispatch_arguments(recorder);
    let mut pass = recorder.compute_pass("large triangles");
    pass.set_pipeline(large);
    bind(&mut pass);
    pass.dispatch_indirect(arguments, 0);
}

/// What the splats of one draw give their pixels.
///
/// * `adding`: group 3.
pub(crate) fn record_sums(
    recorder: &mut Recorder,
    frame: GroupRef,
    draw: &Draw<'_>,
    kernel: &ComputePipeline,
    group_size: u32,
    adding: &BindGroup,
) {
    let mut pass = recorder.compute_pass("blended splats");
    pass.set_pipeline(kernel);
    bind!(pass, frame, draw);
    pass.set_bind_group(3, adding, &[]);
    dispatch(&mut pass, draw.count, group_size);
}

/// An invocation for each primitive.
fn dispatch(pass: &mut ComputePass<'_>, count: Count<'_>, group_size: u32) {
    match count {
        Count::Known(count) => pass.dispatch_linear(count, group_size),
        Count::OnDevice {
            arguments,
            dispatch,
            ..
        } => pass.dispatch_indirect(arguments, dispatch),
    }
}

/// One draw of the raster path's pass.
pub(crate) fn record_raster(
    pass: &mut RenderPass<'_>,
    frame: GroupRef,
    draw: &Draw<'_>,
    pipeline: &RenderPipeline,
) {
    let vertices = if draw.kind.is_triangles() { 3 } else { 6 };
    pass.set_pipeline(pipeline);
    bind!(pass, frame, draw);
    match draw.count {
        Count::Known(count) => pass.draw(0..count.saturating_mul(vertices), 0..1),
        Count::OnDevice {
            arguments, draw, ..
        } => pass.draw_indirect(arguments, draw),
    }
}

/// Shading: each tree lights its own pixels, with the first of its draws' uniforms.
pub(crate) fn record_shading(
    recorder: &mut Recorder,
    frame: GroupRef,
    draws: &[Draw<'_>],
    visible: &BindGroup,
    (targets, set): (&Targets, TargetSet),
    pipeline: &RenderPipeline,
) {
    let mut pass = targets.shading_pass(set, recorder);
    pass.set_pipeline(pipeline);
    pass.set_bind_group(3, visible, &[]);
    let mut last = None;
    for draw in draws {
        if last == Some(draw.part) || draw.pixels.size.contains(&0) {
            continue;
        }
        last = Some(draw.part);
        bind!(pass, frame, draw);
        pass.set_scissor(draw.pixels.origin, draw.pixels.size);
        pass.draw(0..3, 0..1);
    }
}

fn label(kind: Kind) -> &'static str {
    match kind {
        Kind::Splats => "splats",
        Kind::Triangles => "triangles",
        Kind::AllTriangles => "whole mesh",
        Kind::Points => "points",
    }
}
