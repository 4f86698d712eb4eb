//! One viewport: buffers of the picture's size, and the frame.

use crate::clips::{CLIPPED, FootprintGroups, Variants};
use crate::cpu::{Bins, Nearest, Rectangle, Stage};
use crate::draws::DrawList;
use crate::pipelines::{Kernel, Kernels, Prepared, Source, has_int64};
use crate::record::{missing, record_compute, record_raster, record_shading};
use crate::rectangle::PixelRectangle;
use crate::request::{Path, Request};
use crate::targets::Targets;
use crate::targets::picture_texture;
use pointstage_plugin_api::abi::{self, BufferUsage, Format, Handle};
use pointstage_plugin_api::gpu::{AsHandle, BindGroup, Buffer, Gpu, Recorder, Texture};
use pointstage_plugin_api::{Frame, Host, Outcome, Result, Target, statistics};

/// `BlockUniform` of the shading pass (first id, number of ids, whether it is the first block), padded to an offset that every device accepts.
type BlockUniform = [u32; 64];

/// Bytes from one block's uniform to the next.
pub const BLOCK_STRIDE: u32 = size_of::<BlockUniform>() as u32;
/// Storage buffers that the kernels bind at once with clip lines: these, the columns, pixels and large surfels.
const STORAGE_BUFFERS_CLIPPED: u64 = 9;
/// Large surfels of a draw that the second kernel takes; `LARGE_COUNT` in the shader.
const LARGE_COUNT: u64 = 65_535;

/// Own targets of the raster path, where the host did not ask for them.
pub(crate) struct RasterBuffers {
    size_px: [u32; 2],
    pub(crate) ids: Texture,
    pub(crate) depth: Texture,
}

/// Buffers of the compute path.
pub(crate) struct ComputeBuffers {
    pixel_count: u64,
    pub(crate) pixels: Buffer,
    pub(crate) large: Buffer,
    /// Arguments of the large kernel's dispatch.
    pub(crate) arguments: Buffer,
    pub(crate) group: BindGroup,
}

struct BlockUniforms {
    capacity: usize,
    buffer: Buffer,
}

