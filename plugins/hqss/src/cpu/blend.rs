//! What a splat gives its pixels: the twin of `share_of` in `shaders/hqss/splat.wesl`, and of the additions in
//! `attributes_compute.wesl`.

use super::footprint::{Footprints, RAMP_PX, Splat, WITHIN_PIXEL_PX};
use pointstage_plugin_api::FrameUniform;
use pointstage_plugin_api::clip::ClipLines;
use pointstage_plugin_api::glam::{Vec3, Vec4, Vec4Swizzles as _};
use pointstage_plugin_api::twin::lighting::phong;
use pointstage_visibility::cpu::{
    LANES, Sum, Surfels, clip_distance, clip_keeps, depth_of, exp_near_zero, id_of, sqrt,
};
use std::sync::LazyLock;

/// What lit colours are blended as a share of, as in the shader.
pub(super) const BRIGHTEST: f32 = 4.0;

/// No splat weighs less where it has a part, as in the shader.
pub(super) const LEAST_WEIGHT: f32 = 0.004;

/// What a splat blends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Attributes {
    /// Linear, and 1.
    colour: Vec4,
    /// View space, and 0.
    normal: Vec4,
    /// Logarithm of the filtered kernel's peak.
    log_peak: f32,
    /// Where it is cut off, if it may be.
    lines: Option<ClipLines>,
}

/// Shares of four pixels.
#[derive(Clone, Copy)]
struct Shares {
    weight: Vec4,
    coverage: Vec4,
}

impl Attributes {
    fn of(splat: &Splat, footprints: &Footprints<'_>) -> Self {
        let surfels = footprints.stage.draws.get(splat.draw as usize);
        let colour = surfels.map_or(Vec4::ONE, |surfels| {
            match surfels.packed_colour(splat.number) {
                Some(packed) => linear(packed),
                None => Vec4::from_array(surfels.uniform().default_colour),
            }
        });
        let colour = match (&footprints.look.lights, surfels) {
            (Some(lights), Some(surfels)) => lit(colour, splat, surfels, lights),
            _ => colour,
        };
        let colour = colour.clamp(Vec4::ZERO, Vec4::ONE);
        Self {
            colour: colour.with_w(1.0),
            normal: splat.normal.extend(0.0),
            log_peak: ln(splat.peak),
            lines: surfels.and_then(|surfels| footprints.lines_of(surfels, splat)),
        }
    }
}

/// The colour, lit, as a share of [`BRIGHTEST`].
fn lit(colour: Vec4, splat: &Splat, surfels: &Surfels<'_>, lights: &FrameUniform) -> Vec4 {
    let centre = surfels.load(&[splat.number]).centre_view.lane(0);
    let [centre, normal, colour] = [centre, splat.normal, colour.xyz()].map(Vec3::as_dvec3);
    let light = phong(lights, surfels.uniform().material, colour, centre, normal);
    (light.as_vec3() / BRIGHTEST).extend(1.0)
}

