//! Footprints of blended splats, four at once: the twin of `shaders/hqss/splat.wesl`.

use super::Look;
use pointstage_plugin_api::clip::ClipLines;
use pointstage_plugin_api::glam::{BVec4A, Vec3, Vec4};
use pointstage_visibility::cpu::{
    Axes4, Ellipses4, Image, LANES, NearestBand, Reach, Rectangle, Stage, Surfels, Surfels4,
    Vec3x4, sqrt,
};

// The constants of the shader.
pub(super) const LEAST_RADIUS_PX: f32 = 0.5;
pub(super) const STEEPEST: f32 = 3.0;
pub(super) const WITHIN_PIXEL_PX: f32 = 0.7072;
pub(super) const RAMP_PX: f32 = 1.0;
const NOWHERE_PX: f32 = -1e6;

/// One splat, as a band's list keeps it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Splat {
    /// Over the pixels that it blends with; depth is its own.
    pub(super) image: Image,
    /// The pixels that the visibility pass looks at.
    visible: Rectangle,
    /// Up to this |uv|² the splat is seen.
    seen_squared: f32,
    /// For visibility: a factor on depth, and what is taken from it then.
    push: [f32; 2],
    /// The same for blending, which only backs are pushed for.
    pub(super) set_back: [f32; 2],
    /// The projected centre, px from the centre of the area's first pixel; far away if the filter has no part in this splat.
    pub(super) centre_px: [f32; 2],
    /// Peak of the filtered kernel, 0..1.
    pub(super) peak: f32,
    /// View space, scene units.
    pub(super) radius: f32,
    /// To light with; view space, unit.
    pub(super) normal: Vec3,
    /// Place of the draw in the stage, and in its block.
    pub(super) draw: u32,
    pub(super) number: u32,
    pub(super) id: u32,
}

/// How the splats of a stage are drawn.
#[derive(Debug)]
pub(super) struct Footprints<'a> {
    pub(super) stage: &'a Stage<'a>,
    pub(super) look: &'a Look,
    /// How far from the projected centre the filter reaches, px.
    reach_px: f32,
    /// What a scene unit away from the eye takes from depth, with parallel rays.
    depth_a_unit: Vec4,
}

/// What four footprints have beside their images.
struct Filtered4 {
    is_drawn: BVec4A,
    visible: [Rectangle; LANES],
    blended: [Rectangle; LANES],
    centre_px: [Vec4; 2],
    seen_squared: Vec4,
    peak: Vec4,
}

impl<'a> Footprints<'a> {
    pub(super) fn of(stage: &'a Stage<'a>, look: &'a Look) -> Self {
        let uniform = &look.uniform;
        let depth_at = |distance| stage.camera.depth_from_eye_distance(distance);
        Self {
            stage,
            look,
            reach_px: (uniform.filter_px * uniform.cutoff).max(WITHIN_PIXEL_PX),
            depth_a_unit: depth_at(Vec4::ZERO) - depth_at(Vec4::ONE),
        }
    }

    /// How far splats reach beyond the surfels' spheres.
    pub(super) fn reach(&self) -> Reach {
        let uniform = &self.look.uniform;
        Reach {
            scale: uniform.scale * uniform.cutoff,
            pad_px: if self.look.filters {
                self.reach_px
            } else {
                0.0
            },
        }
    }

