//! The glide after a drag that was let go of in motion.
//!
//! The speed falls as v(t) = v₀·(1 − t/T)², to nothing at T; the way until t is v₀·T/3·(1 − (1 − t/T)³). Each pass moves by
//! the way since the pass before, so the glide ends at the same place at any frame rate.

use super::moves::CameraMove;

/// How long a glide takes, seconds.
const GLIDE_SECS: f64 = 0.8;

/// Slower drags stop where they are let go of, picture heights a second.
const LEAST_SPEED: f64 = 0.1;

/// What glides on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum GlideKind {
    /// The turn around the pivot.
    Turn,
    /// The shift of the scene.
    Pan,
}

/// A drag that goes on by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Glide {
    kind: GlideKind,
    /// To the right and upwards at the start, picture heights a second.
    velocity: [f64; 2],
    /// When the first pass saw it, and the part of the way gone by then and since.
    clock: Option<(f64, f64)>,
}

impl Glide {
    /// A glide from a drag's last velocity, picture heights a second; `None` if that was slow.
    pub(crate) fn from_release(kind: GlideKind, velocity: [f64; 2]) -> Option<Self> {
        let speed = velocity[0].hypot(velocity[1]);
        let is_fast = speed.is_finite() && speed > LEAST_SPEED;
        is_fast.then_some(Self {
            kind,
            velocity,
            clock: None,
        })
    }

    /// The move since the last call, and whether it was the last one. `now` is in seconds.
    pub(crate) fn advance(&mut self, now: f64) -> (CameraMove, bool) {
        let (started, gone) = self.clock.unwrap_or((now, 0.0));
        let left = (1.0 - (now - started) / GLIDE_SECS).clamp(0.0, 1.0);
        let reached = GLIDE_SECS / 3.0 * (1.0 - left.powi(3));
        self.clock = Some((started, reached));
        let [right, up] = self.velocity.map(|speed| speed * (reached - gone));
        let camera_move = match self.kind {
            GlideKind::Turn => CameraMove::Drag { right, up },
            GlideKind::Pan => CameraMove::Pan { right, up },
        };
        (camera_move, left <= 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs a glide at a frame rate: the way to the right and the time until its end.
    fn glide_at(rate: f64) -> (f64, f64) {
        let mut glide = Glide::from_release(GlideKind::Pan, [2.0, 0.0]).expect("fast");
        let (mut way, mut frame) = (0.0, 0.0);
        loop {
            let now = 100.0 + frame / rate;
            let (CameraMove::Pan { right, .. }, is_last) = glide.advance(now) else {
                panic!("a pan became something else")
            };
            way += right;
            if is_last {
                return (way, now - 100.0);
            }
            frame += 1.0;
        }
    }

    #[test]
    fn a_glide_ends_within_a_second_at_the_same_place_at_any_rate() {
        let (expected, _) = glide_at(1000.0);
        for rate in [5.0, 24.0, 60.0, 144.0] {
            let (way, secs) = glide_at(rate);
            assert!((way - expected).abs() < 1e-9, "{way} at {rate} Hz");
            assert!(secs <= 1.0, "{secs} s at {rate} Hz");
        }
    }

    #[test]
    fn a_slow_release_stops_at_once() {
        assert_eq!(Glide::from_release(GlideKind::Turn, [0.01, 0.02]), None);
        assert_eq!(Glide::from_release(GlideKind::Turn, [f64::NAN, 2.0]), None);
    }
}
