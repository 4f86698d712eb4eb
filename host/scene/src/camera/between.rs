//! The way from one view to another.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DQuat, DVec3};

use super::{Camera, Projection};

/// Angle of view that stands for an orthographic view where the other end is in perspective, radians: 1°. Its picture is
/// within 1 % of the orthographic one, so the step at the end does not show, and the eye stays near enough for f32.
const NARROW_FOV_RAD: f64 = 0.017_453;

/// Directions closer than this count as one, radians: what rounding leaves.
pub(super) const SAME_DIRECTION_RAD: f64 = 1e-6;

impl Camera {
    /// The view at the part `t` of the way from `self` to `to`: `self` itself at 0 and below, `to` itself at 1 and above.
    ///
    /// ```text
    /// height at the pivot, distance   geometric: h(t) = h₀ · (h₁/h₀)^t, so that a zoom goes on at an even pace
    /// pivot                           linear in h, so that a zoom to a point keeps that point in its place
    /// direction                       azimuth and polar angle around a common `up`, else the shortest turn
    /// eye                             pivot + distance · direction: never in the pivot, which a straight line might meet
    /// ```
    ///
    /// Where the eyes are nearer to one another than the pivots, as when the eye turns to another pivot, the eye goes straight
    /// and the pivot follows. Between two projections the orthographic one is a very narrow perspective, seen from afar.
    #[must_use]
    pub fn between(&self, to: &Self, t: f64) -> Self {
        if t <= 0.0 {
            return *self;
        }
        if t >= 1.0 {
            return *to;
        }
        let (from, to) = alike(self, to);
        let height = geometric(from.height_at_pivot(), to.height_at_pivot(), t);
        let distance = geometric(from.distance(), to.distance(), t);
        let (back, up) = direction(&from, &to, t);
        let is_flat = matches!(from.projection, Projection::Orthographic { .. });
        let (eye, pivot) = if !is_flat && from.eye.distance(to.eye) < from.pivot.distance(to.pivot)
        {
            let eye = from.eye.lerp(to.eye, t);
            (eye, eye - back * distance)
        } else {
            let part = pivot_part(from.height_at_pivot(), to.height_at_pivot(), height, t);
            let pivot = from.pivot.lerp(to.pivot, part);
            (pivot + back * distance, pivot)
        };
        let projection = if is_flat {
            Projection::Orthographic { height }
        } else {
            let fov_y_rad = 2.0 * (0.5 * height / distance).atan();
            Projection::Perspective { fov_y_rad }
        };
        Self {
            eye,
            pivot,
            up,
            projection,
            near: geometric(from.near, to.near, t),
            far: geometric(from.far, to.far, t),
        }
    }
}

fn geometric(from: f64, to: f64, t: f64) -> f64 {
    from * (to / from).powf(t)
}

/// How far the pivot has come while the height has come to `height`; as far as time where the height does not change.
fn pivot_part(from: f64, to: f64, height: f64, t: f64) -> f64 {
    if (to / from - 1.0).abs() < 1e-6 {
        t
    } else {
        (height - from) / (to - from)
    }
}

/// Both in perspective if one of them is.
fn alike(from: &Camera, to: &Camera) -> (Camera, Camera) {
    match (from.projection, to.projection) {
        (Projection::Orthographic { .. }, Projection::Perspective { .. }) => (narrow(from), *to),
        (Projection::Perspective { .. }, Projection::Orthographic { .. }) => (*from, narrow(to)),
        _ => (*from, *to),
    }
}

/// An orthographic view as a narrow perspective that shows the pivot's plane at the same size.
pub(super) fn narrow(camera: &Camera) -> Camera {
    let near_part = camera.near / camera.distance();
    let mut narrow = camera.with_projection_switched(NARROW_FOV_RAD);
    narrow.near = narrow.distance() * near_part;
    narrow
}

