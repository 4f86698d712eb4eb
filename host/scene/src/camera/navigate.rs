//! Moves of the camera: orbit (turntable or free), pan, zoom, dolly, frame.

use glam::{DQuat, DVec3};

use super::{Camera, Projection};
use crate::bounds::Bounds;

/// The turntable stops this far from looking straight up or down, radians: 0.1°.
pub(super) const POLE_MARGIN_RAD: f64 = 0.001_745;

/// Near plane as a part of the distance to the pivot: with reversed depth in f32 a small one costs no precision.
pub(super) const NEAR_PER_DISTANCE: f64 = 1e-3;

/// Narrowest and widest angle of view that zooming reaches, radians: 0.5° and 140°.
const FOV_RANGE_RAD: [f64; 2] = [0.008_727, 2.443];

/// Space left around a framed box, as a factor of its sphere.
const FRAME_MARGIN: f64 = 1.05;

impl Camera {
    /// Turns the eye around the pivot as on a turntable: `yaw_rad` around `up` (positive: the eye moves to its right),
    /// `pitch_rad` towards `up` (positive: the eye rises). Stops just before the poles; the horizon stays level.
    pub fn orbit_turntable(&mut self, yaw_rad: f64, pitch_rad: f64) {
        let axis = self.up.try_normalize().unwrap_or(DVec3::Y);
        let offset = self.eye - self.pivot;
        // Angle from `up` to the eye: 0 above, π below.
        let polar = axis.angle_between(offset);
        let wanted =
            (polar - pitch_rad).clamp(POLE_MARGIN_RAD, std::f64::consts::PI - POLE_MARGIN_RAD);
        let [right, ..] = self.axes_world();
        let turned = DQuat::from_axis_angle(right, wanted - polar) * offset;
        self.eye = self.pivot + DQuat::from_axis_angle(axis, yaw_rad) * turned;
    }

    /// Turns the eye around the pivot freely: `yaw_rad` around the picture's vertical, `pitch_rad` around its horizontal,
    /// `roll_rad` around the line of sight (positive: the picture turns clockwise). `up` turns along.
    pub fn orbit_free(&mut self, yaw_rad: f64, pitch_rad: f64, roll_rad: f64) {
        let [right, up, back] = self.axes_world();
        let turn = DQuat::from_axis_angle(up, yaw_rad)
            * DQuat::from_axis_angle(right, -pitch_rad)
            * DQuat::from_axis_angle(back, roll_rad);
        self.eye = self.pivot + turn * (self.eye - self.pivot);
        self.up = (turn * up).normalize();
    }

    /// Moves eye and pivot in the picture's plane; in picture heights, x right and y up. The scene follows a pointer that
    /// moves by the negative of this.
    pub fn pan(&mut self, right_heights: f64, up_heights: f64) {
        let [right, up, _] = self.axes_world();
        let shift = (right * right_heights + up * up_heights) * self.height_at_pivot();
        self.eye += shift;
        self.pivot += shift;
    }

    /// Shows `factor` times as much without moving the eye: below 1 magnifies.
    pub fn zoom(&mut self, factor: f64) {
        match &mut self.projection {
            Projection::Perspective { fov_y_rad } => {
                let half = ((0.5 * *fov_y_rad).tan() * factor).atan();
                *fov_y_rad = (2.0 * half).clamp(FOV_RANGE_RAD[0], FOV_RANGE_RAD[1]);
            }
            Projection::Orthographic { height } => *height *= factor,
        }
    }

    /// Brings the eye to `factor` times its distance from the pivot: below 1 comes closer. An orthographic view, in which
    /// distance does not show, scales its height instead.
    pub fn dolly(&mut self, factor: f64) {
        match &mut self.projection {
            Projection::Perspective { .. } => {
                self.eye = self.pivot + (self.eye - self.pivot) * factor;
                self.near *= factor;
            }
            Projection::Orthographic { height } => *height *= factor,
        }
    }

    /// Moves the eye, without turning, so that `bounds` fill the picture; `aspect` is width over height.
    ///
    /// The pivot goes to the box's centre; near and far fit. An empty box changes nothing; a point gets a sphere of 1.
    pub fn frame(&mut self, bounds: &Bounds, aspect: f64) {
        if bounds.is_empty() {
            return;
        }
        let sphere_radius = if bounds.sphere_radius() > 0.0 {
            bounds.sphere_radius()
        } else {
            1.0
        };
        let radius = sphere_radius * FRAME_MARGIN;
        let [_, _, back] = self.axes_world();
        // The narrower side decides.
        let narrow = aspect.min(1.0);
        let distance = match &mut self.projection {
            Projection::Perspective { fov_y_rad } => {
                let half = ((0.5 * *fov_y_rad).tan() * narrow).atan();
                radius / half.sin()
            }
            Projection::Orthographic { height } => {
                *height = 2.0 * radius / narrow;
                3.0 * radius
            }
        };
        self.pivot = bounds.centre();
        self.eye = self.pivot + back * distance;
        self.fit_depth(bounds);
    }

