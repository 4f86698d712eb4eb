//! Four images at once against the f64 twin, one by one.

use super::*;
use pointstage_plugin_api::glam::{DVec2, DVec3};
use pointstage_plugin_api::twin::camera::Camera;
use pointstage_plugin_api::twin::ellipse::{Axes, project_ellipse};

/// About 53 degrees high; near plane at 0.1.
fn frame() -> FrameUniform {
    FrameUniform {
        clip_from_view: [
            [1.5, 0.0, 0.0, 0.0],
            [0.0, 2.0, 0.0, 0.0],
            [0.1, -0.05, 0.0, -1.0],
            [0.0, 0.0, 0.1, 0.0],
        ],
        tile_size_px: [320.0, 240.0],
        pixels_per_unit: 240.0,
        ..FrameUniform::default()
    }
}

/// Numbers from -1 to 1 without a pattern that matters here.
fn number(index: usize) -> f32 {
    ((index as f32 * 12.9898).sin() * 43_758.547).fract()
}

fn vector(index: usize) -> Vec3 {
    Vec3::new(
        number(3 * index),
        number(3 * index + 1),
        number(3 * index + 2),
    )
}

#[test]
fn images_are_those_of_the_twin() {
    let frame = frame();
    let (camera, twin) = (Camera4::from(&frame), Camera::from(&frame));
    let mut seen_count = 0;
    for group in 0..500 {
        let lanes = [0, 1, 2, 3].map(|lane| 3 * (LANES * group + lane));
        let centres = lanes.map(|index| vector(index) - Vec3::Z);
        let us = lanes.map(|index| vector(index + 1) * 0.2);
        let vs = lanes.map(|index| vector(index + 2) * 0.2);
        let axes = Axes4 {
            u: Vec3x4::from_vectors(us),
            v: Vec3x4::from_vectors(vs),
        };
        let found = camera.project_ellipses(Vec3x4::from_vectors(centres), &axes);
        for lane in 0..LANES {
            let axes = Axes {
                u: us[lane].as_dvec3(),
                v: vs[lane].as_dvec3(),
            };
            let expected = project_ellipse(&twin, centres[lane].as_dvec3(), axes);
            let Some(expected) = expected else { continue };
            let is_seen = found.is_seen.bitmask() & 1 << lane != 0;
            assert!(is_seen, "lane {lane} of group {group} is not seen");
            seen_count += 1;
            let [lower, upper] = [found.lower_px, found.upper_px]
                .map(|corner| DVec2::new(corner[0][lane].into(), corner[1][lane].into()));
            let size = twin.tile_size_px;
            // Bounds hold what is visible, and little more than the margins.
            assert!(lower.cmple(expected.lower_px.max(DVec2::ZERO) + 1e-3).all());
            assert!(upper.cmpge(expected.upper_px.min(size) - 1e-3).all());
            let origin = DVec2::new(
                found.origin_px[0][lane].into(),
                found.origin_px[1][lane].into(),
            );
            let uv1 = expected.ellipse_uv1(origin);
            let error = found.uv1_constant.lane(lane).as_dvec3() - uv1;
            let scale = uv1.abs().max(DVec3::ONE).max_element();
            assert!(error.length() < 1e-2 * scale, "{error} of {uv1}");
        }
    }
    assert!(seen_count > 500, "{seen_count} ellipses are seen");
}

#[test]
fn spheres_hold_the_images_of_their_ellipses() {
    let camera = Camera4::from(&frame());
    for group in 0..500 {
        let lanes = [0, 1, 2, 3].map(|lane| 2 * (LANES * group + lane));
        let centre = Vec3x4::from_vectors(lanes.map(|index| vector(index) * 0.8 - Vec3::Z));
        let normal = lanes.map(|index| vector(index + 1).normalize());
        let radius = 0.15;
        let pairs = normal.map(Vec3::any_orthonormal_pair);
        let axes = Axes4 {
            u: Vec3x4::from_vectors(pairs.map(|(u, _)| u * radius)),
            v: Vec3x4::from_vectors(pairs.map(|(_, v)| v * radius)),
        };
        let images = camera.project_ellipses(centre, &axes);
        let spheres = camera.project_spheres(centre, Vec4::splat(radius), 0.0);
        for lane in (0..LANES).filter(|lane| images.is_seen.bitmask() & 1 << lane != 0) {
            for axis in [0, 1] {
                let [low, high] = [images.lower_px[axis][lane], images.upper_px[axis][lane]];
                // A disk that the near plane cuts has a margin of a pixel.
                if low < high {
                    assert!(spheres.lower_px[axis][lane] <= low + 1.02);
                    assert!(spheres.upper_px[axis][lane] >= high - 1.02);
                }
            }
            assert!(spheres.depth[lane] >= images.depth.x[lane] || spheres.depth[lane] > 0.0);
        }
    }
}
