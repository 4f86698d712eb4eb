//! Views around a scene.

use std::f64::consts::TAU;

use glam::DVec3;

use super::{Camera, Projection};
use crate::bounds::Bounds;

/// How far the ring of views stands above the horizon, radians: 20°, so that tops show and walls too.
const ELEVATION_RAD: f64 = 0.349_066;

/// `count` perspective cameras on a ring around `bounds`, evenly spaced, each framing the whole box.
///
/// The first stands before the box (+z), the others follow to its right (+x first); all 20° above the horizon with y up,
/// 40° high. The same input gives the same cameras, always. `aspect` is width over height. An empty box is taken as one of
/// size 1 around the origin.
pub fn orbit_cameras(bounds: &Bounds, count: usize, aspect: f64) -> Vec<Camera> {
    let framed = if bounds.is_empty() {
        Bounds::new(DVec3::splat(-0.5), DVec3::splat(0.5))
    } else {
        *bounds
    };
    let pivot = framed.centre();
    let (sin_elevation, cos_elevation) = ELEVATION_RAD.sin_cos();
    let at = |index: usize| {
        let (sin_azimuth, cos_azimuth) = (TAU * index as f64 / count as f64).sin_cos();
        let towards_eye = DVec3::new(
            cos_elevation * sin_azimuth,
            sin_elevation,
            cos_elevation * cos_azimuth,
        );
        let mut camera = Camera {
            eye: pivot + towards_eye * framed.sphere_radius().max(1.0),
            pivot,
            up: DVec3::Y,
            projection: Projection::Perspective {
                fov_y_rad: 40_f64.to_radians(),
            },
            ..Camera::default()
        };
        camera.frame(&framed, aspect);
        camera
    };
    (0..count).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_stand_evenly_on_one_ring() {
        let bounds = Bounds::new(DVec3::splat(-1.0), DVec3::splat(1.0));
        let cameras = orbit_cameras(&bounds, 4, 1.5);
        assert_eq!(cameras.len(), 4);
        assert!(cameras[0].eye.z > 0.0 && cameras[0].eye.x.abs() < 1e-9);
        assert!(cameras[1].eye.x > 0.0 && cameras[1].eye.z.abs() < 1e-9);
        for camera in &cameras {
            assert!((camera.eye.y - cameras[0].eye.y).abs() < 1e-9);
            assert!((camera.distance() - cameras[0].distance()).abs() < 1e-9);
        }
    }

    #[test]
    fn no_views_and_no_scene_are_fine() {
        assert!(orbit_cameras(&Bounds::EMPTY, 0, 1.0).is_empty());
        assert!(orbit_cameras(&Bounds::EMPTY, 1, 1.0)[0].eye.is_finite());
    }
}
