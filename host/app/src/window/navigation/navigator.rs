//! What the camera does by itself: flies to another view, or glides on after a drag.

use pointstage_scene::{Camera, NearClipping};

use super::moves::{CameraMove, Surroundings};
use super::{Glide, UpAxis};
use crate::window::flight::Flight;

/// Moves the camera, at once or over several passes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Navigator {
    flight: Option<Flight>,
    glide: Option<Glide>,
    /// The axis that pointed upwards when the horizon was last level.
    level_axis: UpAxis,
}

impl Navigator {
    /// Carries a move out. One that leads to a view of its own is flown to where `around` asks for flights; any other stops
    /// what is under way.
    pub(crate) fn carry_out(
        &mut self,
        camera: &mut Camera,
        camera_move: CameraMove,
        around: &Surroundings,
    ) {
        if !camera_move.is_journey() {
            self.stop(camera, around);
            camera_move.apply(camera, around);
            self.note_level(camera);
            return;
        }
        // Where it will be, so that two journeys in a row end where they would one after the other.
        let mut target = self.flight.map_or(*camera, |flight| flight.target());
        camera_move.apply(&mut target, around);
        self.fly_to(camera, target, around);
    }

    /// Takes the camera to `target`.
    pub(crate) fn fly_to(&mut self, camera: &mut Camera, target: Camera, around: &Surroundings) {
        self.glide = None;
        self.note_level(&target);
        self.flight = (around.flights && *camera != target).then(|| Flight::new(*camera, target));
        if self.flight.is_none() {
            *camera = target;
        }
    }

    /// Lets a drag go on by itself.
    pub(crate) fn glide(&mut self, glide: Glide) {
        self.flight = None;
        self.glide = Some(glide);
    }

    /// Ends what is under way, where it is.
    pub(crate) fn stop(&mut self, camera: &mut Camera, around: &Surroundings) {
        self.glide = None;
        if let Some(flight) = self.flight.take() {
            // A flight between two horizons is tilted on its way; the turntable is not.
            if around.turntable {
                camera.level(flight.target().up);
            }
        }
    }

    /// Moves the camera on to where it is at the time `now`, seconds. True if it moved.
    pub(crate) fn advance(&mut self, camera: &mut Camera, now: f64, around: &Surroundings) -> bool {
        if let Some(flight) = &mut self.flight {
            let (there, is_last) = flight.advance(now);
            *camera = there;
            if is_last {
                self.flight = None;
            } else if around.near == NearClipping::Automatic {
                camera.fit_depth(&around.bounds);
            }
            return true;
        }
        let Some(glide) = &mut self.glide else {
            return false;
        };
        let (camera_move, is_last) = glide.advance(now);
        camera_move.apply(camera, around);
        if is_last {
            self.glide = None;
        }
        true
    }

    /// Whether a flight is under way.
    pub(crate) fn is_flight(&self) -> bool {
        self.flight.is_some()
    }

    /// Whether anything is under way.
    pub(crate) fn is_moving(&self) -> bool {
        self.flight.is_some() || self.glide.is_some()
    }

    /// Where the camera will be when all is done.
    #[cfg(test)]
    pub(crate) fn destination(&self, camera: &Camera) -> Camera {
        self.flight.map_or(*camera, |flight| flight.target())
    }

    /// The axis that points upwards, or did before the scene was rolled.
    pub(crate) fn level_axis(&self) -> UpAxis {
        self.level_axis
    }

