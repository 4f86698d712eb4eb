//! Moves of the camera: what follows the pointer, what stays, and where they stop.

use super::*;
use glam::DVec2;

const ASPECT: f64 = 1.5;

fn around() -> Surroundings {
    Surroundings::of_unit_scene()
}

/// With a scene that turns freely.
fn freely() -> Surroundings {
    Surroundings {
        turntable: false,
        ..around()
    }
}

fn framed() -> Camera {
    let mut camera = Camera::default();
    CameraMove::Frame.apply(&mut camera, &around());
    camera
}

/// Where a world point appears, picture heights from the middle.
fn seen_at(camera: &Camera, world: DVec3) -> DVec2 {
    let clip_from_world = camera.clip_from_view(ASPECT) * camera.view_from_world();
    let ndc = clip_from_world.project_point3(world);
    DVec2::new(ndc.x * ASPECT, ndc.y) * 0.5
}

#[test]
fn zooming_keeps_what_is_under_the_pointer() {
    let mut camera = framed();
    let [right, up, _] = camera.axes_world();
    let point = camera.pivot + right * 0.4 + up * 0.3;
    let before = seen_at(&camera, point);
    let zoom = CameraMove::Zoom {
        factor: 0.5,
        right: before.x,
        up: before.y,
    };
    zoom.apply(&mut camera, &around());
    let after = seen_at(&camera, point);
    assert!((after - before).length() < 1e-9, "{before} became {after}");
}

#[test]
fn zooming_stops_before_the_numbers_do() {
    let mut camera = framed();
    let zoom = |factor| CameraMove::Zoom {
        factor,
        right: 0.2,
        up: 0.1,
    };
    for _ in 0..2000 {
        zoom(0.8).apply(&mut camera, &around());
    }
    assert!(camera.height_at_pivot() > 1e-6, "{camera:?}");
    for _ in 0..2000 {
        zoom(1.25).apply(&mut camera, &around());
    }
    assert!(
        camera.height_at_pivot() < 1e4 && camera.eye.is_finite(),
        "{camera:?}"
    );
}

#[test]
fn the_scene_follows_a_pan() {
    let mut camera = framed();
    let pan = CameraMove::Pan {
        right: 0.25,
        up: -0.125,
    };
    pan.apply(&mut camera, &around());
    let seen = seen_at(&camera, DVec3::ZERO);
    assert!((seen - DVec2::new(0.25, -0.125)).length() < 1e-9, "{seen}");
}

#[test]
fn what_is_in_front_follows_a_drag() {
    let mut camera = framed();
    let front = camera.pivot + camera.axes_world()[2];
    CameraMove::Drag {
        right: 0.05,
        up: 0.05,
    }
    .apply(&mut camera, &around());
    let seen = seen_at(&camera, front);
    assert!(seen.x > 0.0 && seen.y > 0.0, "{seen}");
}

#[test]
fn axis_views_look_from_where_they_say() {
    let cases = [
        (Axis::Right, DVec3::X),
        (Axis::Left, DVec3::NEG_X),
        (Axis::Top, DVec3::Y),
        (Axis::Bottom, DVec3::NEG_Y),
        (Axis::Front, DVec3::Z),
        (Axis::Back, DVec3::NEG_Z),
    ];
    for (axis, towards_eye) in cases {
        let mut camera = framed();
        CameraMove::Axis(axis).apply(&mut camera, &around());
        let found = (camera.eye - camera.pivot).normalize();
        // The turntable stops 0.1° before the poles.
        assert!(
            found.angle_between(towards_eye) < 0.002,
            "{axis:?}: {found}"
        );
    }
}

#[test]
fn a_map_stands_up_when_z_points_upwards() {
    let mut camera = framed();
    CameraMove::Upwards(UpAxis::Z).apply(&mut camera, &around());
    assert_eq!(UpAxis::of(&camera), UpAxis::Z);
    let seen = seen_at(&camera, camera.pivot + DVec3::Z);
    assert!(seen.y > 0.0 && seen.x.abs() < 1e-9, "{seen}");
    CameraMove::Axis(Axis::Top).apply(&mut camera, &around());
    let from = (camera.eye - camera.pivot).normalize();
    assert!(from.z > 0.99, "{from}");
}

