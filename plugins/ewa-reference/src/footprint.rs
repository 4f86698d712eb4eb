//! The footprint of one splat, with the true EWA resampling filter.
//!
//! The reconstruction kernel is a Gaussian over the splat's plane. Its contour at the cutoff projects to an ellipse, exactly
//! (Zwicker et al. 2004, section 4): the screen's Gaussian is the one with that contour, so it is right at the cutoff whatever
//! the perspective. The low-pass is a second Gaussian of the screen; convolution adds their covariances, and keeps the
//! volume under the kernel, so its peak falls by the square root of the determinants' ratio (Zwicker et al. 2001, equation
//! 9):
//!
//! ```text
//! V = S (sigma/cutoff)²      V' = V + (sigma filter_radius)² I
//! weight(d) = sqrt(|V| / |V'|) exp(-½ dᵀ V'⁻¹ d)      where dᵀ V'⁻¹ d <= (cutoff/sigma)²
//! ```
//!
//! with S the projected contour (dᵀ S⁻¹ d = 1) and d the offset from its centre. A splat that the near plane cuts has no
//! ellipse; it is large, and its kernel is evaluated in its own plane. Without the filter all are.
//!
//! Coverage and visibility follow `hqss` to the letter, in f64: half where the disk's edge goes through the sample, a ramp of one
//! sample across it; splats smaller than a sample are seen as if they were as large; the back of a surface lies behind its place,
//! so that it neither hides a front nor blends with one.
//!
//! Lengths on the screen are in samples: pixels, if there is one sample in each.

use pointstage_plugin_api::clip::ClipLines;
use pointstage_plugin_api::glam::{DMat2, DVec2, DVec3, Vec3Swizzles as _};
use pointstage_plugin_api::twin::camera::Camera;
use pointstage_plugin_api::twin::clip::{clip_distance, clip_keeps};
use pointstage_plugin_api::twin::ellipse::{Axes, ProjectedEllipse, project_ellipse};

/// With the filter a splat is seen as if its radius were at least this.
const LEAST_RADIUS: f64 = 0.5;
/// No place of a square of one is farther from its centre.
const WITHIN_SAMPLE: f64 = 0.7072;
/// Coverage falls from 1 to 0 over this distance.
const RAMP: f64 = 1.0;

/// The kernel of all splats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Kernel {
    /// Factor on the half-axes.
    pub(crate) scale: f64,
    /// Standard deviation of the reconstruction kernel, radii.
    pub(crate) sigma: f64,
    /// Where the reconstruction kernel ends, radii.
    pub(crate) cutoff: f64,
    /// How far behind the nearest splat others belong to its surface, radii.
    pub(crate) push: f64,
    /// The low-pass filter's deviation is `sigma` times this, samples; none without it.
    pub(crate) filter_radius: Option<f64>,
}

/// What a splat gives a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Share {
    /// Above 0.
    pub(crate) weight: f64,
    /// 0..1.
    pub(crate) coverage: f64,
}

/// The Gaussian on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Resampling {
    centre: DVec2,
    /// V'⁻¹.
    inverse: DMat2,
    /// sqrt(|V| / |V'|).
    peak: f64,
}

/// One splat's footprint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Footprint {
    /// Least sample position that it may reach.
    pub(crate) lower: DVec2,
    /// Greatest sample position that it may reach.
    pub(crate) upper: DVec2,
    /// Where the coefficients below count from.
    origin: DVec2,
    /// (u, v, 1) / w at the origin, and its change along x and y; the disk's edge is at |uv| = 1.
    uv1: [DVec3; 3],
    /// Depth, likewise.
    depth: DVec3,
    /// What depth cannot leave, least and greatest.
    depth_limits: [f64; 2],
    /// Pushed depth is depth times the first and less the second.
    push: [f64; 2],
    faces_away: bool,
    has_filter: bool,
    /// |uv|² up to which the splat is seen.
    seen_squared: f64,
    /// The projected centre, if the filter reaches round it.
    centre: Option<DVec2>,
    resampling: Option<Resampling>,
    /// (cutoff / sigma)².
    reach_squared: f64,
    /// Where it is cut off, in units of the disk that ends at the cutoff.
    lines: Option<ClipLines>,
}

