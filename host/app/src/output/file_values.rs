//! Values of targets as files hold them.

use pointstage_engine::frame::eye_distance;
use pointstage_engine::stage::Plane;
use pointstage_scene::ViewRecord;

/// The values that a file of target `key` holds: depth as the distance from the eye along the line of sight, scene units,
/// infinite where nothing is; other targets as they are.
pub(crate) fn for_file(key: &str, plane: &Plane, view: &ViewRecord) -> Plane {
    let ("depth", Plane::Float { channels, values }) = (key, plane) else {
        return plane.clone();
    };
    let clip_from_view = view.camera().clip_from_view(view.aspect()).as_mat4();
    let distance = |&depth: &f32| {
        // The clear value: in an orthographic view it would be the far plane.
        if depth == 0.0 {
            f32::INFINITY
        } else {
            eye_distance(depth, &clip_from_view)
        }
    };
    Plane::Float {
        channels: *channels,
        values: values.iter().map(distance).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pointstage_scene::{Camera, Projection};

    #[test]
    fn depth_becomes_distance_and_nothing_becomes_infinite() {
        let perspective = Camera {
            near: 0.5,
            ..Camera::default()
        };
        let orthographic = Camera {
            near: 1.0,
            far: 5.0,
            projection: Projection::Orthographic { height: 2.0 },
            ..Camera::default()
        };
        for (camera, depth, distance) in [(perspective, 0.25, 2.0), (orthographic, 0.5, 3.0)] {
            let plane = Plane::Float {
                channels: 1,
                values: [depth, 0.0].into(),
            };
            let view = ViewRecord::new(camera, 2, 1);
            let Plane::Float { values, .. } = for_file("depth", &plane, &view) else {
                panic!("depth is no longer a float")
            };
            assert!((values[0] - distance).abs() < 1e-5, "{values:?}");
            assert_eq!(values[1], f32::INFINITY);
        }
    }

    #[test]
    fn other_targets_stay_as_they_are() {
        let plane = Plane::Uint([1, 2].into());
        let view = ViewRecord::new(Camera::default(), 2, 1);
        assert_eq!(for_file("id", &plane, &view), plane);
    }
}