/// From the pivot to the eye, and up.
fn direction(from: &Camera, to: &Camera, t: f64) -> (DVec3, DVec3) {
    let ([_, _, from_back], [_, _, to_back]) = (from.axes_world(), to.axes_world());
    let axis = to.up.try_normalize().unwrap_or(DVec3::Y);
    let is_level = from.up.angle_between(axis) < SAME_DIRECTION_RAD;
    let polar = [from_back, to_back].map(|back| axis.angle_between(back));
    let has_azimuth = polar.map(|angle| angle.sin() > SAME_DIRECTION_RAD);
    if !is_level || has_azimuth != [true, true] {
        let turn = rotation(from).slerp(rotation(to), t);
        return (turn * DVec3::Z, turn * DVec3::Y);
    }
    // The horizon stays level all the way, as on the turntable.
    let level = Level::new(from, axis);
    let (start, end) = (level.azimuth(from_back), level.azimuth(to_back));
    let azimuth = start + nearest_turn(end - start) * t;
    let back = level.back(azimuth, polar[0] + (polar[1] - polar[0]) * t);
    (back, to.up)
}

/// The turn between −π and π that ends in the same direction.
pub(super) fn nearest_turn(angle_rad: f64) -> f64 {
    (angle_rad + PI).rem_euclid(TAU) - PI
}

/// A level frame: directions as azimuth and polar angle around an axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Level {
    axis: DVec3,
    right: DVec3,
    ahead: DVec3,
}

impl Level {
    /// The frame of a camera whose `up` is `axis`; its azimuth is that of the first view.
    pub(super) fn new(camera: &Camera, axis: DVec3) -> Self {
        let [right, _, _] = camera.axes_world();
        let ahead = right.cross(axis);
        Self { axis, right, ahead }
    }

    /// Azimuth of a direction from the pivot to the eye, −π to π.
    pub(super) fn azimuth(&self, back: DVec3) -> f64 {
        back.dot(self.right).atan2(-back.dot(self.ahead))
    }

    /// The direction of an azimuth and a polar angle.
    pub(super) fn back(&self, azimuth: f64, polar: f64) -> DVec3 {
        let (sin_azimuth, cos_azimuth) = azimuth.sin_cos();
        let (sin_polar, cos_polar) = polar.sin_cos();
        let level = self.right * sin_azimuth - self.ahead * cos_azimuth;
        level * sin_polar + self.axis * cos_polar
    }
}

