//! What lies between two views whose rates are known.

use glam::{DQuat, DVec3};

use super::knots::Knot;

/// The weights of a cubic between two values with given rates.
pub(super) struct Cubic {
    values: [f64; 2],
    rates: [f64; 2],
}

impl Cubic {
    pub(super) fn at(part: f64, secs: f64) -> Self {
        let (square, cube) = (part * part, part * part * part);
        let end = 3.0 * square - 2.0 * cube;
        Self {
            values: [1.0 - end, end],
            rates: [secs * (cube - 2.0 * square + part), secs * (cube - square)],
        }
    }

    pub(super) fn number(&self, values: [f64; 2], rates: [f64; 2]) -> f64 {
        // From the first value on, so that what does not change stays to the last bit.
        values[0]
            + (values[1] - values[0]) * self.values[1]
            + rates[0] * self.rates[0]
            + rates[1] * self.rates[1]
    }

    pub(super) fn point(&self, points: [DVec3; 2], rates: [DVec3; 2]) -> DVec3 {
        points[0]
            + (points[1] - points[0]) * self.values[1]
            + rates[0] * self.rates[0]
            + rates[1] * self.rates[1]
    }
}

/// A cubic Bézier curve of rotations, cumulative form (Kim, Kim and Shin 1995, section 4).
pub(super) fn turned(from: &Knot, to: &Knot, secs: f64, part: f64) -> DQuat {
    let (first, last) = (from.spin * (secs / 3.0), to.spin * (secs / 3.0));
    let whole = from.rotation.inverse() * to.rotation;
    let middle = DQuat::from_scaled_axis(-first) * whole * DQuat::from_scaled_axis(-last);
    let middle = axis_times_angle(middle);
    let rest = 1.0 - part;
    let weights = [
        1.0 - rest * rest * rest,
        part * part * (3.0 - 2.0 * part),
        part * part * part,
    ];
    let turn = from.rotation
        * DQuat::from_scaled_axis(first * weights[0])
        * DQuat::from_scaled_axis(middle * weights[1])
        * DQuat::from_scaled_axis(last * weights[2]);
    turn.normalize()
}

/// The rotation's axis times its angle, at most π.
pub(super) fn axis_times_angle(rotation: DQuat) -> DVec3 {
    let rotation = if rotation.w < 0.0 {
        -rotation
    } else {
        rotation
    };
    rotation.to_scaled_axis()
}
