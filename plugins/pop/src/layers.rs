//! What is visible, recorded: splats and triangles in one layer, or, where splats blend, in a layer each, and the sums of the
//! splats. Shading brings the two together.

use crate::cpu_pixels::Pixels as CpuPixels;
use crate::passes::{Kind, Passes};
use crate::record::{Draw, Pixels, record_kernels, record_raster, record_sums};
use crate::settings::Wanted;
use crate::visible::Visible;
use pointstage_plugin_api::Result;
use pointstage_plugin_api::gpu::{
    BindGroup, Buffer, ColourAttachment, DepthAttachment, GroupRef, Recorder, Texture,
};
use pointstage_visibility::group_size;

/// A frame's draws, and how they are drawn.
#[derive(Clone, Copy)]
pub(crate) struct Layers<'a> {
    pub(crate) passes: &'a Passes,
    /// Group 0.
    pub(crate) frame: GroupRef,
    pub(crate) wanted: &'a Wanted,
    pub(crate) draws: &'a [Draw<'a>],
    /// What the CPU has drawn, if it has.
    pub(crate) on_cpu: Option<&'a CpuPixels>,
}

impl Layers<'_> {
    /// Records all layers; group 3 of shading.
    ///
    /// # Errors
    /// If the device refuses a shader.
    pub(crate) fn record<'v>(
        &self,
        recorder: &mut Recorder,
        visible: &'v Visible,
    ) -> Result<&'v BindGroup> {
        match visible {
            Visible::Buffers {
                pixels,
                large,
                group,
                shading,
                blended,
                ..
            } => {
                let bound = |group| Pixels { group, large };
                if let Some(blended) = blended {
                    recorder.clear_buffer(pixels);
                    self.record_kernels(recorder, &bound(group), Kind::is_triangles)?;
                    self.start(recorder, &blended.splats)?;
                    self.record_kernels(recorder, &bound(&blended.group), |kind| {
                        !kind.is_triangles()
                    })?;
                    if let Some(drawn) = self.on_cpu {
                        for (sum, values) in blended.sums.iter().zip(drawn.sums()) {
                            self.passes.gpu.write(sum, 0, values)?;
                        }
                    } else {
                        for sum in &blended.sums {
                            recorder.clear_buffer(sum);
                        }
                        self.record_sums(recorder, &blended.adding)?;
                    }
                } else {
                    self.start(recorder, pixels)?;
                    self.record_kernels(recorder, &bound(group), |_| true)?;
                }
                Ok(shading)
            }
            Visible::Textures {
                primitives,
                depth,
                shading,
                blended,
                ..
            } => {
                if let Some(blended) = blended {
                    let of = Kind::is_triangles;
                    self.record_raster(recorder, "triangles", [primitives, depth], of)?;
                    let splats = [&blended.splats, &blended.depth];
                    self.record_raster(recorder, "splats", splats, |kind| !kind.is_triangles())?;
                    self.record_blending(recorder, &blended.sums, &blended.depth)?;
                } else {
                    self.record_raster(recorder, "primitives", [primitives, depth], |_| true)?;
                }
                Ok(shading)
            }
        }
    }

    /// Empties the layer of splats, or fills it with what the CPU has drawn.
    fn start(&self, recorder: &mut Recorder, pixels: &Buffer) -> Result<()> {
        if let Some(drawn) = self.on_cpu {
            return self.passes.gpu.write(pixels, 0, drawn.nearest());
        }
        recorder.clear_buffer(pixels);
        Ok(())
    }

    /// Draws of some kinds, by compute.
    fn record_kernels(
        &self,
        recorder: &mut Recorder,
        bound: &Pixels<'_>,
        is_of_layer: impl Fn(Kind) -> bool,
    ) -> Result<()> {
        for &kernel in self.passes.kernel_order() {
            for draw in self
                .draws
                .iter()
                .filter(|draw| !draw.is_drawn && is_of_layer(draw.kind))
            {
                let kernels = self
                    .passes
                    .compute(draw.kind, self.wanted.is_disk(), kernel)?;
                let size = group_size(&self.passes.gpu);
                record_kernels(recorder, self.frame, draw, &kernels, size, bound);
            }
        }
        Ok(())
    }

    /// What splats give their pixels, by compute.
    fn record_sums(&self, recorder: &mut Recorder, adding: &BindGroup) -> Result<()> {
        for draw in self.draws {
            if !draw.is_drawn && !draw.kind.is_triangles() {
                let kernel = self
                    .passes
                    .blending_compute(draw.kind, self.wanted.has_pop_colours)?;
                let size = group_size(&self.passes.gpu);
                record_sums(recorder, self.frame, draw, &kernel, size, adding);
            }
        }
        Ok(())
    }

    /// Draws of some kinds, by the raster pipeline.
    fn record_raster(
        &self,
        recorder: &mut Recorder,
        label: &str,
        [primitives, depth]: [&Texture; 2],
        is_of_layer: impl Fn(Kind) -> bool,
    ) -> Result<()> {
        let colours = [Some(ColourAttachment::clear(primitives, [0.0; 4]))];
        let depth = Some(DepthAttachment::clear(depth));
        let mut pass = recorder.render_pass(label, &colours, depth);
        for draw in self.draws.iter().filter(|draw| is_of_layer(draw.kind)) {
            let pipeline = self.passes.raster(draw.kind, self.wanted.is_disk())?;
            record_raster(&mut pass, self.frame, draw, &pipeline);
        }
        Ok(())
    }

    /// What splats give their pixels, by the raster pipeline.
    fn record_blending(
        &self,
        recorder: &mut Recorder,
        sums: &[Texture; 2],
        depth: &Texture,
    ) -> Result<()> {
        let cleared = sums
            .each_ref()
            .map(|sum| Some(ColourAttachment::clear(sum, [0.0; 4])));
        let depth = Some(DepthAttachment::read_only(depth));
        let mut pass = recorder.render_pass("blended splats", &cleared, depth);
        for draw in self.draws.iter().filter(|draw| !draw.kind.is_triangles()) {
            let pipeline = self
                .passes
                .blending_raster(draw.kind, self.wanted.has_pop_colours)?;
            record_raster(&mut pass, self.frame, draw, &pipeline);
        }
        Ok(())
    }
}
