//! A flight: the camera on its way to another view.

use pointstage_scene::Camera;

/// How long a flight takes, seconds.
const FLIGHT_SECS: f64 = 0.4;

/// A camera on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Flight {
    from: Camera,
    to: Camera,
    /// When the first pass saw it, seconds: what the picture waited for before is not part of the flight.
    started: Option<f64>,
}

impl Flight {
    /// The flight between two views.
    pub(crate) fn new(from: Camera, to: Camera) -> Self {
        Self {
            from,
            to,
            started: None,
        }
    }

    /// The view at its end.
    pub(crate) fn target(&self) -> Camera {
        self.to
    }

    /// The view at the time `now`, seconds, and whether it is the last one: exactly the target.
    pub(crate) fn advance(&mut self, now: f64) -> (Camera, bool) {
        let started = *self.started.get_or_insert(now);
        let part = (now - started) / FLIGHT_SECS;
        (self.from.between(&self.to, eased(part)), part >= 1.0)
    }
}

/// Slow at both ends: 3t² − 2t³.
fn eased(part: f64) -> f64 {
    let part = part.clamp(0.0, 1.0);
    part * part * (3.0 - 2.0 * part)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flight() -> Flight {
        let mut to = Camera::default();
        to.orbit_turntable(3.0, 0.4);
        to.dolly(0.3);
        Flight::new(Camera::default(), to)
    }

    #[test]
    fn a_flight_begins_where_it_is_and_ends_exactly_at_its_target() {
        let mut flight = flight();
        assert_eq!(flight.advance(50.0), (Camera::default(), false));
        let (half, is_last) = flight.advance(50.0 + FLIGHT_SECS / 2.0);
        assert!(!is_last && half != Camera::default() && half != flight.target());
        assert_eq!(flight.advance(50.5), (flight.target(), true));
    }

    #[test]
    fn a_flight_takes_its_time_at_any_frame_rate() {
        for rate in [3.0, 60.0, 500.0] {
            let mut flight = flight();
            let mut frame = 0.0;
            while !flight.advance(frame / rate).1 {
                frame += 1.0;
            }
            let secs = frame / rate;
            assert!(secs < FLIGHT_SECS + 1.01 / rate, "{secs} s at {rate} Hz");
        }
    }

    #[test]
    fn both_ends_are_slow() {
        let speeds = [0.0, 0.5, 0.99].map(|part| eased(part + 0.01) - eased(part));
        assert!(speeds[1] > 10.0 * speeds[0].max(speeds[2]), "{speeds:?}");
    }
}
