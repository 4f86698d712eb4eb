//! One viewport: buffers of the picture's size, and the frame.

use crate::buffers::{ComputeBuffers, Large, PIXEL_BYTES, RasterBuffers, rows_of};
use crate::clips::{CLIPPED, FootprintGroups, Variants};
use crate::cpu::{Bins, Nearest, Rectangle, Stage};
use crate::draws::DrawList;
use crate::pipelines::{Kernel, Kernels, Prepared, Source, has_int64};
use crate::record::{missing, record_compute, record_raster, record_shading};
use crate::rectangle::PixelRectangle;
use crate::request::{Path, Request};
use crate::shading_inputs::ShadingInputs;
use crate::targets::Targets;
use pointstage_plugin_api::abi::{BufferUsage, Handle};
use pointstage_plugin_api::gpu::{AsHandle, Buffer, Gpu, Recorder};
use pointstage_plugin_api::{Frame, Host, Outcome, Result, Target, statistics};

/// Storage buffers that the kernels bind at once with clip lines: these, the columns, pixels and large surfels.
const STORAGE_BUFFERS_CLIPPED: u64 = 9;
/// What is visible, where the next step finds it.
#[derive(Clone, Copy, Debug)]
pub struct Visible {
    /// In textures or in a buffer.
    pub source: Source,
    /// The path taken: not [`Path::Auto`].
    pub path: Path,
    /// Where anything can be visible.
    pub pixels: PixelRectangle,
    /// The texture of ids, or the buffer of pixels (id and depth bits).
    pub ids: Handle,
    /// The depth texture, or the same buffer.
    pub depths: Handle,
}

/// A renderer in one viewport.
pub struct VisibilityView {
    host: Host,
    uniform: Buffer,
    /// Group 2 of visibility: the footprint's uniform, and clip lines of draws that have any.
    pub footprint_groups: FootprintGroups,
    pub(crate) raster: Option<RasterBuffers>,
    pub(crate) compute: Option<ComputeBuffers>,
    shading: ShadingInputs,
    bins: Bins,
    nearest: Nearest,
    warned: bool,
}

impl VisibilityView {
    /// Makes what one viewport needs.
    ///
    /// # Errors
    /// If the device refuses a resource.
    pub fn new(host: &Host, prepared: &Prepared) -> Result<Self> {
        let gpu = &prepared.gpu;
        let usage = BufferUsage::UNIFORM | BufferUsage::COPY_DST;
        let uniform = gpu.buffer("footprint", prepared.footprint.uniform_size, usage)?;
        let footprint_group =
            gpu.bind_group("footprint", &prepared.footprint_layout, &[(0, &uniform)])?;
        let clipped = prepared.clips.buffers().map(|lines| {
            let entries: [(u32, &dyn AsHandle); 2] = [(0, &uniform), (1, lines)];
            gpu.bind_group(
                "footprint and clip lines",
                &prepared.clipped_layout,
                &entries,
            )
        });
        let clipped: Result<Vec<_>> = clipped.collect();
        let footprint_groups = FootprintGroups::new(footprint_group, clipped?);
        Ok(Self {
            host: host.clone(),
            uniform,
            footprint_groups,
            raster: None,
            compute: None,
            shading: ShadingInputs::default(),
            bins: Bins::default(),
            nearest: Nearest::default(),
            warned: false,
        })
    }

    /// Draws a frame's selection into the targets that were asked for.
    ///
    /// # Errors
    /// If the device refuses a resource or a shader.
    pub fn render(
        &mut self,
        prepared: &Prepared,
        frame: &mut Frame<'_>,
        request: &Request<'_>,
    ) -> Result<Outcome> {
        let mut list = DrawList::of(frame, request.extent.reach_px(), &prepared.clips);
        let targets = Targets::of(frame);
        if list.draws.is_empty() || targets.all().is_empty() {
            return Ok(Outcome::Done);
        }
        let blocks = self.shading.write_blocks(&prepared.gpu, &list)?;
        let mut recorder = Recorder::new();
        let own = [targets.id(), targets.level(), targets.depth];
        let visible = self.record_visible(prepared, frame, request, &list, own, &mut recorder)?;
        let source = visible.source;
        list.narrow(visible.pixels);
        let set = match source {
            Source::Pixels => targets.all(),
            Source::Ids => targets.without_visibility(),
        };
        if !set.is_empty() {
            let pipeline = prepared.shading(source, set)?;
            let group = self.shading.group(prepared, source, visible.ids, &blocks)?;
            record_shading(
                &mut recorder,
                &group,
                frame.group(),
                &list,
                &targets,
                set,
                &pipeline,
            );
        }
        frame.submit(recorder);
        frame.report(statistics::SURFELS_SELECTED, list.surfel_count as f64);
        frame.report(statistics::PATH, visible.path.number());
        Ok(Outcome::Done)
    }