/// Adds a splat's shares to the pixels of a row, from the area's first column on, where it is not behind the visible surface.
///
/// * `attributes`: the splat's, once they are known.
/// * `fronts`: where `place` goes if the splat is the visible one.
#[inline]
pub(super) fn blend(
    footprints: &Footprints<'_>,
    (splat, attributes): (&Splat, &mut Option<Attributes>),
    row: u32,
    nearest: &[u64],
    sums: &mut [Sum],
    (fronts, place): (&mut [u32], u32),
) {
    let depth = splat.image.depth_in_row(row);
    let [factor, less] = splat.set_back.map(Vec4::splat);
    let groups = nearest
        .chunks(LANES)
        .zip(sums.chunks_mut(LANES))
        .zip(fronts.chunks_mut(LANES));
    let mut across = 0.0;
    for ((nearest, sums), fronts) in groups {
        let own_depth = depth.at(across);
        let depth = own_depth * factor - less;
        let visible = if let [first, second, third, fourth] = *nearest {
            [first, second, third, fourth]
        } else {
            // What is no pixel of the row gets no number for its depth, which nothing is nearer than.
            let mut four = [u64::from(u32::MAX >> 1) << 32; LANES];
            for (pixel, known) in four.iter_mut().zip(nearest) {
                *pixel = *known;
            }
            four
        };
        let is_seen = depth.cmpge(Vec4::from_array(visible.map(depth_of)))
            & depth.cmpgt(Vec4::ZERO)
            & own_depth.cmple(Vec4::ONE);
        let seen = is_seen.bitmask();
        if seen != 0 {
            let attributes = attributes.get_or_insert_with(|| Attributes::of(splat, footprints));
            let shares = if footprints.look.filters {
                filtered_shares(footprints, splat, attributes.log_peak, row, across)
            } else {
                plain_shares(footprints, splat, row, across)
            };
            let shares = match &attributes.lines {
                None => shares,
                Some(lines) => {
                    clipped_shares(shares, lines, splat, footprints.look.filters, row, across)
                }
            };
            let [weights, coverages] =
                [shares.weight, shares.coverage].map(|lanes| lanes.to_array());
            let pixels = sums.iter_mut().zip(fronts).zip(visible);
            for (lane, ((sum, front), visible)) in pixels.enumerate() {
                if seen & 1 << lane == 0 {
                    continue;
                }
                if id_of(visible) == splat.id {
                    *front = place;
                }
                if weights[lane] > 0.0 {
                    sum.add(
                        weights[lane],
                        coverages[lane],
                        attributes.colour,
                        attributes.normal,
                    );
                }
            }
        }
        across += LANES as f32;
    }
}

/// Shares of four pixels of a row with the low-pass filter, `across` columns from the area's first.
#[inline]
fn filtered_shares(
    footprints: &Footprints<'_>,
    splat: &Splat,
    log_peak: f32,
    row: u32,
    across: f32,
) -> Shares {
    let uniform = &footprints.look.uniform;
    let image = &splat.image;
    let [u, v, one] = image.uv1_in_row(row).map(|plane| plane.at(across));
    let is_ahead = one.cmpgt(Vec4::ZERO);
    let inverse = Vec4::ONE / one;
    let [u, v] = [u * inverse, v * inverse];
    let squared = u * u + v * v;
    let radius = sqrt(squared);
    // Of the distance to the disk's edge, positive inside, the gradient times the distance.
    let along = |change: Vec3| {
        let one = Vec4::splat(change.z);
        (u * (Vec4::splat(change.x) - u * one) + v * (Vec4::splat(change.y) - v * one)) * inverse
    };
    let [x, y] = [along(image.uv1_x), along(image.uv1_y)];
    let gradient = sqrt(x * x + y * y).max(Vec4::splat(1e-20));
    let within = (Vec4::ONE - radius) * radius / gradient;
    let within = Vec4::select(radius.cmpeq(Vec4::ZERO), Vec4::splat(RAMP_PX), within);
    let within = Vec4::select(is_ahead, within, Vec4::NEG_ONE);
    let coverage = (within * (1.0 / RAMP_PX) + Vec4::splat(0.5)).clamp(Vec4::ZERO, Vec4::ONE);

    let down = row as f32 - f32::from(image.area.first[1]) - splat.centre_px[1];
    let right = Vec4::new(0.0, 1.0, 2.0, 3.0) + Vec4::splat(across - splat.centre_px[0]);
    let to_centre_squared = right * right + Vec4::splat(down * down);
    let falloff = uniform.falloff;
    let in_plane = squared * (-falloff * uniform.cutoff * uniform.cutoff);
    let in_plane = Vec4::select(is_ahead, in_plane, Vec4::splat(-1e8));
    let on_screen = to_centre_squared * (-falloff / (uniform.filter_px * uniform.filter_px));
    let filtered = on_screen + Vec4::splat(log_peak);
    // The greater of two Gaussians is that of the greater exponent.
    let weight = exp_near_zero(in_plane.max(filtered)).max(Vec4::splat(LEAST_WEIGHT));
    let is_near = to_centre_squared.cmple(Vec4::splat(WITHIN_PIXEL_PX * WITHIN_PIXEL_PX));
    let has_part = coverage.cmpgt(Vec4::ZERO) | is_near;
    Shares {
        weight: Vec4::select(has_part, weight, Vec4::ZERO),
        coverage,
    }
}