    /// Computes the footprints of up to four surfels, draws what is visible of them into a band, and puts them on its list.
    #[inline]
    pub(super) fn draw_visible(
        &self,
        (draw, surfels): (usize, &Surfels<'_>),
        numbers: &[u32],
        band: &mut NearestBand<'_>,
        splats: &mut Vec<Splat>,
    ) {
        let (camera, uniform) = (&self.stage.camera, &self.look.uniform);
        let four = surfels.load(numbers);
        let backs = surfels.are_back_facing(&four);
        if self.look.culls_backs && backs.all() {
            return;
        }
        let axes = surfels.load_axes_view(&four, camera);
        let scaled = |factor: f32, axes: &Axes4| Axes4 {
            u: axes.u * Vec4::splat(factor),
            v: axes.v * Vec4::splat(factor),
        };
        let axes = scaled(uniform.scale, &axes);
        let longest = axes.u.length_squared().max(axes.v.length_squared());
        let radius = sqrt(longest);
        let mut ellipses =
            camera.project_ellipses(four.centre_view, &scaled(uniform.cutoff, &axes));
        let filtered = if self.look.filters {
            self.filter(&four, radius, &mut ellipses)
        } else {
            let areas = ellipses.areas();
            Filtered4 {
                is_drawn: ellipses.is_seen,
                visible: areas,
                blended: areas,
                centre_px: [Vec4::splat(NOWHERE_PX); 2],
                seen_squared: Vec4::ONE,
                peak: Vec4::ZERO,
            }
        };
        let hidden = if self.look.culls_backs {
            backs
        } else {
            BVec4A::FALSE
        };
        let drawn = (filtered.is_drawn & !hidden).bitmask();
        if drawn == 0 {
            return;
        }
        let to_eye = camera.towards_eye(four.centre_view);
        let deep = self.reach_of(&four, &axes, radius, to_eye);
        let back = Vec4::select(backs, Vec4::splat(uniform.push), Vec4::ZERO);
        let push = self.push_of(&four, deep, back + Vec4::splat(uniform.push));
        let set_back = self.push_of(&four, deep, back);
        let normal = self.lit_normal(surfels, &four, to_eye);
        let images = ellipses.images(filtered.blended);
        for (lane, (image, number)) in images.into_iter().zip(numbers).enumerate() {
            if drawn & 1 << lane == 0 || image.area.is_empty() {
                continue;
            }
            let centre = |axis: usize| {
                filtered.centre_px[axis][lane] - f32::from(image.area.first[axis]) - 0.5
            };
            let splat = Splat {
                image,
                visible: filtered.visible[lane],
                seen_squared: filtered.seen_squared[lane],
                // A little more, so that a splat does not hide itself where nothing is pushed.
                push: [push[0][lane] * (1.0 - 1e-6), push[1][lane]],
                set_back: [set_back[0][lane], set_back[1][lane]],
                centre_px: [centre(0), centre(1)],
                peak: filtered.peak[lane],
                radius: radius[lane],
                normal: normal.lane(lane),
                draw: draw as u32,
                number: *number,
                id: surfels.surfel_id(*number),
            };
            image.offer(
                splat.visible,
                splat.seen_squared,
                splat.push,
                self.lines_of(surfels, &splat).as_ref(),
                splat.id,
                band,
            );
            splats.push(splat);
        }
    }

    /// Where a splat is cut off, in units of its image's half-axes; none if nothing of its draw is.
    #[inline]
    pub(super) fn lines_of(&self, surfels: &Surfels<'_>, splat: &Splat) -> Option<ClipLines> {
        let uniform = &self.look.uniform;
        let lines = surfels.clip_lines(splat.number, uniform.scale * uniform.cutoff)?;
        let is_flat = splat.image.uv1_x == Vec3::ZERO && splat.image.uv1_y == Vec3::ZERO;
        Some(if is_flat { ClipLines::NONE } else { lines })
    }

    /// Widens images by the low-pass filter.
    #[inline]
    fn filter(&self, four: &Surfels4, radius: Vec4, ellipses: &mut Ellipses4) -> Filtered4 {
        let (camera, uniform) = (&self.stage.camera, &self.look.uniform);
        let clip = camera.clip_from_view(four.centre_view);
        // So that NaN fails too.
        let has_centre = clip.z.cmpgt(Vec4::ZERO) & clip.z.cmple(clip.w);
        let centre_px = camera.pixel_from_clip(&clip);
        let is_flat = !ellipses.is_seen & has_centre;
        if is_flat.any() {
            // Seen edge-on: only its centre's surroundings.
            let [zero, one] = [Vec4::ZERO, Vec4::ONE];
            let nothing = Vec3x4::new(zero, zero, zero);
            let beyond = Vec3x4::new(Vec4::splat(1e4), zero, one);
            ellipses.uv1_constant = Vec3x4::select(is_flat, beyond, ellipses.uv1_constant);
            for plane in [
                &mut ellipses.uv1_x,
                &mut ellipses.uv1_y,
                &mut ellipses.depth,
            ] {
                *plane = Vec3x4::select(is_flat, nothing, *plane);
            }
            for axis in [0, 1] {
                for place in [
                    &mut ellipses.origin_px[axis],
                    &mut ellipses.lower_px[axis],
                    &mut ellipses.upper_px[axis],
                ] {
                    *place = Vec4::select(is_flat, centre_px[axis], *place);
                }
            }
        }
        let radius_px = camera.pixels_per_unit_at(four.centre_view) * radius * uniform.cutoff;
        let inverse_radius = Vec4::ONE / radius_px;
        let least = inverse_radius * LEAST_RADIUS_PX;
        // Bounded, so that one without an area is never seen.
        let seen_squared = (least * least).clamp(Vec4::ONE, Vec4::splat(1e7));
        let seen_px = Vec4::select(
            least.cmpgt(Vec4::ONE),
            Vec4::splat(LEAST_RADIUS_PX),
            Vec4::ZERO,
        );
        let size = [camera.size_px.x, camera.size_px.y].map(Vec4::splat);
        let widened = |ellipses: &Ellipses4, by: Vec4| {
            let lower = |axis: usize| {
                let least = ellipses.lower_px[axis].min(centre_px[axis] - by);
                Vec4::select(has_centre, least.max(Vec4::ZERO), ellipses.lower_px[axis])
            };
            let upper = |axis: usize| {
                let greatest = ellipses.upper_px[axis].max(centre_px[axis] + by);
                Vec4::select(
                    has_centre,
                    greatest.min(size[axis]),
                    ellipses.upper_px[axis],
                )
            };
            Rectangle::within_four([lower(0), lower(1)], [upper(0), upper(1)])
        };
        let visible = widened(ellipses, seen_px);
        let ramp = Vec4::select(
            has_centre & ellipses.is_seen,
            Vec4::splat(0.5 * RAMP_PX),
            Vec4::ZERO,
        );
        for axis in [0, 1] {
            ellipses.lower_px[axis] -= ramp;
            ellipses.upper_px[axis] += ramp;
        }
        let reach = Vec4::splat(self.reach_px);
        let blended = widened(ellipses, reach);
        let peak = self.peak_of(ellipses, inverse_radius);

        // Within the filter's reach the depth changes by no more than the splat's radius.
        let depth = clip.z / clip.w;
        let farther = radius * uniform.cutoff - four.centre_view.z;
        let change = depth - camera.depth_from_eye_distance(farther);
        let plane = ellipses.depth;
        let slope = sqrt(plane.y * plane.y + plane.z * plane.z);
        let share = change / (slope * reach).max(Vec4::splat(1e-30));
        let share = share.min(Vec4::ONE);
        let [across, down] = [plane.y * share, plane.z * share];
        let [x, y] = [0, 1].map(|axis| ellipses.origin_px[axis] - centre_px[axis]);
        let limited = Vec3x4::new(depth + across * x + down * y, across, down);
        ellipses.depth = Vec3x4::select(has_centre, limited, plane);

        let nowhere = Vec4::splat(NOWHERE_PX);
        Filtered4 {
            is_drawn: ellipses.is_seen | has_centre,
            visible,
            blended,
            centre_px: centre_px.map(|centre| Vec4::select(has_centre, centre, nowhere)),
            seen_squared: Vec4::select(has_centre, seen_squared, Vec4::ONE),
            peak: Vec4::select(has_centre, peak, Vec4::ZERO),
        }
    }

    /// How high kernels are after the low-pass filter.
    #[inline]
    fn peak_of(&self, ellipses: &Ellipses4, inverse_radius: Vec4) -> Vec4 {
        let uniform = &self.look.uniform;
        let filter_squared = (uniform.filter_px * uniform.cutoff).powi(2);
        let scale = Vec4::ONE / ellipses.uv1_constant.z;
        let [x, y] = [ellipses.uv1_x * scale, ellipses.uv1_y * scale];
        let sum = (x.x * x.x + x.y * x.y + y.x * y.x + y.y * y.y) * filter_squared;
        let product = (x.x * y.y - x.y * y.x) * filter_squared;
        let facing = Vec4::ONE + inverse_radius * inverse_radius * filter_squared;
        let peak = facing / sqrt(Vec4::ONE + sum + product * product);
        peak.clamp(Vec4::ZERO, Vec4::ONE)
    }

    /// How deep splats reach for blending, scene units.
    #[inline]
    fn reach_of(&self, four: &Surfels4, axes: &Axes4, radius: Vec4, to_eye: Vec3x4) -> Vec4 {
        if !self.look.filters {
            return radius;
        }
        let normal = axes.u.cross(axes.v);
        let length = sqrt(normal.length_squared()).max(Vec4::splat(1e-30));
        let facing = normal.dot(to_eye).abs() / length;
        let away = sqrt((Vec4::ONE - facing * facing).max(Vec4::splat(1e-6)));
        let slope = away / facing.max(Vec4::splat(1e-3));
        let steep = slope.min(Vec4::splat(STEEPEST * STEEPEST) / slope);
        let pixels_per_unit = self.stage.camera.pixels_per_unit_at(four.centre_view);
        let blur =
            Vec4::splat(self.look.uniform.filter_px) / pixels_per_unit * steep.max(Vec4::ONE);
        sqrt(radius * radius + blur * blur)
    }

    /// Pushing by so many times `reach`: a factor on depth, and what is taken from it then.
    #[inline]
    fn push_of(&self, four: &Surfels4, reach: Vec4, lengths: Vec4) -> [Vec4; 2] {
        let length_pushed = lengths * reach;
        if self.stage.camera.is_orthographic {
            return [Vec4::ONE, self.depth_a_unit * length_pushed];
        }
        let distance = sqrt(four.centre_view.length_squared());
        [distance / (distance + length_pushed), Vec4::ZERO]
    }

    /// Normals to light with.
    #[inline]
    fn lit_normal(&self, surfels: &Surfels<'_>, four: &Surfels4, to_eye: Vec3x4) -> Vec3x4 {
        let normal = surfels.load_normal_view(four, &self.stage.camera);
        if !surfels.is_two_sided() && self.look.uniform.two_sided == 0 {
            return normal;
        }
        let faces_away = normal.dot(to_eye).cmplt(Vec4::ZERO);
        Vec3x4::select(faces_away, -normal, normal)
    }
}
