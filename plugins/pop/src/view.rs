//! One viewport: the last cut, lists, buffers of the picture's size; and the frame.

use crate::Pop;
use crate::blending::binds_enough;
use crate::cpu_pixels::{Kind as SplatKind, Pixels as SplatPixels};
use crate::cpu_splats::{Look as SplatLook, SPLAT_COLOUR, Stage as SplatStage};
use crate::layers::Layers;
use crate::part_cut::PartCut;
use crate::passes::{BLENDED, Kind, Passes};
use crate::plan::{Planned, plan};
use crate::record::{Count, Draw, record_shading};
use crate::settings::{Wanted, wanted_of};
use crate::took::{Took, report};
use crate::uniforms::STRIDE;
use crate::visible::{Visible, buffer_bytes};
use pointstage_plugin_api::abi::BufferUsage;
use pointstage_plugin_api::gpu::{Buffer, Recorder};
use pointstage_plugin_api::{Error, Frame, Host, Outcome, Result, statistics};
use pointstage_visibility::{Path, Source, Targets};

/// The renderer in one viewport.
pub struct PopView {
    host: Host,
    cuts: Vec<PartCut>,
    /// Uniforms of all trees.
    uniforms: Option<(u64, Buffer)>,
    visible: Option<Visible>,
    /// Splats that the CPU draws.
    splats: SplatPixels,
    warned: bool,
}

