//! Splats drawn by the CPU: visibility and attributes of the whole picture, up to what shading needs.
//!
//! A thread takes a band of rows, and does all of it while it is in the core's own cache:
//!
//! 1. footprints of the band's surfels, four at once, into a list, and their pushed depths into the band's pixels
//!    ([`footprint`], the twin of `footprint_of`);
//! 2. weights of the splats on the list that are not behind the visible surface, into sums ([`blend`], the twin of `share_of`);
//! 3. means of the sums, and depth and radius of the front splat ([`resolve`], the twin of what the shading pass does for the
//!    other paths before it lights a pixel).
//!
//! Coverage follows when all bands are drawn, since it looks at the pixels beside.

mod blend;
mod footprint;
mod resolve;

use self::blend::{Attributes, blend};
use self::footprint::{Footprints, Splat};
use self::resolve::{cover, resolve};
use crate::settings::SplatUniform;
use pointstage_plugin_api::FrameUniform;
use pointstage_visibility::cpu::{
    BAND_ROWS, Bins, LANES, Nearest, NearestBand, Rectangle, Stage, Sums, share_out,
};

/// What a pixel shows, as `blended_shading.wesl` reads it with the feature `resolved`.
#[derive(Debug, Default)]
pub(crate) struct Picture {
    /// The nearest splats, pushed.
    pub(crate) nearest: Nearest,
    /// Linear colour and coverage.
    pub(crate) colours: Vec<[f32; 4]>,
    /// Packed normal (view space), bits of the depth, of the weight and of the front splat's radius.
    pub(crate) surfaces: Vec<[u32; 4]>,
    bins: Bins,
    benches: Vec<Bench>,
}

/// Surfels that are held against the picture so far at a time.
const SHARE: usize = 64;

/// What a thread works with.
#[derive(Debug, Default)]
struct Bench {
    /// Surfels that what is drawn does not hide.
    left: Vec<u32>,
    splats: Vec<Splat>,
    sums: Sums,
    /// The front splat of each pixel of the band: its place in the list and one, 0 for none.
    fronts: Vec<u32>,
    reached: Rectangle,
}

/// How splats are drawn.
#[derive(Clone, Debug)]
pub(crate) struct Look {
    pub(crate) uniform: SplatUniform,
    pub(crate) culls_backs: bool,
    pub(crate) filters: bool,
    /// Whether pixels are lit with the front splat's normal.
    pub(crate) is_flat: bool,
    /// The frame's, if splats are lit before they blend.
    pub(crate) lights: Option<FrameUniform>,
}

/// What a thread draws: rows of the picture.
struct Band<'a> {
    nearest: NearestBand<'a>,
    colours: &'a mut [[f32; 4]],
    surfaces: &'a mut [[u32; 4]],
}

impl Picture {
    /// Draws a stage's surfels, on so many threads; the pixels that they can reach.
    pub(crate) fn draw(
        &mut self,
        stage: &Stage<'_>,
        look: &Look,
        size_px: [u32; 2],
        thread_count: usize,
    ) -> Rectangle {
        let Self {
            nearest,
            colours,
            surfaces,
            bins,
            benches,
        } = self;
        let footprints = Footprints::of(stage, look);
        bins.fill(stage, footprints.reach(), thread_count);
        nearest.resize(size_px);
        let [width, height] = size_px.map(|side| side as usize);
        colours.resize(width * height, [0.0; 4]);
        surfaces.resize(width * height, [0; 4]);
        benches.resize_with(thread_count.max(1), Bench::default);
        for bench in benches.iter_mut() {
            bench.reached = Rectangle::default();
        }
        let band_pixels = (width * BAND_ROWS as usize).max(1);
        let bands = nearest
            .bands()
            .zip(colours.chunks_mut(band_pixels))
            .zip(surfaces.chunks_mut(band_pixels))
            .map(|((nearest, colours), surfaces)| Band {
                nearest,
                colours,
                surfaces,
            });
        share_out(bands, benches, |bench, mut band| {
            bench.draw(bins, &footprints, &mut band, size_px[0]);
        });
        let reached = benches
            .iter()
            .map(|bench| bench.reached)
            .fold(Rectangle::default(), Rectangle::joined);
        let rows = colours
            .chunks_mut(width.max(1))
            .zip(surfaces.chunks(width.max(1)))
            .zip(0_u32..)
            .skip(reached.first[1].into())
            .take(reached.rows_within(&(0..size_px[1])).len());
        let nearest = &*nearest;
        share_out(rows, benches, |_, ((colours, surfaces), row)| {
            cover(colours, surfaces, row, reached.columns(), nearest);
        });
        reached
    }
}