/// What clip lines leave of four shares: none beyond them, and with the filter half where they go through a pixel's centre.
#[inline]
fn clipped_shares(
    shares: Shares,
    lines: &ClipLines,
    splat: &Splat,
    filters: bool,
    row: u32,
    across: f32,
) -> Shares {
    let image = &splat.image;
    let uv1 = image.uv1_in_row(row).map(|plane| plane.at(across));
    let Shares { weight, coverage } = shares;
    if !filters {
        return Shares {
            weight: Vec4::select(clip_keeps(lines, uv1), weight, Vec4::ZERO),
            coverage,
        };
    }
    let distance = clip_distance(lines, uv1, image.uv1_x, image.uv1_y);
    let left = (distance * (1.0 / RAMP_PX) + Vec4::splat(0.5)).clamp(Vec4::ZERO, Vec4::ONE);
    let left = Vec4::select(uv1[2].cmpgt(Vec4::ZERO), left, Vec4::ZERO);
    let has_part = weight.cmpgt(Vec4::ZERO) & left.cmpgt(Vec4::ZERO);
    let part = (weight * left).max(Vec4::splat(LEAST_WEIGHT));
    Shares {
        weight: Vec4::select(has_part, part, Vec4::ZERO),
        coverage: coverage.min(left),
    }
}

/// Shares of four pixels of a row without a filter.
#[inline]
fn plain_shares(footprints: &Footprints<'_>, splat: &Splat, row: u32, across: f32) -> Shares {
    let uniform = &footprints.look.uniform;
    let [u, v, one] = splat.image.uv1_in_row(row).map(|plane| plane.at(across));
    let [u, v] = [u / one, v / one];
    let squared = u * u + v * v;
    let is_covered = one.cmpgt(Vec4::ZERO) & squared.cmple(Vec4::ONE);
    let exponent = squared * (-uniform.falloff * uniform.cutoff * uniform.cutoff);
    // Here weights may be as small as they like.
    let weight = Vec4::from_array(exponent.to_array().map(f32::exp));
    Shares {
        weight: Vec4::select(is_covered, weight, Vec4::ZERO),
        coverage: Vec4::ONE,
    }
}

/// The natural logarithm of a number that is not negative, exact to a millionth; far below -80 of 0.
#[inline]
fn ln(x: f32) -> f32 {
    // x = m·2^e with m within sqrt(2) of 1, whose logarithm is 2·artanh((m - 1) / (m + 1)).
    const ROOT_HALF: u32 = 0x3f35_04f3;
    let bits = x.to_bits().wrapping_sub(ROOT_HALF) as i32;
    let exponent = bits >> 23;
    let m = f32::from_bits(x.to_bits().wrapping_sub((exponent << 23) as u32));
    let s = (m - 1.0) / (m + 1.0);
    let square = s * s;
    let series = 1.0 + square * (1.0 / 3.0 + square * (0.2 + square * (1.0 / 7.0)));
    exponent as f32 * core::f32::consts::LN_2 + 2.0 * s * series
}

/// Linear colour and alpha of a packed one.
fn linear(packed: u32) -> Vec4 {
    /// Linear from sRGB, of each byte.
    static LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| {
        core::array::from_fn(|byte| {
            let encoded = byte as f64 / 255.0;
            let linear = if encoded <= 0.04045 {
                encoded / 12.92
            } else {
                ((encoded + 0.055) / 1.055).powf(2.4)
            };
            linear as f32
        })
    });
    let [red, green, blue, alpha] = packed.to_le_bytes();
    let linear = |byte: u8| LINEAR[usize::from(byte)];
    Vec4::new(
        linear(red),
        linear(green),
        linear(blue),
        f32::from(alpha) / 255.0,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_logarithm_is_exact_to_a_millionth() {
        for step in 1..=10_000 {
            let x = (step as f32 / 10_000.0).powi(3);
            let error = f64::from(ln(x)) - f64::from(x).ln();
            assert!(error.abs() < 2e-6, "{error} at {x}");
        }
        assert!(ln(0.0) < -80.0);
    }
}