/// Group 2 of shading, for what it was made of.
struct ShadingGroup {
    visible: Handle,
    blocks: Handle,
    group: BindGroup,
}

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
    blocks: Option<BlockUniforms>,
    shading_group: Option<ShadingGroup>,
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
            blocks: None,
            shading_group: None,
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
        let blocks = self.write_blocks(&prepared.gpu, &list)?;
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
            let group = self.shading_group(prepared, source, visible.ids, &blocks)?;
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
            self.ready_compute(prepared, frame.size_px())?;
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
        self.ready_raster(gpu, frame.size_px())?;
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
        self.ready_compute(prepared, size_px)?;
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

    /// The list of large surfels and the arguments of their dispatch, once the compute path has drawn.
    pub fn large(&self) -> Option<[&Buffer; 2]> {
        let buffers = self.compute.as_ref()?;
        Some([&buffers.large, &buffers.arguments])
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

    /// Textures of the raster path, of this size.
    fn ready_raster(&mut self, gpu: &Gpu, size_px: [u32; 2]) -> Result<()> {
        if self
            .raster
            .as_ref()
            .is_some_and(|buffers| buffers.size_px == size_px)
        {
            return Ok(());
        }
        let texture = |label, format| picture_texture(gpu, label, size_px, format);
        self.raster = Some(RasterBuffers {
            size_px,
            ids: texture("visible ids", Format::R32_UINT)?,
            depth: texture("depth", Format::DEPTH32_FLOAT)?,
        });
        Ok(())
    }

    /// Buffers of the compute path, for a picture of this size.
    fn ready_compute(&mut self, prepared: &Prepared, size_px: [u32; 2]) -> Result<()> {
        let bytes = pixel_bytes(size_px);
        if self
            .compute
            .as_ref()
            .is_some_and(|buffers| buffers.pixel_count == bytes)
        {
            return Ok(());
        }
        let gpu = &prepared.gpu;
        let storage = BufferUsage::STORAGE | BufferUsage::COPY_DST;
        let pixels = gpu.buffer("visible pixels", bytes, storage)?;
        let large = gpu.buffer(
            "large surfels",
            4 * (3 + LARGE_COUNT),
            storage | BufferUsage::COPY_SRC,
        )?;
        // Workgroups in x come from the count, one in y and z.
        let arguments = gpu.buffer_with("large dispatch", BufferUsage::INDIRECT, &[0_u32, 1, 1])?;
        let group = gpu.bind_group(
            "visible pixels",
            &prepared.pixels_layout,
            &[(0, &pixels), (1, &large)],
        )?;
        self.compute = Some(ComputeBuffers {
            pixel_count: bytes,
            pixels,
            large,
            arguments,
            group,
        });
        Ok(())
    }

    /// Writes the blocks' id ranges; the buffer with them.
    ///
    /// # Errors
    /// If the device refuses the buffer.
    pub fn write_blocks(&mut self, gpu: &Gpu, list: &DrawList) -> Result<Buffer> {
        let uniforms: Vec<_> = list
            .blocks
            .iter()
            .enumerate()
            .map(|(number, block)| {
                let mut uniform: BlockUniform = [0; 64];
                uniform[0] = block.id_base;
                uniform[1] = block.id_count;
                uniform[2] = u32::from(number == 0);
                uniform
            })
            .collect();
        let buffer = match &self.blocks {
            Some(blocks) if blocks.capacity >= uniforms.len() => blocks.buffer.clone(),
            _ => {
                let capacity = uniforms.len().next_power_of_two();
                let bytes = capacity as u64 * u64::from(BLOCK_STRIDE);
                let buffer = gpu.buffer(
                    "blocks",
                    bytes,
                    BufferUsage::UNIFORM | BufferUsage::COPY_DST,
                )?;
                self.blocks = Some(BlockUniforms {
                    capacity,
                    buffer: buffer.clone(),
                });
                buffer
            }
        };
        gpu.write(&buffer, 0, &uniforms)?;
        Ok(buffer)
    }

    /// Group 2 of shading. The view keeps it, since the host replays commands after `render`.
    fn shading_group(
        &mut self,
        prepared: &Prepared,
        source: Source,
        visible: Handle,
        blocks: &Buffer,
    ) -> Result<BindGroup> {
        let blocks = blocks.as_handle();
        if let Some(kept) = &self.shading_group
            && kept.visible == visible
            && kept.blocks == blocks
        {
            return Ok(kept.group.clone());
        }
        let layout = match source {
            Source::Ids => &prepared.ids_layout,
            Source::Pixels => &prepared.visible_layout,
        };
        let entries = [
            abi::BindingRecord {
                binding: 0,
                resource: visible,
                ..Default::default()
            },
            abi::BindingRecord {
                binding: 1,
                resource: blocks,
                offset: 0,
                size: u64::from(BLOCK_STRIDE),
            },
        ];
        let group = prepared.gpu.bind_group_from(&abi::BindGroupDescriptor {
            label: "visible".into(),
            layout: layout.handle(),
            entries: entries.as_slice().into(),
        })?;
        self.shading_group = Some(ShadingGroup {
            visible,
            blocks,
            group: group.clone(),
        });
        Ok(group)
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

/// Places of a rectangle's rows in a buffer of all pixels.
pub fn rows_of(pixels: PixelRectangle, size_px: [u32; 2]) -> core::ops::Range<usize> {
    let row = |row: u32| row as usize * size_px[0] as usize;
    row(pixels.origin[1])..row(pixels.origin[1] + pixels.size[1])
}

/// Emptying and bringing to the device this many pixels takes the CPU as long as it saves on a splat.
const PIXELS_A_SPLAT: u64 = 16;

/// Bytes of a pixel of the compute path: id and depth.
const PIXEL_BYTES: u64 = 8;

/// Bytes of the compute path's pixels.
fn pixel_bytes([width, height]: [u32; 2]) -> u64 {
    PIXEL_BYTES * u64::from(width) * u64::from(height)
}