    /// Records the first step alone: the nearest surfel of each pixel, of a list that is not empty.
    ///
    /// The raster path writes id, level and depth into those targets that are given, and into textures of its own otherwise;
    /// the other paths write none of them. If the CPU draws, it is done when this returns.
    ///
    /// # Errors
    /// If the device refuses a resource or a shader.
    pub fn record_visible(
        &mut self,
        prepared: &Prepared,
        frame: &Frame<'_>,
        request: &Request<'_>,
        list: &DrawList,
        targets: [Option<Target>; 3],
        recorder: &mut Recorder,
    ) -> Result<Visible> {
        let gpu = &prepared.gpu;
        let [_, level, _] = targets;
        if let Some(splats) = request.cpu
            && let Some(stage) = self.cpu_stage(prepared, frame, request, list, level.is_some())
        {
            let mut nearest = core::mem::take(&mut self.nearest);
            nearest.resize(frame.size_px());
            let reached = splats.draw(&stage, frame.thread_count(), &mut self.bins, &mut nearest);
            let visible = self.write_visible(prepared, request, &nearest, reached);
            self.nearest = nearest;
            return visible;
        }
        gpu.write(&self.uniform, 0, request.uniform)?;
        let features = features_of(request, list);
        let pixels = PixelRectangle {
            origin: [0, 0],
            size: frame.size_px(),
        };
        if self.takes_compute(gpu, frame.size_px(), request, list, level.is_some()) {
            let kernels = compute_kernels(prepared, request, &features, list)?;
            ComputeBuffers::ready(&mut self.compute, prepared, frame.size_px())?;
            let frame = frame.group();
            let buffer = record_compute(recorder, self, frame, list, &kernels, request.extent)?;
            return Ok(Visible {
                source: Source::Pixels,
                path: Path::Compute,
                pixels,
                ids: buffer,
                depths: buffer,
            });
        }
        RasterBuffers::ready(&mut self.raster, gpu, frame.size_px())?;
        let pipelines = Variants::of(list, |is_clipped| {
            prepared.raster(&with_clip(&features, is_clipped), level.is_some())
        })?;
        let group = frame.group();
        let [ids, depths] =
            record_raster(recorder, self, prepared, group, list, targets, &pipelines)?;
        Ok(Visible {
            source: Source::Ids,
            path: Path::Raster,
            pixels,
            ids,
            depths,
        })
    }

