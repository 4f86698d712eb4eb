//! Moves from the eye: looking around, flying, turning to another pivot, levelling the horizon.

use glam::{DQuat, DVec3};

use super::navigate::POLE_MARGIN_RAD;
use super::{Camera, Projection};

impl Camera {
    /// Turns the line of sight around the eye, level: `yaw_rad` around `up` (positive: to the right), `pitch_rad` upwards.
    /// Stops just before the poles. The pivot goes along at its distance.
    pub fn look_level(&mut self, yaw_rad: f64, pitch_rad: f64) {
        let axis = self.up.try_normalize().unwrap_or(DVec3::Y);
        let sight = self.pivot - self.eye;
        // Angle from `up` to what is looked at: 0 straight up, π straight down.
        let polar = axis.angle_between(sight);
        let wanted =
            (polar - pitch_rad).clamp(POLE_MARGIN_RAD, std::f64::consts::PI - POLE_MARGIN_RAD);
        let [right, ..] = self.axes_world();
        let raised = DQuat::from_axis_angle(right, polar - wanted) * sight;
        self.pivot = self.eye + DQuat::from_axis_angle(axis, -yaw_rad) * raised;
    }

    /// Turns the line of sight around the eye freely: `yaw_rad` to the picture's right, `pitch_rad` to its top. `up` turns
    /// along.
    pub fn look_free(&mut self, yaw_rad: f64, pitch_rad: f64) {
        let [right, up, _] = self.axes_world();
        let turn = DQuat::from_axis_angle(up, -yaw_rad) * DQuat::from_axis_angle(right, pitch_rad);
        self.pivot = self.eye + turn * (self.pivot - self.eye);
        self.up = (turn * up).normalize();
    }

    /// Moves eye and pivot by lengths along the picture's right, its top and into it, scene units.
    ///
    /// An orthographic view, in which depth does not show, gets smaller or greater instead: at a way of its height the size
    /// is e times another.
    pub fn fly(&mut self, right_units: f64, up_units: f64, forward_units: f64) {
        let [right, up, back] = self.axes_world();
        let mut shift = right * right_units + up * up_units;
        match &mut self.projection {
            Projection::Perspective { .. } => shift -= back * forward_units,
            Projection::Orthographic { height } => *height *= (-forward_units / *height).exp(),
        }
        self.eye += shift;
        self.pivot += shift;
    }

    /// Makes `pivot` the point to look at and to turn around.
    ///
    /// In perspective the eye stays and turns to it; an orthographic eye shifts to where the point is in the middle. A point
    /// at the eye changes nothing.
    pub fn look_at(&mut self, pivot: DVec3) {
        let sight = pivot - self.eye;
        if !(sight.is_finite() && sight.length() > 0.0) {
            return;
        }
        match self.projection {
            Projection::Perspective { .. } => self.pivot = pivot,
            Projection::Orthographic { .. } => {
                let offset = self.eye - self.pivot;
                self.pivot = pivot;
                self.eye = pivot + offset;
            }
        }
        self.keep_off_the_poles();
    }

    /// Lets `up` point upwards in the picture without moving the eye, as far as the line of sight allows: it keeps 0.1° away
    /// from `up`.
    pub fn level(&mut self, up: DVec3) {
        self.up = up;
        self.keep_off_the_poles();
    }

    fn keep_off_the_poles(&mut self) {
        let axis = self.up.try_normalize().unwrap_or(DVec3::Y);
        let polar = axis.angle_between(self.eye - self.pivot);
        let margin = POLE_MARGIN_RAD * 0.999;
        if !(margin..=std::f64::consts::PI - margin).contains(&polar) {
            self.orbit_turntable(0.0, 0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn seen_at(camera: &Camera, world: DVec3) -> DVec3 {
        (camera.clip_from_view(1.0) * camera.view_from_world()).project_point3(world)
    }

    fn orthographic() -> Camera {
        Camera {
            projection: Projection::Orthographic { height: 2.0 },
            ..Camera::default()
        }
    }

    proptest! {
        #[test]
        fn looking_around_keeps_eye_distance_and_horizon(yaw in -7.0..7.0f64, pitch in -7.0..7.0f64) {
            let mut camera = Camera::default();
            camera.look_level(yaw, pitch);
            prop_assert_eq!(camera.eye, Camera::default().eye);
            prop_assert!((camera.distance() - 3.0).abs() < 1e-9);
            let [right, up, _] = camera.axes_world();
            prop_assert!(right.y.abs() < 1e-9 && up.y > 0.0, "right {right}, up {up}");
        }

        #[test]
        fn the_new_pivot_is_in_the_middle(point in proptest::array::uniform3(-2.0..2.0f64), flat in proptest::bool::ANY) {
            let mut camera = if flat { orthographic() } else { Camera::default() };
            let eye = camera.eye;
            camera.look_at(point.into());
            let seen = seen_at(&camera, point.into()).truncate();
            prop_assert!(seen.length() < 1e-6, "{seen}");
            prop_assert!(flat || camera.eye == eye, "the eye moved to {}", camera.eye);
        }
    }

    #[test]
    fn positive_yaw_looks_right_and_positive_pitch_up() {
        let ahead = DVec3::ZERO;
        let mut level = Camera::default();
        level.look_level(0.1, 0.1);
        let mut free = Camera::default();
        free.look_free(0.1, 0.1);
        for camera in [level, free] {
            let seen = seen_at(&camera, ahead);
            assert!(seen.x < 0.0 && seen.y < 0.0, "what was ahead is at {seen}");
        }
    }

    #[test]
    fn flying_moves_eye_and_pivot_along_the_picture_s_axes() {
        let mut camera = Camera::default();
        camera.fly(1.0, 2.0, 0.5);
        assert_eq!(camera.eye, DVec3::new(1.0, 2.0, 2.5));
        assert_eq!(camera.pivot, DVec3::new(1.0, 2.0, -0.5));
    }

    #[test]
    fn flying_forward_magnifies_an_orthographic_view() {
        let mut camera = orthographic();
        camera.fly(0.0, 0.0, 0.5);
        assert!(camera.height_at_pivot() < 2.0);
        assert_eq!(camera.eye, orthographic().eye);
    }

    #[test]
    fn a_pivot_at_the_eye_changes_nothing() {
        let mut camera = Camera::default();
        camera.look_at(camera.eye);
        camera.look_at(DVec3::NAN);
        assert_eq!(camera, Camera::default());
    }

    #[test]
    fn levelling_takes_the_roll_out_and_keeps_the_eye() {
        let mut camera = Camera::default();
        camera.orbit_free(0.3, 0.2, 1.0);
        let eye = camera.eye;
        camera.level(DVec3::Y);
        let [right, ..] = camera.axes_world();
        assert!(right.y.abs() < 1e-9, "{right}");
        assert_eq!(camera.eye, eye);
    }

    #[test]
    fn levelling_a_view_along_up_leaves_a_turntable_that_turns() {
        let mut camera = Camera {
            eye: DVec3::new(0.0, 3.0, 0.0),
            up: DVec3::Z,
            ..Camera::default()
        };
        camera.level(DVec3::Y);
        let polar = DVec3::Y.angle_between(camera.eye);
        assert!(polar > 0.99 * POLE_MARGIN_RAD, "{polar}");
    }
}
