//! Moving a light by hand, as the pointer moves over the picture.

use glam::{DMat4, DQuat, DVec3};

use crate::camera::{Camera, Projection};
use crate::light::{Light, LightKind, LightSpace};

/// A drag across the picture's height turns a direction by this much, radians: half a turn, from one side of the view's
/// sphere to the other.
const RADIANS_PER_HEIGHT: f64 = std::f64::consts::PI;

impl Light {
    /// Moves the light as the pointer goes `right` and `up`, picture heights.
    ///
    /// A direction turns around the eye's axes like a ball of the picture's height that is dragged at its front; a point goes
    /// along the picture's plane at its depth, so that it stays under the pointer. Both right in either space.
    pub fn drag(&mut self, camera: &Camera, right: f64, up: f64) {
        let view_from_world = camera.view_from_world();
        let moved = match self.kind_view(&view_from_world) {
            LightKind::Directional { towards } => {
                let yaw = DQuat::from_rotation_y(right * RADIANS_PER_HEIGHT);
                let pitch = DQuat::from_rotation_x(-up * RADIANS_PER_HEIGHT);
                let length = towards.length();
                let turned = (yaw * pitch * towards).normalize_or(DVec3::Z);
                let towards = turned * if length > 0.0 { length } else { 1.0 };
                LightKind::Directional { towards }
            }
            LightKind::Point { position } => {
                let height = height_at(camera, -position.z);
                let shift = DVec3::new(right * height, up * height, 0.0);
                LightKind::Point {
                    position: position + shift,
                }
            }
        };
        self.set_kind_view(&view_from_world, moved);
    }

    /// Moves a point away from the eye, `part` of the distance to the pivot; towards it if negative. A direction has no depth.
    pub fn push_away(&mut self, camera: &Camera, part: f64) {
        let view_from_world = camera.view_from_world();
        if let LightKind::Point { position } = self.kind_view(&view_from_world) {
            let position = position - DVec3::Z * (part * camera.distance());
            self.set_kind_view(&view_from_world, LightKind::Point { position });
        }
    }

    /// Places the light where `kind_view` says in view space; it stays fixed in its own space.
    fn set_kind_view(&mut self, view_from_world: &DMat4, kind_view: LightKind) {
        self.kind = match (self.space, kind_view) {
            (LightSpace::View, kind) => kind,
            (LightSpace::World, LightKind::Directional { towards }) => LightKind::Directional {
                towards: view_from_world.inverse().transform_vector3(towards),
            },
            (LightSpace::World, LightKind::Point { position }) => LightKind::Point {
                position: view_from_world.inverse().transform_point3(position),
            },
        };
    }
}

/// Height of the picture at a depth, scene units; at the pivot's depth for what is not before the eye.
fn height_at(camera: &Camera, depth: f64) -> f64 {
    match camera.projection {
        Projection::Perspective { fov_y_rad } if depth > camera.near => {
            2.0 * depth * (0.5 * fov_y_rad).tan()
        }
        _ => camera.height_at_pivot(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use proptest::prelude::*;

    fn light(kind: LightKind, space: LightSpace) -> Light {
        Light {
            kind,
            space,
            colour: Vec3::ONE,
        }
    }

    fn camera() -> Camera {
        let mut camera = Camera::default();
        camera.orbit_turntable(0.7, 0.4);
        camera
    }

    #[test]
    fn a_direction_from_the_front_follows_the_pointer() {
        for space in [LightSpace::View, LightSpace::World] {
            let camera = camera();
            let front = match space {
                LightSpace::View => DVec3::Z,
                LightSpace::World => camera.axes_world()[2],
            };
            let mut light = light(LightKind::Directional { towards: front }, space);
            light.drag(&camera, 0.1, 0.2);
            let LightKind::Directional { towards } = light.kind_view(&camera.view_from_world())
            else {
                panic!("kind changed")
            };
            assert!(towards.x > 0.1 && towards.y > 0.1, "{space:?}: {towards}");
        }
    }

    #[test]
    fn a_point_stays_under_the_pointer() {
        for space in [LightSpace::View, LightSpace::World] {
            let camera = camera();
            let place = match space {
                LightSpace::View => DVec3::new(0.2, 0.1, -2.0),
                LightSpace::World => DVec3::new(0.3, -0.2, 0.5),
            };
            let mut light = light(LightKind::Point { position: place }, space);
            let seen = |light: &Light| {
                let LightKind::Point { position } = light.kind_view(&camera.view_from_world())
                else {
                    panic!("kind changed")
                };
                // NDC is 2 a picture height.
                camera
                    .clip_from_view(1.0)
                    .project_point3(position)
                    .truncate()
                    * 0.5
            };
            let before = seen(&light);
            light.drag(&camera, 0.15, -0.1);
            let moved = seen(&light) - before;
            assert!(
                (moved - glam::DVec2::new(0.15, -0.1)).length() < 1e-9,
                "{space:?}: {moved}"
            );
        }
    }

    #[test]
    fn the_wheel_moves_a_point_in_depth_and_leaves_a_direction() {
        let camera = Camera::default();
        let mut point = light(
            LightKind::Point {
                position: DVec3::ZERO,
            },
            LightSpace::World,
        );
        point.push_away(&camera, 0.5);
        let LightKind::Point { position } = point.kind else {
            panic!("kind changed")
        };
        assert!(
            (position - DVec3::new(0.0, 0.0, -1.5)).length() < 1e-12,
            "{position}"
        );
        let mut directional = light(
            LightKind::Directional { towards: DVec3::X },
            LightSpace::View,
        );
        let before = directional.clone();
        directional.push_away(&camera, 0.5);
        assert_eq!(directional, before);
    }

    proptest! {
        #[test]
        fn a_drag_and_its_reverse_come_home(right in -1.0..1.0f64, up in -1.0..1.0f64, world in proptest::bool::ANY) {
            let space = if world { LightSpace::World } else { LightSpace::View };
            let mut light = light(LightKind::Directional { towards: DVec3::new(1.0, 2.0, 2.0) }, space);
            let camera = camera();
            light.drag(&camera, right, 0.0);
            light.drag(&camera, 0.0, up);
            light.drag(&camera, 0.0, -up);
            light.drag(&camera, -right, 0.0);
            let LightKind::Directional { towards } = light.kind else { panic!("kind changed") };
            prop_assert!((towards - DVec3::new(1.0, 2.0, 2.0)).length() < 1e-9, "{towards}");
        }
    }
}
