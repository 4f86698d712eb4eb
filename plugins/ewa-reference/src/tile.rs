//! One tile of samples: the front surface of each, blended, normalised and lit.
//!
//! 1. *Visibility*: the nearest pushed depth of each sample, and who has it.
//! 2. *Blending*: all splats whose own depth is not behind that depth are the front surface; their colours and normals add up by
//!    weight. This is the depth-sorted list of the paper's A-buffer, merged by its z-threshold, without the list: a surface
//!    ends where the next one begins, at the least of depth + epsilon·radius, whatever the order.
//! 3. *Shading*: the sums over the weight, lit once, or lit already when splats are lit one by one.
//!
//! Sums run over ordinals upwards, so a picture is the same to the last bit however many threads draw it.

use std::sync::atomic::{AtomicBool, Ordering};

use pointstage_plugin_api::FrameUniform;
use pointstage_plugin_api::glam::{DMat4, DVec2, DVec3, DVec4, Vec4Swizzles as _};
use pointstage_plugin_api::targets::kind;
use pointstage_plugin_api::twin::lighting::phong;

use crate::footprint::Footprint;
use crate::parts::{Attributes, Parts, Shape};
use crate::settings::Shows;
use crate::triangle::Triangle;

/// Shapes are kept from the first pass to the second, up to so many.
const KEPT_SHAPES: usize = 20_000;
/// Between two looks at whether to stop.
const SHAPES_PER_LOOK: usize = 1024;
/// So many samples beside its own tell how much of it is covered.
pub(crate) const COVERAGE_REACH: i32 = 2;
/// No primitive.
const NOBODY: u32 = u32::MAX;

/// A rectangle of samples; it may reach beyond the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Region {
    pub(crate) x: i32,
    pub(crate) y: i32,
    pub(crate) width: i32,
    pub(crate) height: i32,
}

/// What one sample shows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shaded {
    /// Linear, premultiplied by coverage.
    pub(crate) colour: DVec4,
    /// Reversed; 0 where nothing covers half of the sample.
    pub(crate) depth: f64,
    /// View space, unit; zero likewise.
    pub(crate) normal: DVec3,
    /// Of the front-most surfel, or of the triangle's nearest corner.
    pub(crate) id: u32,
    pub(crate) kind: u32,
    pub(crate) level: Option<u32>,
    pub(crate) weight: f64,
}

impl Shaded {
    /// Nothing.
    const NOTHING: Self = Self {
        colour: DVec4::ZERO,
        depth: 0.0,
        normal: DVec3::ZERO,
        id: 0,
        kind: kind::NOTHING,
        level: None,
        weight: 0.0,
    };
}

/// What draws tiles of a frame.
pub(crate) struct Renderer<'a> {
    pub(crate) parts: &'a Parts<'a>,
    pub(crate) uniform: &'a FrameUniform,
    pub(crate) view_from_clip: DMat4,
    pub(crate) shows: Shows,
    /// Splats are lit one by one, before they blend.
    pub(crate) lights_splats: bool,
}

#[derive(Clone, Copy)]
struct Seen {
    pushed: f64,
    depth: f64,
    ordinal: u32,
}

#[derive(Clone, Copy)]
struct Sums {
    colour: DVec3,
    normal: DVec3,
    weight: f64,
    coverage: f64,
    /// The splat with the greatest coverage, and its depth: it lights a sample that nobody covers half of.
    rim: u32,
    rim_depth: f64,
}

impl Region {
    fn count(self) -> usize {
        self.width as usize * self.height as usize
    }

    /// The same, larger by `margin` on all sides.
    pub(crate) fn grown(self, margin: i32) -> Self {
        Self {
            x: self.x - margin,
            y: self.y - margin,
            width: self.width + 2 * margin,
            height: self.height + 2 * margin,
        }
    }

    fn index(self, column: i32, row: i32) -> usize {
        ((row - self.y) * self.width + column - self.x) as usize
    }

    /// Calls `each` with index and centre of the samples within bounds.
    fn each_within(self, lower: DVec2, upper: DVec2, mut each: impl FnMut(usize, DVec2)) {
        let first = |lower: f64, least: i32| (lower - 0.5).ceil().max(f64::from(least)) as i32;
        let end = |upper: f64, most: i32| ((upper - 0.5).floor() + 1.0).min(f64::from(most)) as i32;
        for row in first(lower.y, self.y)..end(upper.y, self.y + self.height) {
            for column in first(lower.x, self.x)..end(upper.x, self.x + self.width) {
                let position = DVec2::new(f64::from(column), f64::from(row)) + 0.5;
                each(self.index(column, row), position);
            }
        }
    }
}

