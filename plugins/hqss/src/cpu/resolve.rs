//! From sums to what shading needs: the twin of the first half of `shaders/hqss/blended_shading.wesl`.

use super::footprint::{Footprints, Splat};
use core::ops::Range;
use pointstage_plugin_api::columns::{NO_NORMAL, encode_normal};
use pointstage_plugin_api::glam::{Vec3, Vec4Swizzles as _};
use pointstage_visibility::cpu::{Nearest, Sum};

/// Colour and greatest coverage of a pixel, and its surface: packed normal, bits of depth, weight and radius; depth and radius are 0
/// without a front splat.
#[inline]
pub(super) fn resolve(
    sum: &Sum,
    front: Option<&Splat>,
    [column, row]: [u32; 2],
    footprints: &Footprints<'_>,
) -> ([f32; 4], [u32; 4]) {
    let weight = sum.colour.w;
    let colour = sum.colour.xyz() / weight.max(1e-20);
    let mut normal = sum.normal.xyz();
    let (mut depth, mut radius) = (0.0, 0.0);
    if let Some(splat) = front {
        let across = column as f32 - f32::from(splat.image.area.first[0]);
        depth = splat.image.depth_in_row(row).at(across).x;
        radius = splat.radius;
        if footprints.look.is_flat {
            normal = splat.normal;
        }
    }
    (
        colour.extend(sum.normal.w).to_array(),
        [
            packed_normal(normal),
            depth.to_bits(),
            weight.to_bits(),
            radius.to_bits(),
        ],
    )
}

/// A sum of normals, packed; where it has no length, as one that is not known.
fn packed_normal(normal: Vec3) -> u32 {
    if normal.length_squared() > 1e-12 {
        encode_normal(normal)
    } else {
        NO_NORMAL
    }
}

/// Turns the greatest coverage of each pixel of a row into how much of it the surface covers: the twin of `coverage_of`.
pub(super) fn cover(
    colours: &mut [[f32; 4]],
    surfaces: &[[u32; 4]],
    row: u32,
    columns: Range<u32>,
    nearest: &Nearest,
) {
    let [width, height] = nearest.size_px();
    let shows = |column: u32, row: u32| nearest.id_at(column, row) != 0;
    let pixels = colours.iter_mut().zip(surfaces).zip(0_u32..);
    let pixels = pixels.skip(columns.start as usize).take(columns.len());
    for (([.., coverage], [_, _, weight, _]), column) in pixels {
        // Shading leaves out what has neither weight nor a visible splat.
        let is_nothing = *weight == 0 && !shows(column, row);
        if *coverage >= 1.0 || is_nothing {
            continue;
        }
        // Between two surfaces is one, too.
        let left = |step: u32| shows(column.saturating_sub(step), row);
        let right = |step: u32| shows((column + step).min(width - 1), row);
        let above = |step: u32| shows(column, row.saturating_sub(step));
        let below = |step: u32| shows(column, (row + step).min(height - 1));
        let sides = [
            left(1) || left(2),
            right(1) || right(2),
            above(1) || above(2),
            below(1) || below(2),
        ];
        let sides = sides.into_iter().filter(|side| *side).count();
        if sides == 4 {
            *coverage = 1.0;
        } else if *coverage >= 0.5 {
            *coverage = coverage.max(0.5 + 0.125 * sides as f32);
        }
    }
}
