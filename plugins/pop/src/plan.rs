//! What a frame draws: the cuts of the trees, as draws in their order.

use crate::Pop;
use crate::camera::{culling_view, projection_of};
use crate::device_cut::LIST_HEAD;
use crate::part::Part;
use crate::part_cut::PartCut;
use crate::passes::Kind;
use crate::settings::{Method, Splats, Walk, Wanted};
use crate::took::Took;
use crate::uniforms::TreeUniform;
use pointstage_plugin_api::abi::DrawUniform;
use pointstage_plugin_api::{Draw, DrawFlags, Error, Frame, Result};
use pointstage_visibility::{BlockItem, Clips, DrawList, PixelRectangle, Source, has_int64};
use std::sync::Arc;

/// What is drawn of a part: primitives of one kind.
pub(crate) struct Planned {
    pub(crate) kind: Kind,
    /// How many; none if the device counts them.
    pub(crate) count: Option<u32>,
    /// Which part, and which draw of the frame.
    pub(crate) part: usize,
    pub(crate) draw_offset: u32,
    pub(crate) pixels: PixelRectangle,
    pub(crate) uniform: TreeUniform,
    /// If the CPU draws them: the object's draw.
    pub(crate) on_cpu: Option<DrawUniform>,
}

/// Plans a frame, part by part.
struct Planner<'a> {
    prepared: &'a Pop,
    frame: &'a Frame<'a>,
    wanted: &'a Wanted,
    source: Source,
    blocks: Vec<BlockItem>,
    /// The primitive before the next part's first.
    base: u32,
    planned: Vec<Planned>,
}

/// Cuts the trees; what to draw, in order.
///
/// # Errors
/// If there are too many primitives, or the device refuses a resource.
pub(crate) fn plan(
    prepared: &Pop,
    frame: &Frame<'_>,
    (wanted, source): (&Wanted, Source),
    cuts: &mut Vec<PartCut>,
    took: &mut Took,
) -> Result<Vec<Planned>> {
    cuts.resize_with(prepared.parts.len(), PartCut::default);
    let mut planner = Planner {
        prepared,
        frame,
        wanted,
        source,
        // Splats reach a little beyond the object's bounds.
        blocks: DrawList::of(
            frame,
            Some(2.0 * wanted.threshold_px + 1.0),
            &Clips::default(),
        )
        .blocks,
        base: 0,
        planned: Vec::new(),
    };
    for (number, (part, cut)) in prepared.parts.iter().zip(cuts).enumerate() {
        let of_part = |draw: &Draw<'_>| {
            draw.object()
                .is_some_and(|object| part.origin.is_of(object))
        };
        if let Some(draw) = frame.selection().find(of_part) {
            planner.plan_part((number, part), &draw, cut, took)?;
        }
    }
    Ok(planner.planned)
}

