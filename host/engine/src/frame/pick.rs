//! What is at a pixel: surfel id, depth and position, from planes that were read back.

use glam::{DMat4, DVec3, Mat4, Vec3};
use pointstage_plugin_api::abi::FrameUniform;

use super::depth::eye_distance;
use super::picture::Plane;

/// What a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pick {
    /// The pixel, which may lie beside the one asked for.
    pub pixel: [u32; 2],
    /// Value of the `id` target, above 0; the frame's id table resolves it.
    pub id: u32,
    /// Reversed z, unshifted.
    pub depth: f32,
    /// Along the line of sight, scene units.
    pub eye_distance: f32,
    /// View space.
    pub position_view: Vec3,
    /// World space.
    pub position_world: DVec3,
}

/// The planes that picking looks at.
#[derive(Clone, Copy, Debug)]
pub struct PickPlanes<'a> {
    /// px.
    pub size_px: [u32; 2],
    /// The `id` target.
    pub id: &'a Plane,
    /// The `depth` target.
    pub depth: &'a Plane,
}

/// The surface at a pixel, or the nearest within `reach_px` of it.
///
/// Small splats are hard to hit: with a reach, the drawn pixel with the least distance on the screen counts, of equally
/// distant ones the one closest to the eye. `None` if nothing is drawn there, or the planes do not fit their size.
///
/// * `pixel`: column and row from the top left; it may lie outside.
/// * `world_from_view`: as in the frame.
pub fn pick(
    planes: PickPlanes<'_>,
    pixel: [i64; 2],
    reach_px: u32,
    frame: &FrameUniform,
    world_from_view: &DMat4,
) -> Option<Pick> {
    let PickPlanes { size_px, id, depth } = planes;
    let (Plane::Uint(ids), Plane::Float { values: depths, .. }) = (id, depth) else {
        return None;
    };
    let [width, height] = size_px.map(i64::from);
    let reach = i64::from(reach_px);
    let span = |at: i64, end: i64| (at - reach).max(0)..(at + reach + 1).min(end);

    let mut best: Option<((i64, u32), [i64; 2])> = None;
    for y in span(pixel[1], height) {
        for x in span(pixel[0], width) {
            let distance = (x - pixel[0]).pow(2) + (y - pixel[1]).pow(2);
            let index = (y * width + x) as usize;
            if distance > reach * reach || *ids.get(index)? == 0 {
                continue;
            }
            // Nearer is greater; bits of positive floats sort as the floats do.
            let rank = (distance, u32::MAX - depths.get(index)?.max(0.0).to_bits());
            if best.is_none_or(|(least, _)| rank < least) {
                best = Some((rank, [x, y]));
            }
        }
    }
    let (_, found) = best?;
    let index = (found[1] * width + found[0]) as usize;
    let depth = depths[index];
    let pixel = found.map(|value| value as u32);
    let position_view = position_view(pixel, depth, frame);
    Some(Pick {
        pixel,
        id: ids[index],
        depth,
        eye_distance: eye_distance(depth, &Mat4::from_cols_array_2d(&frame.clip_from_view)),
        position_view,
        position_world: world_from_view.transform_point3(position_view.as_dvec3()),
    })
}

/// Where a pixel's centre with this depth lies; view space.
pub fn position_view(pixel: [u32; 2], depth: f32, frame: &FrameUniform) -> Vec3 {
    let [width, height] = frame.tile_size_px;
    let [x, y] = pixel.map(|value| value as f32 + 0.5);
    let ndc = Vec3::new(2.0 * x / width - 1.0, 1.0 - 2.0 * y / height, depth);
    Mat4::from_cols_array_2d(&frame.view_from_clip).project_point3(ndc)
}

#[cfg(test)]
mod tests {
    use super::*;
    use pointstage_scene::{Camera, Projection};
    use std::sync::Arc;