/// The rotation of view space into the world.
pub(super) fn rotation(camera: &Camera) -> DQuat {
    let [right, up, back] = camera.axes_world();
    DQuat::from_mat3(&DMat3::from_cols(right, up, back)).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::Bounds;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = DVec3> {
        proptest::array::uniform3(-100.0..100.0f64).prop_map(DVec3::from)
    }

    fn projection() -> impl Strategy<Value = Projection> {
        prop_oneof![
            (0.05..2.5f64).prop_map(|fov_y_rad| Projection::Perspective { fov_y_rad }),
            (0.1..200.0f64).prop_map(|height| Projection::Orthographic { height }),
        ]
    }

    fn camera() -> impl Strategy<Value = Camera> {
        let up = prop_oneof![Just(DVec3::Y), Just(DVec3::Z), point()];
        (point(), point(), up, projection()).prop_filter_map(
            "eye apart from pivot, up apart from the line of sight",
            |(eye, pivot, up, projection)| {
                let offset = eye - pivot;
                let is_apart = offset.length() > 0.1 && up.cross(offset).length() > 0.01;
                is_apart.then(|| {
                    let mut camera = Camera {
                        eye,
                        pivot,
                        up,
                        projection,
                        ..Camera::default()
                    };
                    camera.fit_depth(&Bounds::new(DVec3::splat(-100.0), DVec3::splat(100.0)));
                    camera
                })
            },
        )
    }

    fn is_usable(camera: &Camera) -> bool {
        let least = camera.distance() > 0.0 && camera.near > 0.0 && camera.eye.is_finite();
        let [right, up, back] = camera.axes_world();
        let is_framed = (right.cross(up) - back).length() < 1e-9;
        let has_up = camera.up.cross(back).length() > 1e-9;
        least && is_framed && has_up && camera.height_at_pivot() > 0.0
    }

    proptest! {
        #[test]
        fn the_way_begins_and_ends_exactly_where_it_should(from in camera(), to in camera()) {
            prop_assert_eq!(from.between(&to, 0.0), from);
            prop_assert_eq!(from.between(&to, 1.0), to);
            prop_assert_eq!(from.between(&to, 7.0), to);
        }

        #[test]
        fn the_eye_is_never_in_the_pivot(from in camera(), to in camera(), t in 0.0..1.0f64) {
            let there = from.between(&to, t);
            // A narrow view stands for an orthographic one: farther away, never nearer.
            let least = from.distance().min(to.distance());
            let height = from.height_at_pivot().min(to.height_at_pivot());
            prop_assert!(there.distance() > 0.99 * least.min(height / (2.0 * NARROW_FOV_RAD)), "{there:?}");
            prop_assert!(is_usable(&there), "{there:?}");
        }

        #[test]
        fn sizes_stay_between_those_of_the_ends(from in camera(), to in camera(), t in 0.0..1.0f64) {
            let height = from.between(&to, t).height_at_pivot();
            let ends = [from.height_at_pivot(), to.height_at_pivot()];
            prop_assert!(height > ends[0].min(ends[1]) * (1.0 - 1e-9), "{height} of {ends:?}");
            prop_assert!(height < ends[0].max(ends[1]) * (1.0 + 1e-9), "{height} of {ends:?}");
        }

        #[test]
        fn a_level_horizon_stays_level(from in camera(), to in camera(), t in 0.0..1.0f64) {
            let level = |camera: Camera| Camera { up: DVec3::Y, ..camera };
            let (from, to) = (level(from), level(to));
            let is_steep = |camera: &Camera| camera.axes_world()[2].y.abs() > 0.999;
            prop_assume!(!is_steep(&from) && !is_steep(&to));
            let [right, ..] = from.between(&to, t).axes_world();
            prop_assert!(right.y.abs() < 1e-6, "{right}");
        }

        #[test]
        fn around_one_pivot_the_distance_is_kept(from in camera(), yaw in -3.0..3.0f64, pitch in -1.0..1.0f64, t in 0.0..1.0f64) {
            let mut to = from;
            to.orbit_free(yaw, pitch, 0.0);
            let there = from.between(&to, t);
            prop_assert!((there.distance() / from.distance() - 1.0).abs() < 1e-6);
            prop_assert!(there.pivot.distance(from.pivot) < 1e-6 * (1.0 + from.distance()));
        }
    }

    #[test]
    fn the_ends_are_met_without_a_jump() {
        let from = Camera::default();
        let mut to = from;
        to.orbit_turntable(2.0, 0.5);
        to.pan(0.3, 0.2);
        to.dolly(0.25);
        for (t, end) in [(1e-9, from), (1.0 - 1e-9, to)] {
            let there = from.between(&to, t);
            assert!(there.eye.distance(end.eye) < 1e-6, "{there:?} at {t}");
            assert!(there.pivot.distance(end.pivot) < 1e-6, "{there:?} at {t}");
            assert!(
                there
                    .view_from_world()
                    .abs_diff_eq(end.view_from_world(), 1e-6)
            );
        }
    }

    #[test]
    fn a_zoom_to_a_point_keeps_the_point_in_its_place() {
        let from = Camera::default();
        let point = DVec3::new(0.4, 0.3, 0.0);
        let seen = |camera: &Camera| {
            let clip_from_world = camera.clip_from_view(1.0) * camera.view_from_world();
            clip_from_world.project_point3(point).truncate()
        };
        let mut to = from;
        to.pivot = to.pivot.lerp(point, 0.75);
        to.eye = to.eye.lerp(point, 0.75);
        assert!((seen(&to) - seen(&from)).length() < 1e-9);
        for t in [0.2, 0.5, 0.9] {
            let there = from.between(&to, t);
            assert!((seen(&there) - seen(&from)).length() < 1e-6, "at {t}");
        }
    }
}