impl Renderer<'_> {
    /// The samples of `region`, row by row; none if `stop` was set meanwhile.
    ///
    /// * `list`: ordinals of all primitives that may reach the region or the samples round it, upwards.
    pub(crate) fn render(
        &self,
        region: Region,
        list: &[u32],
        stop: &AtomicBool,
    ) -> Option<Vec<Shaded>> {
        let around = region.grown(COVERAGE_REACH);
        let kept: Option<Vec<Option<Shape>>> = (list.len() <= KEPT_SHAPES).then(|| {
            list.iter()
                .map(|ordinal| self.parts.shape(*ordinal))
                .collect()
        });
        let each_shape = |each: &mut dyn FnMut(u32, &Shape)| {
            for (place, ordinal) in list.iter().enumerate() {
                if place % SHAPES_PER_LOOK == 0 && stop.load(Ordering::Relaxed) {
                    return None;
                }
                match &kept {
                    Some(kept) => kept[place].iter().for_each(|shape| each(*ordinal, shape)),
                    None => self
                        .parts
                        .shape(*ordinal)
                        .iter()
                        .for_each(|shape| each(*ordinal, shape)),
                }
            }
            Some(())
        };
        let nobody = Seen {
            pushed: 0.0,
            depth: 0.0,
            ordinal: NOBODY,
        };
        let mut seen = vec![nobody; around.count()];
        each_shape(&mut |ordinal, shape| match shape {
            Shape::Splat(footprint) => see_splat(&mut seen, around, ordinal, footprint),
            Shape::Triangle(triangle) => see_triangle(&mut seen, around, ordinal, triangle),
        })?;
        let nothing = Sums {
            colour: DVec3::ZERO,
            normal: DVec3::ZERO,
            weight: 0.0,
            coverage: 0.0,
            rim: NOBODY,
            rim_depth: 0.0,
        };
        let mut sums = vec![nothing; around.count()];
        each_shape(&mut |ordinal, shape| {
            if let Shape::Splat(footprint) = shape {
                self.blend(&mut sums, &seen, around, ordinal, footprint);
            }
        })?;
        let mut shaded = Vec::with_capacity(region.count());
        for row in region.y..region.y + region.height {
            for column in region.x..region.x + region.width {
                let position = DVec2::new(f64::from(column), f64::from(row)) + 0.5;
                let index = around.index(column, row);
                let sides = [(-1, 0), (1, 0), (0, -1), (0, 1)];
                let is_there =
                    |(x, y): &(i32, i32)| seen[around.index(column + x, row + y)].ordinal != NOBODY;
                let side_count = sides.iter().filter(|side| is_there(side)).count();
                shaded.push(self.shade(position, seen[index], &sums[index], side_count));
            }
        }
        Some(shaded)
    }

    fn blend(
        &self,
        sums: &mut [Sums],
        seen: &[Seen],
        around: Region,
        ordinal: u32,
        footprint: &Footprint,
    ) {
        let mut attributes = None;
        around.each_within(footprint.lower, footprint.upper, |index, position| {
            let in_front = |depth: &f64| footprint.settled(*depth) >= seen[index].pushed;
            let Some(depth) = footprint.depth(position).filter(in_front) else {
                return;
            };
            let Some(share) = footprint.share(position) else {
                return;
            };
            let attributes = attributes.get_or_insert_with(|| self.attributes(ordinal));
            let sum = &mut sums[index];
            sum.colour += share.weight * attributes.colour;
            sum.normal += share.weight * attributes.normal;
            sum.weight += share.weight;
            if sum.rim == NOBODY || share.coverage > sum.coverage {
                (sum.rim, sum.rim_depth) = (ordinal, depth);
            }
            sum.coverage = sum.coverage.max(share.coverage);
        });
    }

    fn shade(&self, position: DVec2, seen: Seen, sums: &Sums, sides: usize) -> Shaded {
        if seen.ordinal == NOBODY {
            if sums.weight <= 0.0 {
                return Shaded::NOTHING;
            }
            let colour = self.splat_colour(position, sums.rim_depth, sums.rim, sums);
            return Shaded {
                colour: colour.extend(1.0) * coverage_of(sums.coverage, sides),
                weight: sums.weight,
                ..Shaded::NOTHING
            };
        }
        let (part, _) = self.parts.find(seen.ordinal);
        let level = Some(part.surfels.level);
        if let Some(Shape::Triangle(triangle)) = self.triangle(seen.ordinal)
            && let Some(hit) = triangle.hit(position)
        {
            let point = self.point(position, seen.depth);
            let to_eye = self.parts.camera.towards_eye(point);
            let normal = self
                .parts
                .lit_side(&part.surfels, triangle.normal(&hit), to_eye);
            let colour = self.lit(part.surfels.material, triangle.colour(&hit), point, normal);
            return Shaded {
                colour: colour.extend(1.0),
                depth: seen.depth,
                normal,
                id: self.parts.id(seen.ordinal, hit.nearest_corner()),
                kind: kind::TRIANGLE,
                level,
                weight: 1.0,
            };
        }
        let colour = self.splat_colour(position, seen.depth, seen.ordinal, sums);
        Shaded {
            colour: colour.extend(1.0) * coverage_of(sums.coverage, sides),
            depth: seen.depth,
            normal: self.blended_normal(sums, self.point(position, seen.depth)),
            id: self.parts.id(seen.ordinal, 0),
            kind: kind::SURFEL,
            level,
            weight: sums.weight,
        }
    }

    /// What a splat blends: lit, if splats are lit one by one.
    fn attributes(&self, ordinal: u32) -> Attributes {
        let attributes = self.parts.attributes(ordinal);
        if !self.lights_splats {
            return attributes;
        }
        let (part, _) = self.parts.find(ordinal);
        let Attributes {
            colour,
            normal,
            centre,
        } = attributes;
        Attributes {
            colour: self.lit(part.surfels.material, colour, centre, normal),
            ..attributes
        }
    }

    fn triangle(&self, ordinal: u32) -> Option<Shape> {
        self.parts
            .is_triangle(ordinal)
            .then(|| self.parts.shape(ordinal))?
    }

    fn splat_colour(&self, position: DVec2, depth: f64, ordinal: u32, sums: &Sums) -> DVec3 {
        if self.lights_splats {
            return sums.colour / sums.weight;
        }
        let point = self.point(position, depth);
        let normal = self.blended_normal(sums, point);
        let (part, _) = self.parts.find(ordinal);
        self.lit(
            part.surfels.material,
            sums.colour / sums.weight,
            point,
            normal,
        )
    }

    fn blended_normal(&self, sums: &Sums, point: DVec3) -> DVec3 {
        let mean = sums.normal / sums.weight;
        // Opposite normals cancel out.
        if mean.length_squared() > 1e-12 {
            mean.normalize()
        } else {
            self.parts.camera.towards_eye(point)
        }
    }

    fn lit(&self, material: [f32; 4], colour: DVec3, point: DVec3, normal: DVec3) -> DVec3 {
        match self.shows {
            Shows::Result => phong(self.uniform, material, colour, point, normal),
            Shows::Colours => colour,
            Shows::Normals => 0.5 * normal + 0.5,
        }
    }

    /// The point that a sample sees at a depth; view space.
    fn point(&self, position: DVec2, depth: f64) -> DVec3 {
        let ndc = self.parts.camera.ndc_from_pixel(position);
        let point = self.view_from_clip * ndc.extend(depth).extend(1.0);
        point.xyz() / point.w
    }
}