    fn frame(camera: &Camera, size_px: [u32; 2]) -> FrameUniform {
        let clip_from_view = camera.clip_from_view(f64::from(size_px[0]) / f64::from(size_px[1]));
        FrameUniform {
            clip_from_view: clip_from_view.as_mat4().to_cols_array_2d(),
            view_from_clip: clip_from_view.inverse().as_mat4().to_cols_array_2d(),
            tile_size_px: size_px.map(|value| value as f32),
            ..FrameUniform::default()
        }
    }

    fn planes(size_px: [u32; 2], drawn: &[([u32; 2], u32, f32)]) -> (Plane, Plane) {
        let count = (size_px[0] * size_px[1]) as usize;
        let (mut ids, mut depths) = (vec![0; count], vec![0.0; count]);
        for ([x, y], id, depth) in drawn {
            let index = (y * size_px[0] + x) as usize;
            (ids[index], depths[index]) = (*id, *depth);
        }
        let depth = Plane::Float {
            channels: 1,
            values: Arc::from(depths),
        };
        (Plane::Uint(Arc::from(ids)), depth)
    }

    #[test]
    fn a_picked_position_projects_onto_its_pixel_at_its_depth() {
        let size_px = [40, 30];
        let projections = [
            Projection::Perspective { fov_y_rad: 0.7 },
            Projection::Orthographic { height: 2.0 },
        ];
        for projection in projections {
            let camera = Camera {
                projection,
                eye: DVec3::new(3.0, 2.0, 1.0),
                near: 0.1,
                far: 10.0,
                ..Camera::default()
            };
            let frame = frame(&camera, size_px);
            let view_from_world = camera.view_from_world();
            let (id, depth) = planes(size_px, &[([31, 4], 9, 0.05)]);
            let planes = PickPlanes {
                size_px,
                id: &id,
                depth: &depth,
            };
            let pick = pick(planes, [31, 4], 0, &frame, &view_from_world.inverse()).unwrap();
            assert_eq!(pick.id, 9);
            let clip_from_world = camera.clip_from_view(40.0 / 30.0) * view_from_world;
            let ndc = clip_from_world.project_point3(pick.position_world);
            let pixel = [(ndc.x + 1.0) * 20.0, (1.0 - ndc.y) * 15.0];
            assert!((pixel[0] - 31.5).abs() < 1e-3 && (pixel[1] - 4.5).abs() < 1e-3);
            assert!(
                (ndc.z - 0.05).abs() < 1e-6,
                "{projection:?}: depth {}",
                ndc.z
            );
            let distance = -pick.position_view.z;
            assert!((pick.eye_distance / distance - 1.0).abs() < 1e-4);
        }
    }

    #[test]
    fn reach_takes_the_closest_on_the_screen_then_to_the_eye() {
        let size_px = [9, 9];
        let frame = frame(&Camera::default(), size_px);
        let drawn = [([6, 4], 1, 0.1), ([4, 6], 2, 0.2), ([8, 8], 3, 0.9)];
        let (id, depth) = planes(size_px, &drawn);
        let planes = PickPlanes {
            size_px,
            id: &id,
            depth: &depth,
        };
        let at = |pixel, reach| {
            let pick = pick(planes, pixel, reach, &frame, &DMat4::IDENTITY);
            pick.map(|pick| (pick.id, pick.pixel))
        };
        assert_eq!(at([4, 4], 1), None);
        assert_eq!(at([4, 4], 3), Some((2, [4, 6])));
        assert_eq!(at([5, 4], 9), Some((1, [6, 4])));
        assert_eq!(at([12, 12], 6), Some((3, [8, 8])), "outside the picture");
        assert_eq!(at([-100, 4], 3), None);
    }

    #[test]
    fn planes_that_are_too_short_pick_nothing() {
        let (id, depth) = planes([2, 2], &[([1, 1], 1, 0.5)]);
        let planes = PickPlanes {
            size_px: [20, 20],
            id: &id,
            depth: &depth,
        };
        let frame = frame(&Camera::default(), [20, 20]);
        assert_eq!(pick(planes, [19, 19], 0, &frame, &DMat4::IDENTITY), None);
    }
}