impl PopView {
    /// # Errors
    /// None so far.
    #[expect(
        clippy::unnecessary_wraps,
        reason = "the renderer's trait has a result"
    )]
    pub(crate) fn new(host: &Host, prepared: &Pop) -> Result<Self> {
        let mut cuts = Vec::new();
        cuts.resize_with(prepared.parts.len(), PartCut::default);
        Ok(Self {
            host: host.clone(),
            cuts,
            uniforms: None,
            visible: None,
            splats: SplatPixels::default(),
            warned: false,
        })
    }

    /// Draws a frame into the targets that were asked for.
    pub(crate) fn draw(&mut self, prepared: &Pop, frame: &mut Frame<'_>) -> Result<Outcome> {
        let wanted = wanted_of(frame.settings())?;
        let targets = Targets::of(frame);
        let mut took = Took::default();
        let source = self.source_of(&prepared.passes, frame.size_px(), &wanted);
        let planned = plan(
            prepared,
            frame,
            (&wanted, source),
            &mut self.cuts,
            &mut took,
        )?;
        if !targets.all().is_empty() && !planned.is_empty() {
            self.record(prepared, frame, (&wanted, source), &targets, &planned)?;
        }
        report(frame, prepared, &took);
        Ok(Outcome::Done)
    }

    /// Records what is planned.
    fn record(
        &mut self,
        prepared: &Pop,
        frame: &mut Frame<'_>,
        (wanted, source): (&Wanted, Source),
        targets: &Targets,
        planned: &[Planned],
    ) -> Result<()> {
        let passes = &*prepared.passes;
        let uniform_buffer = self.write_uniforms(passes, planned)?;
        for cut in &mut self.cuts {
            cut.ready_list(passes, &uniform_buffer)?;
        }
        self.ready_visible(passes, frame.size_px(), source, wanted.is_blended())?;
        let has_splats = self.draw_on_cpu(prepared, frame, wanted, planned);
        let missing = || Error::failed("the view's buffers were not made before recording");
        let mut recorder = Recorder::new();
        let group = frame.group();
        for (uniform, draw) in (0..).zip(planned) {
            if draw.kind == Kind::Splats && draw.count.is_none() {
                let place = (group, draw.draw_offset, uniform);
                self.cuts[draw.part].record_selection(passes, &mut recorder, place)?;
            }
        }
        let (Some(visible), cuts) = (&self.visible, &self.cuts) else {
            return Err(missing());
        };
        let draws = (0..)
            .zip(planned)
            .map(|(uniform, draw)| {
                let is_drawn = draw.on_cpu.is_some();
                let cut = &cuts[draw.part];
                let is_triangles = draw.kind.is_triangles();
                let count = match (draw.count, &cut.device) {
                    (Some(count), _) => Count::Known(count),
                    (None, Some(device)) => Count::OnDevice {
                        arguments: &device.arguments,
                        dispatch: if is_triangles { 12 } else { 0 },
                        draw: if is_triangles { 40 } else { 24 },
                    },
                    (None, None) => return Err(missing()),
                };
                Ok(Draw {
                    kind: draw.kind,
                    part: draw.part,
                    is_drawn,
                    count,
                    uniform,
                    frame_offset: draw.draw_offset,
                    tree: &prepared.parts[draw.part].group,
                    list: &cut.list.as_ref().ok_or_else(missing)?.group,
                    pixels: draw.pixels,
                })
            })
            .collect::<Result<Vec<_>>>()?;
        let layers = Layers {
            passes,
            frame: group,
            wanted,
            draws: &draws,
            on_cpu: has_splats.then_some(&self.splats),
        };
        let shading = layers.record(&mut recorder, visible)?;
        let set = targets.all();
        let draws_any = |kinds: &[Kind]| planned.iter().any(|draw| kinds.contains(&draw.kind));
        let mut look = Vec::new();
        look.extend(draws_any(&[Kind::Splats]).then_some("nodes"));
        look.extend(draws_any(&[Kind::Triangles, Kind::AllTriangles]).then_some("triangles"));
        look.extend(draws_any(&[Kind::Points]).then_some("points"));
        look.extend(wanted.is_gouraud.then_some("gouraud"));
        look.extend(wanted.has_pop_colours.then_some("pop_colours"));
        look.extend(wanted.is_blended().then_some(BLENDED));
        let pipeline = passes.shading(source, set, &look)?;
        record_shading(
            &mut recorder,
            group,
            &draws,
            shading,
            (targets, set),
            &pipeline,
        );
        frame.submit(recorder);
        let path = match source {
            Source::Pixels if has_splats => Path::Cpu,
            Source::Pixels => Path::Compute,
            Source::Ids => Path::Raster,
        };
        frame.report(statistics::PATH, path.number());
        Ok(())
    }

    /// Writes the uniforms of the draws; the buffer with them.
    fn write_uniforms(&mut self, passes: &Passes, planned: &[Planned]) -> Result<Buffer> {
        let mut words = vec![0_u32; planned.len() * STRIDE as usize / 4];
        for (draw, place) in planned
            .iter()
            .zip(words.chunks_exact_mut(STRIDE as usize / 4))
        {
            let bytes: &[u32] = bytemuck::cast_slice(core::slice::from_ref(&draw.uniform));
            place[..bytes.len()].copy_from_slice(bytes);
        }
        let bytes = 4 * words.len() as u64;
        let buffer = match &self.uniforms {
            Some((capacity, buffer)) if *capacity >= bytes => buffer.clone(),
            _ => {
                let capacity = bytes.next_power_of_two();
                let buffer = passes.gpu.buffer(
                    "trees",
                    capacity,
                    BufferUsage::UNIFORM | BufferUsage::COPY_DST,
                )?;
                self.uniforms = Some((capacity, buffer.clone()));
                buffer
            }
        };
        passes.gpu.write(&buffer, 0, &words)?;
        Ok(buffer)
    }

    /// Draws what the CPU is to draw; whether there is any.
    fn draw_on_cpu(
        &mut self,
        prepared: &Pop,
        frame: &Frame<'_>,
        wanted: &Wanted,
        planned: &[Planned],
    ) -> bool {
        let colour = wanted.has_pop_colours.then_some(SPLAT_COLOUR);
        let stages: Vec<_> = planned
            .iter()
            .filter_map(|planned| {
                let draw = planned.on_cpu.as_ref()?;
                let look = SplatLook::new(draw, colour);
                let tree = &prepared.parts[planned.part].tree;
                let numbers = (planned.uniform.stretch, planned.uniform.base);
                let stage = SplatStage::new(tree, frame.uniform(), draw, numbers, look);
                Some((stage, &self.cuts[planned.part].cut.splats[..]))
            })
            .collect();
        if stages.is_empty() {
            return false;
        }
        let kind = SplatKind {
            is_disk: wanted.is_disk(),
            is_blended: wanted.is_blended(),
        };
        let threads = frame.thread_count();
        self.splats.draw(&stages, kind, frame.size_px(), threads);
        true
    }

    /// Whether visible primitives go to a buffer, by compute, or to textures, by raster.
    fn source_of(&mut self, passes: &Passes, size_px: [u32; 2], wanted: &Wanted) -> Source {
        let gpu = &passes.gpu;
        let limit = gpu
            .limit("max_storage_buffer_binding_size")
            .unwrap_or(128 << 20);
        let by_compute = match wanted.path {
            Path::Raster => false,
            Path::Compute | Path::Cpu => true,
            Path::Auto => gpu.is_software(),
        };
        let obstacle = if buffer_bytes(size_px, wanted.is_blended()) > limit {
            "the picture has more pixels than a storage buffer of this device holds"
        } else if wanted.is_blended() && !binds_enough(gpu) {
            "the device binds too few storage buffers to blend by compute"
        } else if by_compute {
            return Source::Pixels;
        } else {
            return Source::Ids;
        };
        if wanted.path == Path::Compute && !self.warned {
            self.warned = true;
            self.host.performance_warning(&format!(
                "drawn by the raster path, not by compute: {obstacle}"
            ));
        }
        Source::Ids
    }

    /// Buffers or textures of the picture's size.
    fn ready_visible(
        &mut self,
        passes: &Passes,
        size_px: [u32; 2],
        source: Source,
        is_blended: bool,
    ) -> Result<()> {
        let fits = |visible: &Visible| visible.fits(size_px, source, is_blended);
        if !self.visible.as_ref().is_some_and(fits) {
            // What is too large or too small goes before the new one comes.
            self.visible = None;
            self.visible = Some(match source {
                Source::Pixels => Visible::buffers(passes, size_px, is_blended)?,
                Source::Ids => Visible::textures(passes, size_px, is_blended)?,
            });
        }
        Ok(())
    }
}
