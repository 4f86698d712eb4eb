//! Where the near plane stands: by itself, or where the user put it.

use serde::{Deserialize, Serialize};

use super::navigate::NEAR_PER_DISTANCE;
use super::{Camera, Projection};
use crate::bounds::Bounds;

/// How far the near plane may be from the automatic one and still count as it: an orthographic eye that backed away keeps
/// the plane of the distance before.
const AUTOMATIC_TOLERANCE: f64 = 0.02;

/// What decides where the near plane stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NearClipping {
    /// Just before the eye: a thousandth of the distance to the pivot.
    #[default]
    Automatic,
    /// This far from the eye, scene units, above 0: what is nearer is cut away.
    Distance(f64),
}

impl NearClipping {
    /// What a camera whose near plane stands where it does was clipped by.
    pub fn of(camera: &Camera) -> Self {
        let automatic = camera.distance() * NEAR_PER_DISTANCE;
        if (camera.near / automatic - 1.0).abs() < AUTOMATIC_TOLERANCE {
            Self::Automatic
        } else {
            Self::Distance(camera.near)
        }
    }
}

impl Camera {
    /// Sets near and far as [`fit_depth`](Self::fit_depth) does, but for a near plane that stands where the user put it.
    ///
    /// An orthographic eye then stays where it is, so that the plane does.
    pub fn fit_depth_clipped(&mut self, bounds: &Bounds, near: NearClipping) {
        match near {
            NearClipping::Distance(distance) if distance > 0.0 && distance.is_finite() => {
                let behind = bounds.centre().distance(self.pivot) + bounds.sphere_radius();
                self.near = distance;
                // Twice the distance: a plane behind the whole scene still has room behind it.
                self.far = (self.distance() + 1.05 * behind).max(2.0 * distance);
            }
            _ => self.fit_depth(bounds),
        }
    }

    /// The greatest distance at which a near plane still cuts something: the far side of `bounds`.
    pub fn farthest_near(&self, bounds: &Bounds) -> f64 {
        let to_centre = match self.projection {
            Projection::Perspective { .. } => self.eye.distance(bounds.centre()),
            Projection::Orthographic { .. } => {
                let [_, _, back] = self.axes_world();
                (self.eye - bounds.centre()).dot(back).abs()
            }
        };
        (to_centre + bounds.sphere_radius()).max(self.distance())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn bounds() -> Bounds {
        Bounds::new(DVec3::splat(-1.0), DVec3::splat(1.0))
    }

    fn orthographic() -> Camera {
        Camera {
            projection: Projection::Orthographic { height: 4.0 },
            ..Camera::default()
        }
    }

    #[test]
    fn a_plane_set_by_hand_cuts_what_is_before_it() {
        for mut camera in [Camera::default(), orthographic()] {
            // The eye is 3 from the middle: the plane goes through it.
            camera.fit_depth_clipped(&bounds(), NearClipping::Distance(3.0));
            let depth_at = |z: f64| {
                let clip_from_world = camera.clip_from_view(1.0) * camera.view_from_world();
                clip_from_world.project_point3(DVec3::new(0.0, 0.0, z)).z
            };
            // With reversed depth what is cut away is beyond 1.
            assert!(depth_at(0.5) > 1.0, "{}", depth_at(0.5));
            let kept = depth_at(-0.5);
            assert!((0.0..1.0).contains(&kept), "{kept}");
            assert!(depth_at(-1.7) >= 0.0, "the far side is cut");
        }
    }

    #[test]
    fn what_was_set_is_told_from_the_camera() {
        let mut camera = Camera::default();
        camera.fit_depth_clipped(&bounds(), NearClipping::Automatic);
        assert_eq!(NearClipping::of(&camera), NearClipping::Automatic);
        camera.fit_depth_clipped(&bounds(), NearClipping::Distance(2.5));
        assert_eq!(NearClipping::of(&camera), NearClipping::Distance(2.5));
        let mut flat = orthographic();
        flat.eye = DVec3::new(0.0, 0.0, 0.5);
        flat.fit_depth(&bounds());
        assert_eq!(NearClipping::of(&flat), NearClipping::Automatic);
    }

    #[test]
    fn a_useless_distance_is_as_none() {
        for distance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let mut camera = Camera::default();
            camera.fit_depth_clipped(&bounds(), NearClipping::Distance(distance));
            let mut expected = Camera::default();
            expected.fit_depth(&bounds());
            assert_eq!(camera, expected, "{distance}");
        }
    }

    #[test]
    fn the_slider_reaches_the_scene_s_far_side() {
        let reach = Camera::default().farthest_near(&bounds());
        assert!(reach > 3.0 + 1.7, "{reach}");
    }
}