fn see_splat(seen: &mut [Seen], around: Region, ordinal: u32, footprint: &Footprint) {
    around.each_within(footprint.lower, footprint.upper, |index, position| {
        if !footprint.covers(position) {
            return;
        }
        let Some(depth) = footprint.depth(position) else {
            return;
        };
        let pushed = footprint.pushed(depth);
        if pushed > seen[index].pushed || seen[index].ordinal == NOBODY {
            seen[index] = Seen {
                pushed,
                depth,
                ordinal,
            };
        }
    });
}

fn see_triangle(seen: &mut [Seen], around: Region, ordinal: u32, triangle: &Triangle) {
    around.each_within(triangle.lower, triangle.upper, |index, position| {
        if let Some(hit) = triangle.hit(position)
            && hit.depth > seen[index].pushed
        {
            seen[index] = Seen {
                pushed: hit.depth,
                depth: hit.depth,
                ordinal,
            };
        }
    });
}

/// How much of a sample the surface covers: the formula of `hqss`.
///
/// * `greatest`: coverage by one splat.
/// * `sides`: on how many of its four sides a surface is.
fn coverage_of(greatest: f64, sides: usize) -> f64 {
    if greatest >= 1.0 || sides == 4 {
        1.0
    } else if greatest < 0.5 {
        greatest
    } else {
        greatest.max(0.5 + 0.125 * sides as f64)
    }
}