    /// Sets near and far to suit the distance to the pivot and to `bounds`.
    ///
    /// Perspective: near is a thousandth of the distance. Orthographic: near and far enclose the box wherever it is, so the
    /// eye backs away until the whole box is before it.
    pub fn fit_depth(&mut self, bounds: &Bounds) {
        let distance = self.distance();
        self.near = distance * NEAR_PER_DISTANCE;
        let behind = bounds.centre().distance(self.pivot) + bounds.sphere_radius() * FRAME_MARGIN;
        let is_orthographic = matches!(self.projection, Projection::Orthographic { .. });
        if is_orthographic && distance < behind * 1.01 {
            let [_, _, back] = self.axes_world();
            self.eye = self.pivot + back * (behind * 1.01);
            self.near = behind * NEAR_PER_DISTANCE;
        }
        self.far = self.distance() + behind.max(self.near);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn camera() -> impl Strategy<Value = Camera> {
        let coordinate = || -100.0..100.0f64;
        let point = move || {
            (coordinate(), coordinate(), coordinate()).prop_map(|(x, y, z)| DVec3::new(x, y, z))
        };
        (point(), point(), proptest::bool::ANY).prop_filter_map(
            "eye apart from pivot, not above",
            |(eye, pivot, flat)| {
                let offset = eye - pivot;
                let projection = if flat {
                    Projection::Orthographic { height: 10.0 }
                } else {
                    Projection::Perspective { fov_y_rad: 0.8 }
                };
                let level = DVec3::new(offset.x, 0.0, offset.z).length();
                (level > 1.0).then_some(Camera {
                    eye,
                    pivot,
                    projection,
                    ..Camera::default()
                })
            },
        )
    }

    proptest! {
        #[test]
        fn orbits_keep_pivot_and_distance(mut camera in camera(), yaw in -7.0..7.0f64, pitch in -7.0..7.0f64, roll in -7.0..7.0f64) {
            let before = camera;
            camera.orbit_turntable(yaw, pitch);
            camera.orbit_free(yaw, pitch, roll);
            prop_assert_eq!(camera.pivot, before.pivot);
            prop_assert!((camera.distance() / before.distance() - 1.0).abs() < 1e-9);
        }

        #[test]
        fn the_turntable_keeps_the_horizon_level(mut camera in camera(), yaw in -7.0..7.0f64, pitch in -7.0..7.0f64) {
            camera.orbit_turntable(yaw, pitch);
            let [right, up, _] = camera.axes_world();
            prop_assert!(right.y.abs() < 1e-9 && up.y > 0.0, "right {right}, up {up}");
            prop_assert_eq!(camera.up, DVec3::Y);
        }

        #[test]
        fn a_free_orbit_and_its_reverse_come_home(mut camera in camera(), yaw in -3.0..3.0f64, pitch in -3.0..3.0f64) {
            let before = camera.view_from_world();
            camera.orbit_free(yaw, 0.0, 0.0);
            camera.orbit_free(0.0, pitch, 0.0);
            camera.orbit_free(0.0, -pitch, 0.0);
            camera.orbit_free(-yaw, 0.0, 0.0);
            prop_assert!(camera.view_from_world().abs_diff_eq(before, 1e-6));
        }

        #[test]
        fn a_framed_box_is_inside_the_picture(mut camera in camera(), aspect in 0.3..3.0f64, size in 0.001..1e4f64) {
            let bounds = Bounds::new(DVec3::splat(5e5), DVec3::new(5e5 + size, 5e5 + 2.0 * size, 5e5 + 0.1 * size));
            camera.frame(&bounds, aspect);
            let clip_from_world = camera.clip_from_view(aspect) * camera.view_from_world();
            for corner in bounds.corners() {
                let ndc = clip_from_world.project_point3(corner);
                prop_assert!(ndc.truncate().abs().max_element() <= 1.0 && ndc.z > 0.0 && ndc.z <= 1.0, "{ndc}");
            }
        }

        #[test]
        fn pan_moves_the_picture_by_heights(mut camera in camera(), x in -2.0..2.0f64, y in -2.0..2.0f64) {
            let old_pivot = camera.pivot;
            camera.pan(x, y);
            let ndc = (camera.clip_from_view(1.0) * camera.view_from_world()).project_point3(old_pivot);
            // A picture height is 2 in NDC.
            prop_assert!((ndc.x + 2.0 * x).abs() < 1e-6 && (ndc.y + 2.0 * y).abs() < 1e-6, "{ndc}");
        }

        #[test]
        fn dolly_and_zoom_scale_what_is_seen(mut camera in camera(), factor in 0.5..1.5f64) {
            let height = camera.height_at_pivot();
            camera.dolly(factor);
            prop_assert!((camera.height_at_pivot() / (height * factor) - 1.0).abs() < 1e-9);
            camera.zoom(factor);
            prop_assert!((camera.height_at_pivot() / (height * factor * factor) - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn positive_yaw_moves_the_eye_right_and_positive_pitch_up() {
        let mut camera = Camera::default();
        camera.orbit_turntable(0.1, 0.1);
        assert!(camera.eye.x > 0.0 && camera.eye.y > 0.0, "{}", camera.eye);
        let mut free = Camera::default();
        free.orbit_free(0.1, 0.1, 0.0);
        assert!(free.eye.x > 0.0 && free.eye.y > 0.0, "{}", free.eye);
    }

    #[test]
    fn framing_nothing_changes_nothing_and_a_point_can_be_framed() {
        let mut camera = Camera::default();
        camera.frame(&Bounds::EMPTY, 1.0);
        assert_eq!(camera, Camera::default());
        camera.frame(&Bounds::new(DVec3::ONE, DVec3::ONE), 1.0);
        assert!(camera.eye.is_finite() && camera.distance() > 0.0);
    }
}