/// Reversed depth at a distance from the eye's plane.
fn depth_at_distance(camera: &Camera, distance: f64) -> f64 {
    let z_and_w = camera.clip_from_view.w_axis - camera.clip_from_view.z_axis * distance;
    z_and_w.z / z_and_w.w
}

/// The ellipse where u² + v² = w², for (u, v, w) = a + b x + c y: centre and shape matrix S. None if it is no ellipse.
fn ellipse_of([constant, x, y]: [DVec3; 3]) -> Option<(DVec2, DMat2)> {
    let form = |a: DVec3, b: DVec3| a.x * b.x + a.y * b.y - a.z * b.z;
    let (xx, xy, yy) = (form(x, x), form(x, y), form(y, y));
    let linear = DVec2::new(form(constant, x), form(constant, y));
    let quadratic = DMat2::from_cols(DVec2::new(xx, xy), DVec2::new(xy, yy));
    let is_ellipse = xx > 0.0 && quadratic.determinant() > 0.0;
    if !is_ellipse {
        return None;
    }
    let inverse = quadratic.inverse();
    let centre = -(inverse * linear);
    let level = -(form(constant, constant) + linear.dot(centre));
    (level > 0.0 && centre.is_finite()).then(|| (centre, inverse * level))
}

impl Footprint {
    /// The footprint of the splat with these half-axes (factors included, at one radius) round `centre_view`; none if
    /// nothing of it can be seen or an input is not finite.
    ///
    /// * `faces_away`: whether it shows its back, of a surface that has one.
    pub(crate) fn new(
        camera: &Camera,
        kernel: &Kernel,
        centre_view: DVec3,
        axes: Axes,
        faces_away: bool,
    ) -> Option<Self> {
        let radius = axes.u.length().max(axes.v.length());
        let sample = 1.0 / camera.pixels_per_unit_at(centre_view);
        let reach = kernel.filter_radius.map_or(radius, |filter| {
            radius.hypot(filter * sample * slope_of(camera, centre_view, axes))
        });
        let least = kernel
            .filter_radius
            .map_or(0.0, |_| LEAST_RADIUS * sample / (radius * kernel.cutoff));
        let at_cutoff = Axes {
            u: axes.u * kernel.cutoff,
            v: axes.v * kernel.cutoff,
        };
        let image = project_ellipse(camera, centre_view, at_cutoff)?;
        let clip = camera.clip_from_view(centre_view);
        let is_centre_seen = clip.z > 0.0 && clip.z <= clip.w;
        let has_filter = kernel.filter_radius.is_some();
        let centre = is_centre_seen.then(|| camera.pixel_from_clip(clip));
        let origin = centre.unwrap_or(0.5 * (image.lower_px + image.upper_px));
        let uv1 = coefficients(&image, origin);
        let depth_of = |offset| image.ellipse_depth(origin + offset);
        let depth = DVec3::new(
            depth_of(DVec2::ZERO),
            depth_of(DVec2::X) - depth_of(DVec2::ZERO),
            depth_of(DVec2::Y) - depth_of(DVec2::ZERO),
        );
        let mut footprint = Self {
            lower: image.lower_px,
            upper: image.upper_px,
            origin,
            uv1,
            depth,
            depth_limits: depth_limits(camera, -centre_view.z, radius * kernel.cutoff),
            push: push_of(camera, centre_view, kernel.push * reach),
            faces_away,
            has_filter,
            seen_squared: least.max(1.0).powi(2),
            centre: centre.filter(|_| has_filter),
            resampling: None,
            reach_squared: (kernel.cutoff / kernel.sigma).powi(2),
            lines: None,
        };
        if let Some(filter_radius) = kernel.filter_radius {
            footprint.filter(kernel.sigma * filter_radius);
        }
        let bounds = [footprint.lower, footprint.upper];
        bounds
            .iter()
            .all(|bound| bound.is_finite())
            .then_some(footprint)
    }