impl Bench {
    /// Draws a band from its surfels to what its pixels show.
    fn draw(&mut self, bins: &Bins, footprints: &Footprints<'_>, band: &mut Band<'_>, width: u32) {
        band.nearest.clear();
        band.colours.fill([0.0; 4]);
        band.surfaces.fill([0; 4]);
        self.splats.clear();
        for (draw, candidates) in bins.of_band(band.nearest.number) {
            let Some(surfels) = footprints.stage.draws.get(draw) else {
                continue;
            };
            for candidates in candidates.chunks(SHARE) {
                band.nearest.leave_out_hidden(candidates, &mut self.left);
                for numbers in self.left.chunks(LANES) {
                    let place = (draw, surfels);
                    footprints.draw_visible(place, numbers, &mut band.nearest, &mut self.splats);
                }
            }
        }
        if self.splats.is_empty() {
            return;
        }
        let rows = band.nearest.rows.clone();
        self.fronts.clear();
        self.fronts.resize(rows.len() * width as usize, 0);
        self.sums.start(rows.clone(), width);
        let mut reached = Rectangle::default();
        for (splat, place) in self.splats.iter().zip(1..) {
            reached = reached.joined(splat.image.area);
            let mut attributes: Option<Attributes> = None;
            for row in splat.image.area.rows_within(&rows) {
                let columns = splat.image.area.columns();
                let start = (row - rows.start) as usize * width as usize;
                let fronts = self.fronts.get_mut(start..start + width as usize);
                let fronts = fronts.and_then(|fronts| {
                    fronts.get_mut(columns.start as usize..columns.end as usize)
                });
                let (Some(nearest), Some(sums), Some(fronts)) = (
                    band.nearest.pixels(row, columns.clone()),
                    self.sums.in_row(row, columns),
                    fronts,
                ) else {
                    break;
                };
                blend(
                    footprints,
                    (splat, &mut attributes),
                    row,
                    nearest,
                    sums,
                    (fronts, place),
                );
            }
        }
        self.reached = self.reached.joined(reached);
        for row in reached.rows_within(&rows) {
            let first = u32::from(reached.first[0]) as usize;
            let start = (row - rows.start) as usize * width as usize + first;
            let columns = reached.columns();
            let places = start..start + columns.len();
            let (Some(sums), Some(fronts), Some(colours), Some(surfaces)) = (
                self.sums.in_row(row, columns.clone()),
                self.fronts.get(places.clone()),
                band.colours.get_mut(places.clone()),
                band.surfaces.get_mut(places),
            ) else {
                break;
            };
            for (offset, (sum, front)) in sums.iter().zip(fronts).enumerate() {
                if sum.colour.w <= 0.0 && *front == 0 {
                    continue;
                }
                let front = (*front as usize)
                    .checked_sub(1)
                    .and_then(|front| self.splats.get(front));
                let column = columns.start + offset as u32;
                let (colour, surface) = resolve(sum, front, [column, row], footprints);
                colours[offset] = colour;
                surfaces[offset] = surface;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{blend, footprint};
    use crate::passes::{ATTRIBUTES, SPLAT};
    use crate::shader_tests::shader_checks::assert_constants;

    #[test]
    fn constants_are_those_of_the_shaders() {
        let least_radius_px = f64::from(footprint::LEAST_RADIUS_PX);
        let within_pixel_px = f64::from(footprint::WITHIN_PIXEL_PX);
        assert_constants(
            SPLAT.source,
            &[
                ("LEAST_RADIUS_PX", least_radius_px),
                ("STEEPEST", f64::from(footprint::STEEPEST)),
                ("WITHIN_PIXEL_PX", within_pixel_px),
                ("RAMP_PX", f64::from(footprint::RAMP_PX)),
                ("LEAST_WEIGHT", f64::from(blend::LEAST_WEIGHT)),
            ],
        );
        let brightest = f64::from(blend::BRIGHTEST);
        assert_constants(ATTRIBUTES.source, &[("BRIGHTEST", brightest)]);
    }
}
