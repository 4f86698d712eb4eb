//! One viewport: the sums, and the three passes of a frame.

use crate::cpu::{Look, Picture};
use crate::passes::{Passes, Sums as Layout};
use crate::settings::{LIT_SPLATS, Wanted};
use pointstage_plugin_api::abi::{self, BindingRecord, BufferUsage, Format, Handle};
use pointstage_plugin_api::gpu::{
    AsHandle, BindGroup, BindGroupLayout, Buffer, ColourAttachment, DepthAttachment, Gpu, Recorder,
    Texture,
};
use pointstage_plugin_api::{Error, Frame, Host, Outcome, Result, statistics};
use pointstage_visibility::{
    BLOCK_STRIDE, CLIPPED, DrawList, Extent, KernelGroups, Path, Request, Source, TargetSet,
    Targets, Variants, VisibilityView, Visible, blends_float32, picture_texture, record_kernels,
    record_quads, rows_of,
};

/// Bytes of a pixel in each of the two buffers or textures of sums.
const SUM_BYTES: u64 = 16;
/// Storage buffers that the kernels bind at once: the columns, pixels, large surfels and two sums; one more with clip lines.
const STORAGE_BUFFERS: u64 = 10;

/// Where the attribute pass adds.
enum Sums {
    Textures([Texture; 2]),
    Buffers([Buffer; 2]),
}

/// Bind groups for what they were made of.
struct Groups {
    made_of: Vec<Handle>,
    shading: BindGroup,
    /// Group 3 of the attribute kernels, on the compute path.
    kernels: Option<BindGroup>,
}

/// A renderer in one viewport.
pub(crate) struct BlendedView {
    host: Host,
    visibility: VisibilityView,
    sums: Option<([u32; 2], Format, Sums)>,
    groups: Option<Groups>,
    /// What the CPU draws.
    picture: Picture,
    has_warned: bool,
}

impl BlendedView {
    /// # Errors
    /// If the device refuses a resource.
    pub(crate) fn new(host: &Host, passes: &Passes) -> Result<Self> {
        Ok(Self {
            host: host.clone(),
            visibility: VisibilityView::new(host, &passes.visibility)?,
            sums: None,
            groups: None,
            picture: Picture::default(),
            has_warned: false,
        })
    }

    /// Draws a frame's selection into the targets that were asked for.
    ///
    /// # Errors
    /// If the device refuses a resource or a shader.
    pub(crate) fn render(
        &mut self,
        passes: &Passes,
        frame: &mut Frame<'_>,
        wanted: &Wanted,
    ) -> Result<Outcome> {
        let gpu = &passes.visibility.gpu;
        let mut list = DrawList::of(frame, None, &passes.visibility.clips);
        let targets = Targets::of(frame);
        if list.draws.is_empty() || targets.all().is_empty() {
            return Ok(Outcome::Done);
        }
        let request = Request {
            path: self.path(gpu, &list, wanted.path),
            features: &wanted.features,
            extent: Extent::Any,
            bytes_per_pixel: SUM_BYTES,
            uniform: bytemuck::bytes_of(&wanted.uniform),
            cpu: None,
        };
        let direct = list.is_direct.then_some("direct");
        let features: Vec<_> = wanted.features.iter().copied().chain(direct).collect();
        let mut recorder = Recorder::new();
        let visible = match self.draw_on_cpu(passes, frame, wanted, &request, &list)? {
            Some(visible) => visible,
            None => self.visibility.record_visible(
                &passes.visibility,
                frame,
                &request,
                &list,
                [targets.id(), None, None],
                &mut recorder,
            )?,
        };
        list.narrow(visible.pixels);
        let blocks = self.visibility.write_blocks(gpu, &list)?;
        self.ready_sums(gpu, frame.size_px(), visible.source)?;
        self.ready_groups(passes, &visible, &blocks)?;
        let shading_features: Vec<_> = features.iter().copied().chain(wanted.look).collect();
        let layout = match (visible.path, visible.source) {
            (Path::Cpu, _) => {
                self.write_picture(gpu, &visible)?;
                Layout::Resolved
            }
            (_, Source::Pixels) => Layout::Buffers,
            (_, Source::Ids) => Layout::Textures,
        };
        if layout != Layout::Resolved {
            let lit = wanted.look.filter(|look| *look == LIT_SPLATS);
            let features: Vec<_> = features.iter().copied().chain(lit).collect();
            self.record_attributes(passes, frame, &list, &visible, &features, &mut recorder)?;
        }
        let set = match visible.source {
            Source::Pixels => targets.all(),
            Source::Ids => targets.without_id(),
        };
        if !set.is_empty() {
            self.record_shading(
                passes,
                frame,
                &list,
                &targets,
                (layout, set),
                &shading_features,
                &mut recorder,
            )?;
        }
        frame.submit(recorder);
        frame.report(statistics::SURFELS_SELECTED, list.surfel_count as f64);
        frame.report(statistics::PATH, visible.path.number());
        Ok(Outcome::Done)
    }