    /// The same, cut off at lines in units of the disk that ends at the cutoff.
    pub(crate) fn cut_off(self, lines: ClipLines) -> Self {
        Self {
            lines: Some(lines),
            ..self
        }
    }

    /// Convolves with the low-pass of this deviation and enlarges the bounds.
    fn filter(&mut self, deviation: f64) {
        self.lower -= DVec2::splat(0.5 * RAMP);
        self.upper += DVec2::splat(0.5 * RAMP);
        if let Some(centre) = self.centre {
            let reach = DVec2::splat(WITHIN_SAMPLE);
            self.enlarge(centre, reach);
        }
        let Some((offset, shape)) = ellipse_of(self.uv1) else {
            return;
        };
        let variance = shape * (1.0 / self.reach_squared);
        let sum = variance + DMat2::from_diagonal(DVec2::splat(deviation * deviation));
        let centre = self.origin + offset;
        let reach = DVec2::new(sum.x_axis.x, sum.y_axis.y) * self.reach_squared;
        let reach = DVec2::new(reach.x.sqrt(), reach.y.sqrt());
        self.enlarge(centre, reach);
        self.resampling = Some(Resampling {
            centre,
            inverse: sum.inverse(),
            peak: (variance.determinant() / sum.determinant()).max(0.0).sqrt(),
        });
    }

    fn enlarge(&mut self, centre: DVec2, reach: DVec2) {
        self.lower = self.lower.min(centre - reach);
        self.upper = self.upper.max(centre + reach);
    }

    /// Depth of the splat at a sample position, if it is visible there.
    pub(crate) fn depth(&self, position: DVec2) -> Option<f64> {
        let offset = position - self.origin;
        let depth = self.depth.x + self.depth.y * offset.x + self.depth.z * offset.y;
        let [least, greatest] = self.depth_limits;
        let depth = if self.has_filter {
            depth.max(least).min(greatest)
        } else {
            depth
        };
        (depth > 0.0 && depth <= 1.0).then_some(depth)
    }

    /// What is held against the pushed depth of the nearest splat, from [`Footprint::depth`].
    pub(crate) fn settled(&self, depth: f64) -> f64 {
        if self.faces_away {
            self.push(depth)
        } else {
            depth
        }
    }

    /// What the visibility pass compares, from [`Footprint::depth`].
    pub(crate) fn pushed(&self, depth: f64) -> f64 {
        self.push(self.settled(depth))
    }

    fn push(&self, depth: f64) -> f64 {
        depth * self.push[0] - self.push[1]
    }

    fn uv1(&self, position: DVec2) -> DVec3 {
        let offset = position - self.origin;
        self.uv1[0] + offset.x * self.uv1[1] + offset.y * self.uv1[2]
    }

    /// Whether the splat covers at least half of the sample, or lies in it.
    pub(crate) fn covers(&self, position: DVec2) -> bool {
        let uv1 = self.uv1(position);
        let is_left = self.lines.is_none_or(|lines| clip_keeps(&lines, uv1));
        is_left && uv1.z > 0.0 && uv1.xy().length_squared() <= self.seen_squared * uv1.z * uv1.z
    }

    /// What the splat gives the sample; none if it has no part in it.
    pub(crate) fn share(&self, position: DVec2) -> Option<Share> {
        let share = self.whole_share(position)?;
        let Some(lines) = &self.lines else {
            return Some(share);
        };
        let uv1 = self.uv1(position);
        if !self.has_filter {
            return clip_keeps(lines, uv1).then_some(share);
        }
        // The ramp across the line, as across the disk's edge.
        let distance = clip_distance(lines, [uv1, self.uv1[1], self.uv1[2]]);
        let left = (0.5 + distance / RAMP).clamp(0.0, 1.0);
        (left > 0.0).then(|| Share {
            weight: (share.weight * left).max(1e-300),
            coverage: share.coverage.min(left),
        })
    }