    /// What the CPU is to draw, if it draws this frame.
    ///
    /// * `has_level`: whether each draw's level is asked for.
    pub fn cpu_stage<'f>(
        &mut self,
        prepared: &Prepared,
        frame: &Frame<'f>,
        request: &Request<'_>,
        list: &DrawList,
        has_level: bool,
    ) -> Option<Stage<'f>> {
        let gpu = &prepared.gpu;
        let size_px = frame.size_px();
        let pixels = u64::from(size_px[0]) * u64::from(size_px[1]);
        let is_wanted = match request.path {
            Path::Raster | Path::Compute => false,
            Path::Cpu => true,
            Path::Auto => gpu.is_software() && list.surfel_count * PIXELS_A_SPLAT > pixels,
        };
        if !is_wanted || obstacle(gpu, size_px, request, list, has_level).is_some() {
            return None;
        }
        let stage = Stage::of(frame, &prepared.clips);
        if stage.is_none() && request.path == Path::Cpu {
            self.warn("drawn by compute, not by the CPU: the device alone knows which surfels are drawn, or the CPU lacks their columns");
        }
        stage
    }

    /// Brings what the CPU has drawn to the device, as the compute path would leave it.
    ///
    /// * `reached`: where `nearest` can hold anything.
    ///
    /// # Errors
    /// If the device refuses a resource.
    pub fn write_visible(
        &mut self,
        prepared: &Prepared,
        request: &Request<'_>,
        nearest: &Nearest,
        reached: Rectangle,
    ) -> Result<Visible> {
        let gpu = &prepared.gpu;
        gpu.write(&self.uniform, 0, request.uniform)?;
        let size_px = nearest.size_px();
        ComputeBuffers::ready(&mut self.compute, prepared, size_px)?;
        let buffers = self.compute.as_ref().ok_or_else(missing)?;
        // Shading may look at the next pixels, too.
        let rows = rows_of(reached.pixels(1, size_px), size_px);
        let pixels = nearest.pixels().get(rows.clone()).unwrap_or_default();
        gpu.write(&buffers.pixels, PIXEL_BYTES * rows.start as u64, pixels)?;
        Ok(Visible {
            source: Source::Pixels,
            path: Path::Cpu,
            pixels: reached.pixels(0, size_px),
            ids: buffers.pixels.as_handle(),
            depths: buffers.pixels.as_handle(),
        })
    }

    /// What the second kernels draw, once the compute path has drawn.
    pub fn large(&self) -> Option<&Large> {
        self.compute.as_ref().map(|buffers| &buffers.large)
    }

    /// Writes the blocks' id ranges; the buffer with them.
    ///
    /// # Errors
    /// If the device refuses the buffer.
    pub fn write_blocks(&mut self, gpu: &Gpu, list: &DrawList) -> Result<Buffer> {
        self.shading.write_blocks(gpu, list)
    }

    /// Whether the compute path draws this frame.
    fn takes_compute(
        &mut self,
        gpu: &Gpu,
        size_px: [u32; 2],
        request: &Request<'_>,
        list: &DrawList,
        has_level: bool,
    ) -> bool {
        let wanted = match request.path {
            Path::Raster => false,
            Path::Compute | Path::Cpu => true,
            Path::Auto => gpu.is_software() || has_int64(gpu),
        };
        if !wanted {
            return false;
        }
        let binds = !list.has_clips()
            || gpu.limit("max_storage_buffers_per_shader_stage") >= Some(STORAGE_BUFFERS_CLIPPED);
        let obstacle = obstacle(gpu, size_px, request, list, has_level);
        let too_few = "the device binds too few storage buffers for clip lines";
        let Some(obstacle) = obstacle.or((!binds).then_some(too_few)) else {
            return true;
        };
        if matches!(request.path, Path::Compute | Path::Cpu) {
            self.warn(&format!(
                "drawn by the raster path, not by compute or the CPU: {obstacle}"
            ));
        }
        false
    }

    /// Tells once that what was asked for cannot be had.
    fn warn(&mut self, why: &str) {
        if !self.warned {
            self.warned = true;
            self.host.performance_warning(why);
        }
    }
}

/// Features of the footprint's module in this frame.
fn features_of(request: &Request<'_>, list: &DrawList) -> Vec<&'static str> {
    let direct = list.is_direct.then_some("direct");
    request.features.iter().copied().chain(direct).collect()
}

/// The features, and that of clip lines where there are any.
fn with_clip(features: &[&'static str], is_clipped: bool) -> Vec<&'static str> {
    let clipped = is_clipped.then_some(CLIPPED);
    features.iter().copied().chain(clipped).collect()
}

/// The kernels of a frame, in order: one where 64 bits hold depth and id, else one after the other.
fn compute_kernels(
    prepared: &Prepared,
    request: &Request<'_>,
    features: &[&'static str],
    list: &DrawList,
) -> Result<Vec<Variants<Kernels>>> {
    let kernels: &[_] = if has_int64(&prepared.gpu) {
        &[Kernel::Whole]
    } else {
        &[Kernel::NearestDepth, Kernel::GreatestId]
    };
    let of_extent = request.extent.feature();
    let features: Vec<_> = features.iter().copied().chain(of_extent).collect();
    kernels
        .iter()
        .map(|&kernel| {
            Variants::of(list, |is_clipped| {
                prepared.compute(&with_clip(&features, is_clipped), kernel)
            })
        })
        .collect()
}

/// Why what is visible cannot be kept in a buffer.
fn obstacle(
    gpu: &Gpu,
    size_px: [u32; 2],
    request: &Request<'_>,
    list: &DrawList,
    has_level: bool,
) -> Option<&'static str> {
    let limit = gpu
        .limit("max_storage_buffer_binding_size")
        .unwrap_or(128 << 20);
    let pixels = u64::from(size_px[0]) * u64::from(size_px[1]);
    if pixels * request.bytes_per_pixel.max(PIXEL_BYTES) > limit {
        Some("the picture has more pixels than a storage buffer of this device holds")
    } else if list.mixes_levels && has_level {
        Some("the 'lod' target is asked for, and draws of one block have different levels")
    } else {
        None
    }
}

/// Emptying and bringing to the device this many pixels takes the CPU as long as it saves on a splat.
const PIXELS_A_SPLAT: u64 = 16;
