//! Paths go exactly through their views, without a jump and without a corner.

use super::*;
use crate::bounds::Bounds;
use proptest::prelude::*;

fn point() -> impl Strategy<Value = DVec3> {
    proptest::array::uniform3(-10.0..10.0f64).prop_map(DVec3::from)
}

fn camera(up: impl Strategy<Value = DVec3>) -> impl Strategy<Value = Camera> {
    (point(), point(), up, 0.2..1.5f64).prop_filter_map(
        "eye apart from pivot, up apart from the line of sight",
        |(eye, pivot, up, fov_y_rad)| {
            let offset = (eye - pivot).normalize_or_zero();
            let is_apart =
                eye.distance(pivot) > 0.5 && up.normalize_or_zero().cross(offset).length() > 0.1;
            is_apart.then(|| {
                let mut camera = Camera {
                    eye,
                    pivot,
                    up,
                    projection: Projection::Perspective { fov_y_rad },
                    ..Camera::default()
                };
                camera.fit_depth(&Bounds::new(DVec3::splat(-10.0), DVec3::splat(10.0)));
                camera
            })
        },
    )
}

/// Two to five views, half a second to three seconds apart.
fn keys(up: impl Strategy<Value = DVec3>) -> impl Strategy<Value = Vec<CameraKey>> {
    proptest::collection::vec((camera(up), 0.5..3.0f64), 2..6).prop_map(|views| {
        let mut time_s = 0.0;
        let keys = views.into_iter().map(|(camera, secs)| {
            let key = CameraKey {
                time_s,
                camera,
                easing: Easing::Smooth,
            };
            time_s += secs;
            key
        });
        keys.collect()
    })
}

fn any_up() -> impl Strategy<Value = DVec3> {
    point().prop_filter("a direction", |up| up.length() > 1.0)
}

/// What is seen: eye, direction of sight, up on the screen, angle of view.
fn seen(camera: &Camera) -> [DVec3; 4] {
    let [_, up, back] = camera.axes_world();
    let size = camera.height_at_pivot() / camera.distance();
    [camera.eye, back * 10.0, up * 10.0, DVec3::splat(size)]
}

fn farthest(a: [DVec3; 4], b: [DVec3; 4]) -> f64 {
    let pairs = a.into_iter().zip(b);
    pairs.map(|(a, b)| a.distance(b)).fold(0.0, f64::max)
}

/// How fast what is seen changes at a time, from one side.
fn rates(path: &CameraPath, time_s: f64, step_s: f64) -> [DVec3; 4] {
    let (here, there) = (seen(&path.at(time_s)), seen(&path.at(time_s + step_s)));
    std::array::from_fn(|index| (there[index] - here[index]) / step_s)
}

proptest! {
    #[test]
    fn the_path_goes_exactly_through_every_view(
        keys in prop_oneof![keys(any_up()), keys(Just(DVec3::Y))], is_linear in any::<[bool; 6]>(),
    ) {
        let mut keys = keys;
        for (key, is_linear) in keys.iter_mut().zip(is_linear) {
            key.easing = if is_linear { Easing::Linear } else { Easing::Smooth };
        }
        let path = CameraPath::new(keys.clone()).expect("times rise");
        for key in &keys {
            prop_assert_eq!(path.at(key.time_s), key.camera);
        }
        prop_assert_eq!(path.at(-1.0), keys[0].camera);
        prop_assert_eq!(path.at(path.end_s() + 1.0), keys[keys.len() - 1].camera);
    }

    #[test]
    fn nothing_jumps(keys in prop_oneof![keys(any_up()), keys(Just(DVec3::Z))], part in 0.0..1.0f64) {
        let path = CameraPath::new(keys).expect("times rise");
        let times = path.keys().iter().map(|key| key.time_s);
        for time in times.chain([part * path.end_s()]) {
            let here = seen(&path.at(time));
            for step in [-1e-7, 1e-7] {
                let jump = farthest(here, seen(&path.at(time + step)));
                // No camera of these moves or turns by a thousand units a second.
                prop_assert!(jump < 1e-4, "{jump} at {time} s");
            }
        }
    }

    #[test]
    fn speed_has_no_jump_at_a_view(keys in prop_oneof![keys(any_up()), keys(Just(DVec3::Y))]) {
        let path = CameraPath::new(keys).expect("times rise");
        for key in &path.keys()[1..path.keys().len() - 1] {
            let (before, after) = (rates(&path, key.time_s, -1e-5), rates(&path, key.time_s, 1e-5));
            let scale = before.iter().chain(&after).map(|rate| rate.length()).fold(1.0, f64::max);
            prop_assert!(farthest(before, after) < 0.02 * scale, "{before:?} {after:?}");
        }
    }

    #[test]
    fn it_rests_at_both_ends(keys in keys(any_up())) {
        let path = CameraPath::new(keys).expect("times rise");
        for (time, step) in [(0.0, 1e-6), (path.end_s(), -1e-6)] {
            let rate = rates(&path, time, step);
            prop_assert!(farthest(rate, [DVec3::ZERO; 4]) < 0.05, "{rate:?}");
        }
    }

    #[test]
    fn distance_stays_between_those_of_the_two_views_and_level_views_stay_level(
        keys in keys(Just(DVec3::Y)), part in 0.0..1.0f64,
    ) {
        let path = CameraPath::new(keys.clone()).expect("times rise");
        for pair in keys.windows(2) {
            let there = path.at(pair[0].time_s + part * (pair[1].time_s - pair[0].time_s));
            let ends = [pair[0].camera.distance(), pair[1].camera.distance()];
            let (least, most) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
            prop_assert!(there.distance() > least * (1.0 - 1e-9) && there.distance() < most * (1.0 + 1e-9));
            prop_assert!(there.axes_world()[0].y.abs() < 1e-9, "{there:?}");
        }
    }

    #[test]
    fn whole_turns_end_where_they_began(camera in camera(any_up()), centre in point(), turns in -3i32..4) {
        let back = camera.turned_around(centre, DVec3::Y, 360.0 * f64::from(turns));
        prop_assert_eq!(back, camera);
    }

    #[test]
    fn a_turn_keeps_the_distance_to_the_centre(camera in camera(any_up()), centre in point(), degrees in -720.0..720.0f64) {
        let there = camera.turned_around(centre, DVec3::Y, degrees);
        prop_assert!((there.eye.distance(centre) - camera.eye.distance(centre)).abs() < 1e-9);
        prop_assert!((there.distance() - camera.distance()).abs() < 1e-9);
        prop_assert!((there.eye.y - camera.eye.y).abs() < 1e-9);
    }
}