    fn note_level(&mut self, camera: &Camera) {
        if let Some(axis) = UpAxis::exactly(camera) {
            self.level_axis = axis;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::navigation::{Axis, GlideKind};
    use glam::DVec3;

    fn around() -> Surroundings {
        Surroundings {
            flights: true,
            ..Surroundings::of_unit_scene()
        }
    }

    fn framed() -> Camera {
        let mut camera = Camera::default();
        CameraMove::Frame.apply(&mut camera, &around());
        camera
    }

    /// Runs passes of a tenth of a second until nothing moves: how many there were.
    fn run(navigator: &mut Navigator, camera: &mut Camera) -> usize {
        let passes = (0..100).take_while(|&pass| {
            navigator.advance(camera, f64::from(pass) * 0.1, &around()) && navigator.is_moving()
        });
        passes.count()
    }

    #[test]
    fn a_journey_is_flown_and_ends_where_it_would_have_ended_at_once() {
        let (mut navigator, mut camera) = (Navigator::default(), framed());
        let mut expected = camera;
        CameraMove::Axis(Axis::Right).apply(&mut expected, &around());
        navigator.carry_out(&mut camera, CameraMove::Axis(Axis::Right), &around());
        assert_eq!(camera, framed(), "not at once");
        assert_eq!(navigator.destination(&camera), expected);
        let passes = run(&mut navigator, &mut camera);
        assert!((3..=6).contains(&passes), "{passes} passes");
        assert_eq!(camera, expected);
        assert!(!navigator.advance(&mut camera, 99.0, &around()), "it rests");
    }

    #[test]
    fn without_flights_it_is_there_at_once() {
        let (mut navigator, mut camera) = (Navigator::default(), framed());
        let around = Surroundings::of_unit_scene();
        navigator.carry_out(&mut camera, CameraMove::Axis(Axis::Right), &around);
        assert!(!navigator.is_moving());
        assert!(camera.eye.x > 1.0, "{camera:?}");
    }

    #[test]
    fn two_journeys_in_a_row_end_as_one_after_the_other() {
        let (mut navigator, mut camera) = (Navigator::default(), framed());
        camera.pan(3.0, 0.0);
        let mut expected = camera;
        for camera_move in [CameraMove::Frame, CameraMove::Axis(Axis::Top)] {
            camera_move.apply(&mut expected, &around());
            navigator.carry_out(&mut camera, camera_move, &around());
        }
        run(&mut navigator, &mut camera);
        assert_eq!(camera, expected);
    }

    #[test]
    fn a_gesture_stops_the_flight_where_it_is() {
        let (mut navigator, mut camera) = (Navigator::default(), framed());
        navigator.carry_out(&mut camera, CameraMove::Axis(Axis::Right), &around());
        navigator.advance(&mut camera, 0.0, &around());
        navigator.advance(&mut camera, 0.2, &around());
        let half_way = camera;
        let pan = CameraMove::Pan {
            right: 0.0,
            up: 0.0,
        };
        navigator.carry_out(&mut camera, pan, &around());
        assert!(!navigator.is_moving());
        assert!(camera.eye.distance(half_way.eye) < 1e-9);
    }

    #[test]
    fn a_stopped_flight_leaves_the_turntable_level() {
        let (mut navigator, mut camera) = (Navigator::default(), framed());
        camera.orbit_free(0.2, 0.1, 1.0);
        let tilted = camera;
        navigator.carry_out(&mut camera, CameraMove::Level(UpAxis::Y), &around());
        navigator.advance(&mut camera, 0.0, &around());
        navigator.advance(&mut camera, 0.1, &around());
        assert!(
            UpAxis::exactly(&camera).is_none(),
            "on the way it is tilted"
        );
        navigator.stop(&mut camera, &around());
        assert_eq!(UpAxis::exactly(&camera), Some(UpAxis::Y));
        assert!((camera.distance() / tilted.distance() - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_glide_ends_by_itself() {
        let (mut navigator, mut camera) = (Navigator::default(), framed());
        let glide = Glide::from_release(GlideKind::Turn, [1.0, 0.0]).expect("fast");
        navigator.glide(glide);
        let passes = run(&mut navigator, &mut camera);
        assert!(passes <= 10, "{passes} passes of a tenth of a second");
        assert!(camera.eye.x < -0.1, "turned to {}", camera.eye);
    }

    #[test]
    fn the_level_axis_is_remembered_through_a_roll() {
        let (mut navigator, mut camera) = (Navigator::default(), framed());
        navigator.carry_out(&mut camera, CameraMove::Upwards(UpAxis::Z), &around());
        run(&mut navigator, &mut camera);
        camera.orbit_free(0.0, 0.0, 1.5);
        let pan = CameraMove::Pan {
            right: 0.1,
            up: 0.0,
        };
        navigator.carry_out(&mut camera, pan, &around());
        assert_eq!(navigator.level_axis(), UpAxis::Z);
        assert_eq!(navigator.level_axis().direction(), DVec3::Z);
    }
}
