//! Views as what is interpolated, and the rates at which a path goes through them.

use glam::{DQuat, DVec3};

use super::cubic::axis_times_angle;
use super::{CameraKey, Easing};
use crate::camera::Camera;
use crate::camera::between::{Level, nearest_turn, rotation};

/// Places in [`Knot::numbers`].
pub(super) const DISTANCE: usize = 0;
pub(super) const HEIGHT: usize = 1;
pub(super) const NEAR: usize = 2;
pub(super) const FAR: usize = 3;
pub(super) const AZIMUTH: usize = 4;
pub(super) const POLAR: usize = 5;
const NUMBER_COUNT: usize = 6;

/// A view as what is interpolated, with rates per second.
#[derive(Clone, Copy, Debug)]
pub(super) struct Knot {
    pub(super) point: DVec3,
    pub(super) point_rate: DVec3,
    /// Logarithms of sizes, then angles.
    pub(super) numbers: [f64; NUMBER_COUNT],
    pub(super) number_rates: [f64; NUMBER_COUNT],
    pub(super) rotation: DQuat,
    /// In the view's own axes, radians per second.
    pub(super) spin: DVec3,
}

/// The change over one stretch.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    secs: f64,
    is_linear: bool,
    point: DVec3,
    numbers: [f64; NUMBER_COUNT],
    spin: DVec3,
}

impl Knot {
    pub(super) fn of(camera: &Camera, level: Option<&Level>, holds_eye: bool) -> Self {
        let [_, _, back] = camera.axes_world();
        let mut numbers = [0.0; NUMBER_COUNT];
        numbers[DISTANCE] = camera.distance().ln();
        numbers[HEIGHT] = camera.height_at_pivot().ln();
        numbers[NEAR] = camera.near.ln();
        numbers[FAR] = camera.far.ln();
        if let Some(level) = level {
            numbers[AZIMUTH] = level.azimuth(back);
            numbers[POLAR] = camera.up.angle_between(back);
        }
        Self {
            point: if holds_eye { camera.eye } else { camera.pivot },
            point_rate: DVec3::ZERO,
            numbers,
            number_rates: [0.0; NUMBER_COUNT],
            rotation: rotation(camera),
            spin: DVec3::ZERO,
        }
    }

    /// Reaches its direction from that of the view before by the shortest turn.
    pub(super) fn follow(&mut self, before: &Self) {
        let azimuth = &mut self.numbers[AZIMUTH];
        *azimuth = before.numbers[AZIMUTH] + nearest_turn(*azimuth - before.numbers[AZIMUTH]);
        if before.rotation.dot(self.rotation) < 0.0 {
            self.rotation = -self.rotation;
        }
    }
}

/// Gives every knot the rates at which the path goes through it.
pub(super) fn set_rates(knots: &mut [Knot], keys: &[CameraKey], is_closed: bool) {
    let pairs = knots.windows(2).zip(keys.windows(2));
    let stretches: Vec<Stretch> = pairs
        .map(|(knots, keys)| Stretch::of(&knots[0], &knots[1], &keys[0], &keys[1]))
        .collect();
    let (first, last) = (stretches.first(), stretches.last());
    let count = knots.len();
    for (index, knot) in knots.iter_mut().enumerate() {
        let before = match index.checked_sub(1) {
            Some(before) => stretches.get(before),
            None => last.filter(|_| is_closed),
        };
        let after = if index + 1 < count {
            stretches.get(index)
        } else {
            first.filter(|_| is_closed)
        };
        // Where it begins or ends at rest, the rates are 0 as they are.
        match (before, after) {
            (Some(before), Some(after)) => knot.pass(before, after),
            (Some(only), None) | (None, Some(only)) if only.is_linear => {
                knot.pass(only, only);
            }
            _ => {}
        }
    }
}

impl Stretch {
    fn of(from: &Knot, to: &Knot, start: &CameraKey, end: &CameraKey) -> Self {
        let secs = end.time_s - start.time_s;
        let mut numbers = [0.0; NUMBER_COUNT];
        for (place, rate) in numbers.iter_mut().enumerate() {
            *rate = (to.numbers[place] - from.numbers[place]) / secs;
        }
        Self {
            secs,
            is_linear: start.easing == Easing::Linear,
            point: (to.point - from.point) / secs,
            numbers,
            spin: axis_times_angle(from.rotation.inverse() * to.rotation) / secs,
        }
    }
}

impl Knot {
    /// Takes the rates at which it is passed from one stretch to another.
    fn pass(&mut self, before: &Stretch, after: &Stretch) {
        for (place, rate) in self.number_rates.iter_mut().enumerate() {
            let (rates, secs) = (
                [before.numbers[place], after.numbers[place]],
                [before.secs, after.secs],
            );
            *rate = match (before.is_linear, after.is_linear) {
                (true, _) => limited(rates[0], rates[1]),
                (_, true) => limited(rates[1], rates[0]),
                _ => monotone(rates, secs),
            };
        }
        let of_vectors = |rates: [DVec3; 2]| match (before.is_linear, after.is_linear) {
            (true, _) => rates[0],
            (_, true) => rates[1],
            _ => through(rates, [before.secs, after.secs]),
        };
        self.point_rate = of_vectors([before.point, after.point]);
        self.spin = of_vectors([before.spin, after.spin]);
    }
}

/// The rate between two stretches that keeps a cubic within their ends (Fritsch and Butland, equation 4).
fn monotone([before, after]: [f64; 2], [secs_before, secs_after]: [f64; 2]) -> f64 {
    // Turning round there, or at rest.
    if before * after <= 0.0 {
        return 0.0;
    }
    let weights = [
        secs_before + 2.0 * secs_after,
        2.0 * secs_before + secs_after,
    ];
    (weights[0] + weights[1]) / (weights[0] / before + weights[1] / after)
}

/// A given rate, as far as a cubic on the other side stays within its ends.
fn limited(rate: f64, other: f64) -> f64 {
    if rate * other > 0.0 {
        rate.abs().min(3.0 * other.abs()).copysign(rate)
    } else {
        0.0
    }
}

/// The rate of a parabola through three points; at most three times that of the slower side, so that a camera that waits
/// does not swing.
fn through([before, after]: [DVec3; 2], [secs_before, secs_after]: [f64; 2]) -> DVec3 {
    let rate = (before * secs_after + after * secs_before) / (secs_before + secs_after);
    rate.clamp_length_max(3.0 * before.length().min(after.length()))
}
