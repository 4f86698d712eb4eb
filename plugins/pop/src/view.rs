//! One viewport: the last cut, lists, buffers of the picture's size; and the frame.

use crate::Pop;
use crate::camera::{culling_view, projection_of};
use crate::cpu_splats::{Pixels as SplatPixels, Stage as SplatStage};
use crate::device_cut::LIST_HEAD;
use crate::part_cut::PartCut;
use crate::passes::{Kind, Passes};
use crate::record::{Count, Draw, Pixels, record_kernels, record_raster, record_shading};
use crate::settings::{Method, Splats, Wanted, wanted_of};
use crate::took::{Took, report};
use crate::uniforms::{STRIDE, TreeUniform};
use crate::visible::{Visible, pixel_bytes};
use pointstage_plugin_api::abi::BufferUsage;
use pointstage_plugin_api::gpu::{Buffer, ColourAttachment, DepthAttachment, Recorder};
use pointstage_plugin_api::{DrawFlags, Error, Frame, Host, Outcome, Result, statistics};
use pointstage_visibility::{
    DrawList, Path, PixelRectangle, Source, Targets, group_size, has_int64,
};

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

/// What is drawn of a part.
struct Planned {
    kind: Kind,
    /// How many; none if the device counts them.
    count: Option<u32>,
    /// Which part, and which draw of the frame.
    part: usize,
    draw_offset: u32,
    pixels: PixelRectangle,
    /// If the CPU draws them: view space from object space.
    on_cpu: Option<[[f32; 4]; 4]>,
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
        let source = self.source_of(&prepared.passes, frame.size_px(), wanted.path);
        let (planned, uniforms) = self.plan(prepared, frame, (&wanted, source), &mut took)?;
        if !targets.all().is_empty() && !planned.is_empty() {
            self.record(
                prepared,
                frame,
                (&wanted, source),
                &targets,
                (&planned, &uniforms),
            )?;
        }
        report(frame, prepared, &took);
        Ok(Outcome::Done)
    }

    /// Cuts the trees; what to draw, and the uniforms of the draws in their order.
    fn plan(
        &mut self,
        prepared: &Pop,
        frame: &Frame<'_>,
        (wanted, source): (&Wanted, Source),
        took: &mut Took,
    ) -> Result<(Vec<Planned>, Vec<TreeUniform>)> {
        // Splats reach a little beyond the object's bounds.
        let blocks = DrawList::of(frame, Some(2.0 * wanted.threshold_px + 1.0)).blocks;
        let (mut planned, mut uniforms) = (Vec::new(), Vec::new());
        let mut base = 0_u32;
        self.cuts
            .resize_with(prepared.parts.len(), PartCut::default);
        for (number, part) in prepared.parts.iter().enumerate() {
            let of_part = |draw: &pointstage_plugin_api::Draw<'_>| {
                draw.object()
                    .is_some_and(|object| part.origin.is_of(object))
            };
            let Some(draw) = frame.selection().find(of_part) else {
                continue;
            };
            let pixels = blocks
                .iter()
                .find(|block| block.id_base == draw.uniform().id_base)
                .map_or(
                    PixelRectangle {
                        origin: [0, 0],
                        size: frame.size_px(),
                    },
                    |block| block.pixels,
                );
            let mut uniform = TreeUniform::of(part, base);
            uniform.point_px = wanted.threshold_px;
            let primitives = [
                part.tree.nodes.len() as u64,
                u64::from(part.triangle_count),
                u64::from(part.vertex_count),
            ];
            let next = u64::from(base) + primitives.iter().sum::<u64>();
            base = u32::try_from(next).map_err(|_| {
                Error::failed("the meshes have more nodes, triangles and vertices than 32 bits count: hide some of them")
            })?;
            let two_sided = draw.flags().contains(DrawFlags::TWO_SIDED);
            let projection =
                projection_of(frame.uniform(), &draw.uniform().view_from_object, wanted);
            let view = culling_view(&projection, part, wanted.culling, two_sided);
            uniform.stretch = view.stretch();
            let draw_matrix = draw.uniform().view_from_object;
            let mut add = |kind, count: Option<u32>, uniform| {
                if count != Some(0) {
                    let draw_offset = draw.uniform_offset();
                    planned.push(Planned {
                        kind,
                        count,
                        part: number,
                        draw_offset,
                        pixels,
                        on_cpu: None,
                    });
                    uniforms.push(uniform);
                }
            };
            match wanted.method {
                Method::Classic => {
                    took.triangles += u64::from(part.triangle_count);
                    add(Kind::AllTriangles, Some(part.triangle_count), uniform);
                }
                Method::Points => {
                    took.splats += u64::from(part.vertex_count);
                    add(Kind::Points, Some(part.vertex_count), uniform);
                }
                Method::Pop => {
                    let cut = &mut self.cuts[number];
                    if cut.starts_on_device(&prepared.passes, part, &view, wanted.walk)? {
                        let triangles_first = cut.look(took)?;
                        let list_first = LIST_HEAD;
                        add(
                            Kind::Splats,
                            None,
                            TreeUniform {
                                count_at: 0,
                                list_first,
                                ..uniform
                            },
                        );
                        let (list_first, list_step) = (triangles_first, u32::MAX);
                        add(
                            Kind::Triangles,
                            None,
                            TreeUniform {
                                count_at: 1,
                                list_first,
                                list_step,
                                ..uniform
                            },
                        );
                        continue;
                    }
                    let threads = frame.thread_count();
                    let cut = cut.update(part, &view, wanted.keep, threads, took);
                    let (splats, triangles) = (cut.splats.len() as u32, cut.triangles.len() as u32);
                    let is_on_cpu = source == Source::Pixels
                        && splats_on_cpu(&prepared.passes, wanted, splats, frame.size_px());
                    let list_first = LIST_HEAD;
                    add(
                        Kind::Splats,
                        Some(splats),
                        TreeUniform {
                            count_at: 0,
                            list_first,
                            ..uniform
                        },
                    );
                    let list_first = LIST_HEAD + if is_on_cpu { 0 } else { splats };
                    add(
                        Kind::Triangles,
                        Some(triangles),
                        TreeUniform {
                            count_at: 1,
                            list_first,
                            ..uniform
                        },
                    );
                    self.cuts[number].lists_splats = !is_on_cpu;
                    if is_on_cpu {
                        let drawn = planned.iter_mut().filter(|draw| draw.part == number);
                        for draw in drawn.filter(|draw| draw.kind == Kind::Splats) {
                            draw.on_cpu = Some(draw_matrix);
                        }
                    }
                }
            }
        }
        Ok((planned, uniforms))
    }

    /// Records what is planned.
    fn record(
        &mut self,
        prepared: &Pop,
        frame: &mut Frame<'_>,
        (wanted, source): (&Wanted, Source),
        targets: &Targets,
        (planned, uniforms): (&[Planned], &[TreeUniform]),
    ) -> Result<()> {
        let passes = &*prepared.passes;
        let uniform_buffer = self.write_uniforms(passes, uniforms)?;
        for cut in &mut self.cuts {
            cut.ready_list(passes, &uniform_buffer)?;
        }
        self.ready_visible(passes, frame.size_px(), source)?;
        let has_splats = self.draw_on_cpu(prepared, frame, wanted, (planned, uniforms));
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
        let shading = match visible {
            Visible::Buffers {
                pixels,
                large,
                arguments,
                group: pixel_group,
                shading,
                ..
            } => {
                if has_splats {
                    passes.gpu.write(pixels, 0, self.splats.nearest())?;
                } else {
                    recorder.clear_buffer(pixels);
                }
                let bound = Pixels {
                    group: pixel_group,
                    large,
                    arguments,
                };
                for &kernel in passes.kernel_order() {
                    for draw in draws.iter().filter(|draw| !draw.is_drawn) {
                        let kernels = passes.compute(draw.kind, wanted.is_disk, kernel)?;
                        record_kernels(
                            &mut recorder,
                            group,
                            draw,
                            &kernels,
                            group_size(&passes.gpu),
                            &bound,
                        );
                    }
                }
                shading
            }
            Visible::Textures {
                primitives,
                depth,
                shading,
                ..
            } => {
                let colours = [Some(ColourAttachment::clear(primitives, [0.0; 4]))];
                let mut pass = recorder.render_pass(
                    "primitives",
                    &colours,
                    Some(DepthAttachment::clear(depth)),
                );
                for draw in &draws {
                    let pipeline = passes.raster(draw.kind, wanted.is_disk)?;
                    record_raster(&mut pass, group, draw, &pipeline);
                }
                drop(pass);
                shading
            }
        };
        let set = targets.all();
        let draws_any = |kinds: &[Kind]| planned.iter().any(|draw| kinds.contains(&draw.kind));
        let mut look = Vec::new();
        look.extend(draws_any(&[Kind::Splats]).then_some("nodes"));
        look.extend(draws_any(&[Kind::Triangles, Kind::AllTriangles]).then_some("triangles"));
        look.extend(draws_any(&[Kind::Points]).then_some("points"));
        look.extend(wanted.is_gouraud.then_some("gouraud"));
        look.extend(wanted.has_pop_colours.then_some("pop_colours"));
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
        frame.report(
            statistics::PATH,
            f64::from(u8::from(source == Source::Pixels)),
        );
        Ok(())
    }

    /// Writes the uniforms of the draws; the buffer with them.
    fn write_uniforms(&mut self, passes: &Passes, uniforms: &[TreeUniform]) -> Result<Buffer> {
        let mut words = vec![0_u32; uniforms.len() * STRIDE as usize / 4];
        for (uniform, place) in uniforms
            .iter()
            .zip(words.chunks_exact_mut(STRIDE as usize / 4))
        {
            let bytes: &[u32] = bytemuck::cast_slice(core::slice::from_ref(uniform));
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
        (planned, uniforms): (&[Planned], &[TreeUniform]),
    ) -> bool {
        let mut has_any = false;
        for (draw, uniform) in planned.iter().zip(uniforms) {
            let Some(view_from_object) = &draw.on_cpu else {
                continue;
            };
            if !has_any {
                self.splats.clear(frame.size_px());
                has_any = true;
            }
            let stage = SplatStage::new(
                &prepared.parts[draw.part].tree,
                frame.uniform(),
                view_from_object,
                (uniform.stretch, uniform.base, wanted.is_disk),
            );
            let splats = &self.cuts[draw.part].cut.splats;
            self.splats.draw(&stage, splats, frame.thread_count());
        }
        has_any
    }

    /// Whether visible primitives go to a buffer, by compute, or to textures, by raster.
    fn source_of(&mut self, passes: &Passes, size_px: [u32; 2], path: Path) -> Source {
        let gpu = &passes.gpu;
        let limit = gpu
            .limit("max_storage_buffer_binding_size")
            .unwrap_or(128 << 20);
        let wanted = match path {
            Path::Raster => false,
            Path::Compute => true,
            Path::Auto => gpu.is_software(),
        };
        if wanted && pixel_bytes(size_px) <= limit {
            return Source::Pixels;
        }
        if path == Path::Compute && !self.warned {
            self.warned = true;
            self.host.performance_warning(
                "drawn by the raster path, not by compute: the picture has more pixels than a storage buffer of this device holds",
            );
        }
        Source::Ids
    }

    /// Buffers or textures of the picture's size.
    fn ready_visible(&mut self, passes: &Passes, size_px: [u32; 2], source: Source) -> Result<()> {
        let by_compute = source == Source::Pixels;
        let fits = match &self.visible {
            Some(Visible::Buffers { size_px: its, .. }) => by_compute && *its == size_px,
            Some(Visible::Textures { size_px: its, .. }) => !by_compute && *its == size_px,
            None => false,
        };
        if !fits {
            // What is too large or too small goes before the new one comes.
            self.visible = None;
            self.visible = Some(if by_compute {
                Visible::buffers(passes, size_px)?
            } else {
                Visible::textures(passes, size_px)?
            });
        }
        Ok(())
    }
}

/// Emptying, joining and uploading this many pixels takes the CPU as long as it saves on a splat.
const PIXELS_A_SPLAT: u64 = 16;

/// Whether the CPU draws this many splats.
fn splats_on_cpu(passes: &Passes, wanted: &Wanted, splats: u32, size_px: [u32; 2]) -> bool {
    // Without 64 bits at once the device's two kernels could not go on from what is there.
    let can = has_int64(&passes.gpu) && splats > 0;
    let pixels = u64::from(size_px[0]) * u64::from(size_px[1]);
    let is_faster = passes.gpu.is_software() && u64::from(splats) * PIXELS_A_SPLAT > pixels;
    match wanted.splats {
        Splats::WhereFaster => can && is_faster,
        Splats::OnCpu => can,
        Splats::OnDevice => false,
    }
}