    /// The same as if no line cut it off.
    fn whole_share(&self, position: DVec2) -> Option<Share> {
        let uv1 = self.uv1(position);
        let is_ahead = uv1.z > 0.0;
        let uv = uv1.xy() / uv1.z;
        let squared = if is_ahead { uv.length_squared() } else { 1e8 };
        let in_plane = |squared: f64| (-0.5 * self.reach_squared * squared).exp();
        if !self.has_filter {
            return (squared <= 1.0).then(|| Share {
                weight: in_plane(squared),
                coverage: 1.0,
            });
        }
        let coverage = if is_ahead {
            self.coverage(uv1.z, uv, squared)
        } else {
            0.0
        };
        let is_near = self
            .centre
            .is_some_and(|centre| centre.distance(position) <= WITHIN_SAMPLE);
        let (weight, is_within) = match &self.resampling {
            None => (in_plane(squared.min(4.0)), false),
            Some(gaussian) => {
                let offset = position - gaussian.centre;
                let squared: f64 = offset.dot(gaussian.inverse * offset);
                (
                    gaussian.peak * (-0.5 * squared).exp(),
                    squared <= self.reach_squared,
                )
            }
        };
        // What covers a sample alone must have a weight, however thin it is.
        (coverage > 0.0 || is_near || is_within).then(|| Share {
            weight: weight.max(1e-300),
            coverage,
        })
    }

    /// The ramp across the disk's edge, from the first-order distance to it.
    fn coverage(&self, w: f64, uv: DVec2, squared: f64) -> f64 {
        let along = |change: DVec3| uv.dot((change.xy() - uv * change.z) / w);
        // The gradient of the distance, times the distance.
        let gradient = DVec2::new(along(self.uv1[1]), along(self.uv1[2])).length();
        let radius = squared.sqrt();
        let within = if radius == 0.0 {
            RAMP
        } else {
            (1.0 - radius) * radius / gradient.max(1e-300)
        };
        (0.5 + within / RAMP).clamp(0.0, 1.0)
    }
}

/// How far the surface falls back within a length across the view, as a factor: as in `hqss` at least 1, and beyond a slope of 3
/// less and less, since there, at a silhouette, others would shine through.
fn slope_of(camera: &Camera, centre_view: DVec3, axes: Axes) -> f64 {
    let normal = axes.u.cross(axes.v).normalize_or_zero();
    let facing = normal.dot(camera.towards_eye(centre_view)).abs();
    let slope = (1.0 - facing * facing).max(1e-6).sqrt() / facing.max(1e-3);
    slope.min(9.0 / slope).max(1.0)
}

fn coefficients(image: &ProjectedEllipse, origin: DVec2) -> [DVec3; 3] {
    let constant = image.ellipse_uv1(origin);
    [
        constant,
        image.ellipse_uv1(origin + DVec2::X) - constant,
        image.ellipse_uv1(origin + DVec2::Y) - constant,
    ]
}

/// Depths of the farthest and the nearest point that a splat can have.
fn depth_limits(camera: &Camera, distance: f64, reach: f64) -> [f64; 2] {
    let nearest = distance - reach;
    let greatest = if nearest > 0.0 || camera.is_orthographic {
        depth_at_distance(camera, nearest)
    } else {
        f64::INFINITY
    };
    [depth_at_distance(camera, distance + reach), greatest]
}

/// Factor and difference from depth to pushed depth, for a splat that is pushed by `length` along the viewing rays.
fn push_of(camera: &Camera, centre_view: DVec3, length: f64) -> [f64; 2] {
    // A little more, so that a splat does not hide itself where nothing is pushed.
    let little = 1.0 - 1e-9;
    if camera.is_orthographic {
        let slope = depth_at_distance(camera, 0.0) - depth_at_distance(camera, 1.0);
        return [little, slope * length];
    }
    let distance = centre_view.length();
    [little * distance / (distance + length), 0.0]
}

#[cfg(test)]
#[path = "footprint_tests.rs"]
mod tests;