    /// Draws visibility and attributes on the CPU; none if another path is to draw.
    fn draw_on_cpu(
        &mut self,
        passes: &Passes,
        frame: &Frame<'_>,
        wanted: &Wanted,
        request: &Request<'_>,
        list: &DrawList,
    ) -> Result<Option<Visible>> {
        let prepared = &passes.visibility;
        let stage = self
            .visibility
            .cpu_stage(prepared, frame, request, list, false);
        let Some(stage) = stage else {
            return Ok(None);
        };
        let look = Look {
            uniform: wanted.uniform,
            culls_backs: wanted.culls_backs,
            filters: wanted.filters,
            is_flat: wanted.look == Some("flat_normals"),
            lights: (wanted.look == Some(LIT_SPLATS)).then(|| *frame.uniform()),
        };
        let reached = self
            .picture
            .draw(&stage, &look, frame.size_px(), frame.thread_count());
        let nearest = &self.picture.nearest;
        self.visibility
            .write_visible(&passes.visibility, request, nearest, reached)
            .map(Some)
    }

    /// Brings to the device what the CPU has made of the sums.
    fn write_picture(&self, gpu: &Gpu, visible: &Visible) -> Result<()> {
        let Some((size_px, _, Sums::Buffers([colours, surfaces]))) = &self.sums else {
            return Err(missing());
        };
        let mut reached = visible.pixels;
        // Toon shading looks at the next row, too.
        reached.size[1] = (reached.size[1] + 1).min(size_px[1] - reached.origin[1]);
        let rows = rows_of(reached, *size_px);
        let start = SUM_BYTES * rows.start as u64;
        let Picture {
            colours: drawn,
            surfaces: seen,
            ..
        } = &self.picture;
        gpu.write(colours, start, drawn.get(rows.clone()).unwrap_or_default())?;
        gpu.write(surfaces, start, seen.get(rows).unwrap_or_default())
    }

    /// The path that the device can take: raster needs 32-bit blending, compute enough storage buffers.
    fn path(&mut self, gpu: &Gpu, list: &DrawList, wanted: Path) -> Path {
        let blends = blends_float32(gpu);
        let binds = gpu.limit("max_storage_buffers_per_shader_stage")
            >= Some(STORAGE_BUFFERS + u64::from(list.has_clips()));
        let (path, why) = match wanted {
            Path::Compute if !binds => (
                Path::Raster,
                "drawn by the raster path: the device binds too few storage buffers for compute",
            ),
            Path::Raster if !blends && binds => (
                Path::Compute,
                "drawn by compute: the device cannot blend 32-bit floats, so sums of the raster path would stand still",
            ),
            Path::Auto if !binds => (Path::Raster, ""),
            Path::Auto if !blends => (Path::Compute, ""),
            path => (path, ""),
        };
        self.warn(why);
        path
    }

    fn warn(&mut self, why: &str) {
        if !why.is_empty() && !self.has_warned {
            self.has_warned = true;
            self.host.performance_warning(why);
        }
    }

    /// Sums of this size, for the path.
    fn ready_sums(&mut self, gpu: &Gpu, size_px: [u32; 2], source: Source) -> Result<()> {
        let format = if blends_float32(gpu) {
            Format::RGBA32_FLOAT
        } else {
            Format::RGBA16_FLOAT
        };
        let fits = |(size, its, sums): &([u32; 2], Format, Sums)| {
            let of_path = match sums {
                Sums::Textures(_) => source == Source::Ids,
                Sums::Buffers(_) => source == Source::Pixels,
            };
            of_path && *size == size_px && *its == format
        };
        if self.sums.as_ref().is_some_and(fits) {
            return Ok(());
        }
        // What is too large or too small goes before the new one comes.
        self.sums = None;
        self.groups = None;
        let sums = match source {
            Source::Ids => {
                let texture = |label| picture_texture(gpu, label, size_px, format);
                Sums::Textures([texture("sums of colours")?, texture("sums of normals")?])
            }
            Source::Pixels => {
                let bytes = SUM_BYTES * u64::from(size_px[0]) * u64::from(size_px[1]);
                let usage = BufferUsage::STORAGE | BufferUsage::COPY_DST;
                let buffer = |label| gpu.buffer(label, bytes, usage);
                Sums::Buffers([buffer("sums of colours")?, buffer("sums of normals")?])
            }
        };
        self.sums = Some((size_px, format, sums));
        Ok(())
    }

