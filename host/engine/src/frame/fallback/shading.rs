//! Shading pass: lights the visible surfel of each pixel and writes the planes.

use glam::{Vec2, Vec3};
use pointstage_plugin_api::abi::FrameUniform;
use pointstage_plugin_api::columns::decode_normal;
use rayon::prelude::*;

use super::super::cpu_targets::{CpuTargets, PlaneValues};
use super::super::srgb::linear_from_srgb8;
use super::super::targets::{COLOUR, DEPTH, ID, KIND, LOD, NO_LEVEL, NORMAL, kind};
use super::draws::{Draw, Draws};
use super::lighting::{facing, phong, towards_eye};
use super::splat::Screen;
use super::visibility::VisibilityBuffer;

/// One row of the planes that the frame asks for.
#[derive(Default)]
struct Row<'t> {
    colour: Option<&'t mut [[f32; 4]]>,
    depth: Option<&'t mut [f32]>,
    normal: Option<&'t mut [[f32; 4]]>,
    id: Option<&'t mut [u32]>,
    kind: Option<&'t mut [u32]>,
    lod: Option<&'t mut [u32]>,
}

/// Fills the planes where something is visible.
pub(super) fn shade(
    visible: &VisibilityBuffer,
    frame: &FrameUniform,
    draws: &Draws<'_>,
    targets: &mut CpuTargets,
) {
    let screen = Screen::new(frame, visible.size_px());
    let mut rows = rows(targets);
    rows.par_iter_mut().enumerate().for_each(|(y, row)| {
        for (x, seen) in visible.row(y).enumerate() {
            let Some(seen) = seen else { continue };
            let (draw, index) = draws.find(seen.ordinal);
            let number = draw.number(index);
            if let Some(depth) = &mut row.depth {
                depth[x] = seen.depth;
            }
            if let Some(id) = &mut row.id {
                id[x] = draw.id_base.wrapping_add(number);
            }
            if let Some(kinds) = &mut row.kind {
                kinds[x] = kind::SURFEL;
            }
            if let Some(lod) = &mut row.lod {
                lod[x] = draw.level.min(NO_LEVEL - 1);
            }
            if row.colour.is_none() && row.normal.is_none() {
                continue;
            }
            let pixel_centre = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let position_view = screen.position_view(pixel_centre, seen.depth);
            let eye = towards_eye(position_view, frame);
            let normal_view = normal_view(draw, number, eye);
            if let Some(normal) = &mut row.normal {
                normal[x] = normal_view.map_or([0.0; 4], |normal| normal.extend(1.0).to_array());
            }
            if let Some(colour) = &mut row.colour {
                // Without a normal the surfel faces the eye, as its disc does.
                let normal = normal_view.unwrap_or(eye);
                let surface = surface_colour(draw, number);
                let light = phong(position_view, normal, eye, surface, draw.surface, frame);
                colour[x] = light.extend(1.0).to_array();
            }
        }
    });
}

/// Linear colour of a surfel.
fn surface_colour(draw: &Draw<'_>, number: u32) -> Vec3 {
    match draw
        .colours
        .and_then(|colours| colours.get(number as usize))
    {
        Some(packed) => {
            let [r, g, b, _] = packed.to_le_bytes();
            Vec3::from_array([r, g, b].map(linear_from_srgb8))
        }
        None => draw.default_colour.truncate(),
    }
}

/// Unit normal of a surfel, turned to the eye if it has no outside; `None` if there is none.
fn normal_view(draw: &Draw<'_>, number: u32, towards_eye: Vec3) -> Option<Vec3> {
    let packed = draw.normals?.get(number as usize)?;
    let normal = (draw.normal_matrix * decode_normal(*packed)).try_normalize()?;
    Some(if draw.two_sided {
        facing(normal, towards_eye)
    } else {
        normal
    })
}

/// The planes cut into rows. Planes with unknown keys, or with values of another kind than the host's, are left out.
fn rows(targets: &mut CpuTargets) -> Vec<Row<'_>> {
    let [width, height] = targets.size_px().map(|size| size as usize);
    let mut rows: Vec<Row<'_>> = (0..height).map(|_| Row::default()).collect();
    if width == 0 {
        return Vec::new();
    }
    for plane in targets.planes_mut() {
        match (&*plane.spec.key, &mut plane.values) {
            (key @ (COLOUR | NORMAL), PlaneValues::Float(values)) => {
                let lines = values.as_chunks_mut::<4>().0.chunks_mut(width);
                for (row, line) in rows.iter_mut().zip(lines) {
                    let slot = if key == COLOUR {
                        &mut row.colour
                    } else {
                        &mut row.normal
                    };
                    *slot = Some(line);
                }
            }
            (DEPTH, PlaneValues::Float(values)) => {
                for (row, line) in rows.iter_mut().zip(values.chunks_mut(width)) {
                    row.depth = Some(line);
                }
            }
            (key @ (ID | KIND | LOD), PlaneValues::Uint(values)) => {
                for (row, line) in rows.iter_mut().zip(values.chunks_mut(width)) {
                    let slot = match key {
                        ID => &mut row.id,
                        KIND => &mut row.kind,
                        _ => &mut row.lod,
                    };
                    *slot = Some(line);
                }
            }
            _ => {}
        }
    }
    rows
}