impl Planner<'_> {
    fn plan_part(
        &mut self,
        (number, part): (usize, &Arc<Part>),
        draw: &Draw<'_>,
        cut: &mut PartCut,
        took: &mut Took,
    ) -> Result<()> {
        let wanted = self.wanted;
        let mut uniform = TreeUniform::of(part, self.base);
        uniform.point_px = wanted.threshold_px;
        self.base = next_base(self.base, part)?;
        let two_sided = draw.flags().contains(DrawFlags::TWO_SIDED);
        let projection = projection_of(
            self.frame.uniform(),
            &draw.uniform().view_from_object,
            wanted,
        );
        let view = culling_view(&projection, part, wanted.culling, two_sided);
        uniform.stretch = view.stretch();
        let first = self.planned.len();
        match wanted.method {
            Method::Classic => {
                took.triangles += u64::from(part.triangle_count);
                self.add(
                    number,
                    draw,
                    Kind::AllTriangles,
                    Some(part.triangle_count),
                    uniform,
                );
            }
            Method::Points => {
                took.splats += u64::from(part.vertex_count);
                self.add(number, draw, Kind::Points, Some(part.vertex_count), uniform);
            }
            Method::Pop
                if cut.starts_on_device(&self.prepared.passes, part, &view, wanted.walk)? =>
            {
                let triangles_first = cut.look(took)?;
                let splats = listed(uniform, 0, LIST_HEAD);
                self.add(number, draw, Kind::Splats, None, splats);
                let triangles = TreeUniform {
                    // Backwards.
                    list_step: u32::MAX,
                    ..listed(uniform, 1, triangles_first)
                };
                self.add(number, draw, Kind::Triangles, None, triangles);
            }
            Method::Pop => {
                let threads = self.frame.thread_count();
                let made = cut.update(part, &view, wanted.keep, threads, took);
                let [splats, triangles] =
                    [&made.splats, &made.triangles].map(|list| list.len() as u32);
                let is_on_cpu = self.source == Source::Pixels && self.splats_on_cpu(splats);
                cut.lists_splats = !is_on_cpu;
                let uniforms = listed(uniform, 0, LIST_HEAD);
                self.add(number, draw, Kind::Splats, Some(splats), uniforms);
                if is_on_cpu {
                    for planned in &mut self.planned[first..] {
                        planned.on_cpu = Some(*draw.uniform());
                    }
                }
                let list_first = LIST_HEAD + if is_on_cpu { 0 } else { splats };
                let uniforms = listed(uniform, 1, list_first);
                self.add(number, draw, Kind::Triangles, Some(triangles), uniforms);
            }
        }
        Ok(())
    }

    fn add(
        &mut self,
        part: usize,
        draw: &Draw<'_>,
        kind: Kind,
        count: Option<u32>,
        uniform: TreeUniform,
    ) {
        if count == Some(0) {
            return;
        }
        let is_of_draw = |block: &&BlockItem| block.id_base == draw.uniform().id_base;
        let whole = PixelRectangle {
            origin: [0, 0],
            size: self.frame.size_px(),
        };
        let block = self.blocks.iter().find(is_of_draw);
        self.planned.push(Planned {
            kind,
            count,
            part,
            draw_offset: draw.uniform_offset(),
            pixels: block.map_or(whole, |block| block.pixels),
            uniform,
            on_cpu: None,
        });
    }

    /// Whether the CPU draws so many splats of a part.
    fn splats_on_cpu(&self, splats: u32) -> bool {
        let gpu = &self.prepared.passes.gpu;
        let is_software = gpu.is_software();
        let is_wanted = match self.wanted.splats {
            Splats::WhereFaster => is_software,
            Splats::OnCpu => true,
            Splats::OnDevice => false,
        };
        if self.wanted.is_blended() {
            // The sums of all trees are made in one place, so none of them may be cut on the device.
            let cuts_on_cpu = match self.wanted.walk {
                Walk::Auto => is_software,
                Walk::Cpu => true,
                Walk::Device => false,
            };
            return is_wanted && cuts_on_cpu;
        }
        // Without 64 bits at once the device's two kernels could not go on from what is there.
        let can = has_int64(gpu) && splats > 0;
        let [width, height] = self.frame.size_px().map(u64::from);
        let are_many = u64::from(splats) * PIXELS_A_SPLAT > width * height;
        can && is_wanted && (are_many || self.wanted.splats == Splats::OnCpu)
    }
}

/// Emptying, joining and uploading this many pixels takes the CPU as long as it saves on a splat.
const PIXELS_A_SPLAT: u64 = 16;

/// A uniform of what a list holds: where the number of its entries is, and the first one.
fn listed(uniform: TreeUniform, count_at: u32, list_first: u32) -> TreeUniform {
    TreeUniform {
        count_at,
        list_first,
        ..uniform
    }
}

/// The primitive before the first of the part after this one.
fn next_base(base: u32, part: &Part) -> Result<u32> {
    let primitives = [
        part.tree.nodes.len() as u64,
        u64::from(part.triangle_count),
        u64::from(part.vertex_count),
    ];
    let next = u64::from(base) + primitives.iter().sum::<u64>();
    u32::try_from(next).map_err(|_| {
        Error::failed("the meshes have more nodes, triangles and vertices than 32 bits count: hide some of them")
    })
}