    /// Bind groups of what the frame uses. The view keeps them, since the host replays commands after `render`.
    fn ready_groups(&mut self, passes: &Passes, visible: &Visible, blocks: &Buffer) -> Result<()> {
        let Some((_, _, sums)) = &self.sums else {
            return Err(missing());
        };
        let gpu = &passes.visibility.gpu;
        let (layout, sums, large) = match sums {
            Sums::Textures(sums) => {
                let sums = sums.each_ref().map(AsHandle::as_handle);
                let seen = [visible.ids, visible.depths];
                (&passes.textures_layout, [&seen[..], &sums].concat(), None)
            }
            Sums::Buffers(sums) => {
                let sums = sums.each_ref().map(AsHandle::as_handle);
                let large = self.visibility.large().ok_or_else(missing)?;
                let seen = [visible.ids];
                let all = [&seen[..], &sums].concat();
                (&passes.buffers_layout, all, Some(large.list.as_handle()))
            }
        };
        let made_of: Vec<_> = [blocks.as_handle()]
            .into_iter()
            .chain(sums.iter().copied())
            .chain(large)
            .collect();
        if self
            .groups
            .as_ref()
            .is_some_and(|groups| groups.made_of == made_of)
        {
            return Ok(());
        }
        let block = BindingRecord {
            binding: 0,
            resource: blocks.as_handle(),
            offset: 0,
            size: u64::from(BLOCK_STRIDE),
        };
        let rest = (1..)
            .zip(&sums)
            .map(|(binding, resource)| whole(binding, *resource));
        let shading = group(gpu, layout, [block].into_iter().chain(rest))?;
        let kernels = match (large, &sums[..]) {
            (Some(large), [pixels, colours, normals]) => {
                let all = [*pixels, large, *colours, *normals];
                let all = (0..)
                    .zip(all)
                    .map(|(binding, resource)| whole(binding, resource));
                Some(group(gpu, &passes.sums_layout, all)?)
            }
            _ => None,
        };
        self.groups = Some(Groups {
            made_of,
            shading,
            kernels,
        });
        Ok(())
    }

    fn record_attributes(
        &self,
        passes: &Passes,
        frame: &Frame<'_>,
        list: &DrawList,
        visible: &Visible,
        features: &[&'static str],
        recorder: &mut Recorder,
    ) -> Result<()> {
        let (Some((_, format, sums)), Some(groups)) = (&self.sums, &self.groups) else {
            return Err(missing());
        };
        let footprint = &self.visibility.footprint_groups;
        let with_clip = |is_clipped: bool| {
            let clipped = is_clipped.then_some(CLIPPED);
            features.iter().copied().chain(clipped).collect::<Vec<_>>()
        };
        match sums {
            Sums::Textures(sums) => {
                let pipelines = Variants::of(list, |is_clipped| {
                    passes.raster(&with_clip(is_clipped), *format)
                })?;
                let cleared = sums
                    .each_ref()
                    .map(|sum| Some(ColourAttachment::clear(sum, [0.0; 4])));
                let depth = DepthAttachment::read_only(&visible.depths);
                let mut pass = recorder.render_pass("attributes", &cleared, Some(depth));
                record_quads(
                    &mut pass,
                    &passes.visibility,
                    frame.group(),
                    footprint,
                    &pipelines,
                    list,
                );
            }
            Sums::Buffers(sums) => {
                let kernels =
                    Variants::of(list, |is_clipped| passes.compute(&with_clip(is_clipped)))?;
                for sum in sums {
                    recorder.clear_buffer(sum);
                }
                let groups = KernelGroups {
                    frame: frame.group(),
                    footprint,
                    pixels: groups.kernels.as_ref().ok_or_else(missing)?,
                    large: self.visibility.large(),
                };
                record_kernels(recorder, "attributes", &kernels, list, &groups);
            }
        }
        Ok(())
    }

    /// Each block lights its own pixels, and the first those at outlines.
    #[expect(clippy::too_many_arguments, reason = "each is a thing of its own")]
    fn record_shading(
        &self,
        passes: &Passes,
        frame: &Frame<'_>,
        list: &DrawList,
        targets: &Targets,
        (layout, set): (Layout, TargetSet),
        features: &[&'static str],
        recorder: &mut Recorder,
    ) -> Result<()> {
        let Some(groups) = &self.groups else {
            return Err(missing());
        };
        let pipeline = passes.shading(layout, set, features)?;
        let mut pass = targets.shading_pass(set, recorder);
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(2, self.visibility.footprint_groups.plain(), &[]);
        for (block, offset) in list.blocks.iter().zip((0..).step_by(BLOCK_STRIDE as usize)) {
            if block.pixels.size.contains(&0) {
                continue;
            }
            pass.set_scissor(block.pixels.origin, block.pixels.size);
            pass.set_bind_group(0, &frame.group(), &[block.uniform_offset]);
            pass.set_bind_group(1, &block.columns, &[]);
            pass.set_bind_group(3, &groups.shading, &[offset]);
            pass.draw(0..3, 0..1);
        }
        Ok(())
    }
}

/// All of a resource.
fn whole(binding: u32, resource: Handle) -> BindingRecord {
    BindingRecord {
        binding,
        resource,
        ..Default::default()
    }
}

fn group(
    gpu: &Gpu,
    layout: &BindGroupLayout,
    entries: impl Iterator<Item = BindingRecord>,
) -> Result<BindGroup> {
    let entries: Vec<_> = entries.collect();
    gpu.bind_group_from(&abi::BindGroupDescriptor {
        label: "sums".into(),
        layout: layout.handle(),
        entries: entries.as_slice().into(),
    })
}

/// The view readies its buffers before it records; not reached.
fn missing() -> Error {
    Error::failed("the view's buffers were not made before recording")
}