fn key(time_s: f64, camera: Camera) -> CameraKey {
    CameraKey {
        time_s,
        camera,
        easing: Easing::Smooth,
    }
}

/// Views a quarter of a turn apart.
fn around(count: u32) -> Vec<CameraKey> {
    let mut camera = Camera::default();
    camera.orbit_turntable(0.0, 0.4);
    let at = |index: u32| {
        let quarter = camera.turned_around(DVec3::ZERO, DVec3::Y, 90.0 * f64::from(index % 4));
        key(f64::from(index), quarter)
    };
    (0..count).map(at).collect()
}

#[test]
fn a_closed_path_goes_on_through_its_first_view() {
    let path = CameraPath::new(around(5)).expect("times rise");
    assert_eq!(path.at(4.0), path.at(0.0));
    let (end, start) = (rates(&path, 4.0, -1e-5), rates(&path, 0.0, 1e-5));
    assert!(start[0].length() > 3.0, "it does not rest: {start:?}");
    assert!(farthest(end, start) < 1e-3, "{end:?} {start:?}");
    // Four views make the whole circle, not only its corners.
    for step in 0..40 {
        let distance = path.at(0.1 * f64::from(step)).eye.length();
        assert!((distance - 3.0).abs() < 1e-9, "{distance} at step {step}");
    }
}

#[test]
fn a_linear_stretch_is_a_flight_at_an_even_pace() {
    let mut keys = around(3);
    keys[0].easing = Easing::Linear;
    let path = CameraPath::new(keys.clone()).expect("times rise");
    let half_way = keys[0].camera.between(&keys[1].camera, 0.5);
    assert_eq!(path.at(0.5), half_way);
    // What follows begins at that pace.
    let (before, after) = (rates(&path, 1.0, -1e-5), rates(&path, 1.0, 1e-5));
    assert!(farthest(before, after) < 1e-3, "{before:?} {after:?}");
}

#[test]
fn a_camera_that_looks_around_stays_where_it_is() {
    let mut there = Camera::default();
    there.look_level(1.5, 0.2);
    let path = CameraPath::new(vec![key(0.0, Camera::default()), key(1.0, there)]);
    let eye = path.expect("times rise").at(0.5).eye;
    assert!(eye.distance(Camera::default().eye) < 1e-9, "{eye}");
}

#[test]
fn orthographic_views_stay_orthographic() {
    let flat = |height| Camera {
        projection: Projection::Orthographic { height },
        ..Camera::default()
    };
    let keys = vec![key(0.0, flat(1.0)), key(2.0, flat(4.0))];
    let path = CameraPath::new(keys).expect("times rise");
    let Projection::Orthographic { height } = path.at(1.0).projection else {
        panic!("{:?}", path.at(1.0));
    };
    assert!((height - 2.0).abs() < 1e-9, "the geometric mean: {height}");
}

#[test]
fn what_is_no_path_is_told() {
    let camera = Camera::default();
    for (keys, expected) in [
        (vec![], "no views"),
        (
            vec![key(-1.0, camera)],
            "view 1 of the path: expected a time from 0 s, found -1 s",
        ),
        (vec![key(f64::NAN, camera)], "found NaN s"),
        (
            vec![key(1.0, camera), key(1.0, camera)],
            "view 2 of the path is at 1 s, the one before it at 1 s",
        ),
    ] {
        let error = CameraPath::new(keys).expect_err(expected).to_string();
        assert!(error.contains(expected), "{error}");
    }
    // A time that is none is before the first view.
    let path = CameraPath::new(vec![key(2.0, camera)]).expect("one view is a path");
    assert_eq!(path.at(f64::NAN), camera);
}