#[test]
fn the_turntable_keeps_the_horizon_and_the_free_scene_does_not() {
    let drag = CameraMove::Drag {
        right: 0.3,
        up: 0.2,
    };
    let roll = CameraMove::Roll { roll_rad: 0.5 };
    let (mut level, mut free) = (framed(), framed());
    for camera_move in [drag, roll] {
        camera_move.apply(&mut level, &around());
        camera_move.apply(&mut free, &freely());
    }
    assert_eq!(UpAxis::exactly(&level), Some(UpAxis::Y));
    assert_eq!(UpAxis::exactly(&free), None);
    assert!((free.distance() / level.distance() - 1.0).abs() < 1e-9);
    CameraMove::Level(UpAxis::Y).apply(&mut free, &around());
    let [right, ..] = free.axes_world();
    assert!(right.y.abs() < 1e-9, "{right}");
}

#[test]
fn a_free_scene_follows_the_drag_over_the_poles() {
    let mut camera = framed();
    let drag = CameraMove::Drag {
        right: 0.0,
        up: -0.25,
    };
    for _ in 0..4 {
        drag.apply(&mut camera, &freely());
    }
    let [_, up, back] = camera.axes_world();
    assert!(up.y < -0.99 && back.z < -0.99, "up {up}, back {back}");
}

#[test]
fn looking_around_keeps_the_eye_and_follows_the_pointer() {
    for around in [around(), freely()] {
        let mut camera = framed();
        let (eye, ahead) = (camera.eye, camera.pivot);
        let look = CameraMove::Look {
            right: 0.1,
            up: 0.05,
        };
        look.apply(&mut camera, &around);
        assert_eq!(camera.eye, eye);
        let seen = seen_at(&camera, ahead);
        assert!(seen.x < 0.0 && seen.y < 0.0, "what was ahead is at {seen}");
    }
}

#[test]
fn the_selection_is_framed_and_without_one_the_scene() {
    let selection = Bounds::new(DVec3::splat(0.5), DVec3::splat(0.75));
    let with_selection = Surroundings {
        selection,
        ..around()
    };
    let mut camera = framed();
    CameraMove::FrameSelection.apply(&mut camera, &with_selection);
    assert!(camera.pivot.distance(selection.centre()) < 1e-9);
    CameraMove::Frame.apply(&mut camera, &with_selection);
    assert_eq!(camera.pivot, DVec3::ZERO);
    CameraMove::FrameSelection.apply(&mut camera, &around());
    assert_eq!(camera.pivot, DVec3::ZERO);
}

#[test]
fn a_near_plane_set_by_hand_stays_through_moves() {
    let clipped = Surroundings {
        near: NearClipping::Distance(2.0),
        ..around()
    };
    let mut camera = framed();
    let drag = CameraMove::Drag {
        right: 0.3,
        up: 0.2,
    };
    drag.apply(&mut camera, &clipped);
    assert_eq!(camera.near, 2.0);
    drag.apply(&mut camera, &around());
    assert!(camera.near < 0.1, "{}", camera.near);
}

#[test]
fn a_new_pivot_comes_to_the_middle() {
    let mut camera = framed();
    let point = DVec3::new(0.4, -0.3, 0.2);
    CameraMove::PivotAt(point).apply(&mut camera, &around());
    assert_eq!(camera.pivot, point);
    assert!(seen_at(&camera, point).length() < 1e-9);
    assert_eq!(camera.eye, framed().eye, "the eye turns and stays");
}

#[test]
fn the_whole_is_framed_without_what_strays_and_depth_reaches_that_too() {
    let far = DVec3::new(1e6, 0.0, 0.0);
    let around = Surroundings {
        bounds: Bounds::new(DVec3::splat(-1.0), far),
        ..Surroundings::of_unit_scene()
    };
    let (mut camera, mut clean) = (Camera::default(), Camera::default());
    CameraMove::SwitchProjection.apply(&mut camera, &around);
    clean.clone_from(&camera);
    CameraMove::Frame.apply(&mut camera, &around);
    CameraMove::Frame.apply(&mut clean, &Surroundings::of_unit_scene());
    assert_eq!(
        (camera.pivot, camera.projection),
        (clean.pivot, clean.projection)
    );
    assert!(camera.far - camera.distance() > 1e5, "{camera:?}");
}

#[test]
fn axis_views_of_a_rolled_scene_are_level() {
    let mut camera = framed();
    camera.orbit_free(0.3, 0.2, 1.4);
    CameraMove::Axis(Axis::Front).apply(&mut camera, &freely());
    assert_eq!(UpAxis::exactly(&camera), Some(UpAxis::Y));
}
