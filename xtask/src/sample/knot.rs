//! The snake's spine: a trefoil knot, run through at even speed, with a frame that closes.

use std::f64::consts::TAU;

use super::vector::Vector;

/// Steps of the table that turns arc length into the curve's parameter; the error between them is below 1e-6.
const TABLE_STEPS: usize = 8192;

/// The trefoil (sin t + 2 sin 2t, cos t − 2 cos 2t, −sin 3t).
pub(super) struct Knot {
    /// Arc length from the start to each step of the parameter.
    lengths: Vec<f64>,
}

/// The spine at one place.
pub(super) struct Frame {
    pub(super) centre: Vector,
    /// Unit, outward in the plane across the spine.
    pub(super) side: Vector,
    /// Unit, as far up (z) as the plane across the spine allows.
    pub(super) up: Vector,
}

impl Knot {
    pub(super) fn new() -> Self {
        let step = TAU / TABLE_STEPS as f64;
        let mut lengths = vec![0.0];
        let mut length = 0.0;
        for index in 0..TABLE_STEPS {
            length += velocity((index as f64 + 0.5) * step).length() * step;
            lengths.push(length);
        }
        Self { lengths }
    }

    /// Length of the whole curve.
    pub(super) fn length(&self) -> f64 {
        self.lengths.last().copied().unwrap_or_default()
    }

    /// The frame at `along`, in turns: 0 and 1 are the same place.
    pub(super) fn frame(&self, along: f64) -> Frame {
        let t = self.parameter(along.rem_euclid(1.0) * self.length());
        let (sin, cos) = t.sin_cos();
        let (sin2, cos2) = (2.0 * t).sin_cos();
        let centre = Vector(sin + 2.0 * sin2, cos - 2.0 * cos2, -(3.0 * t).sin());
        let tangent = velocity(t).normalized();
        // |velocity| in the plane is at least 3, so the tangent is never vertical and this frame is smooth everywhere.
        let vertical = Vector(0.0, 0.0, 1.0);
        let up = (vertical - tangent * tangent.dot(vertical)).normalized();
        Frame {
            centre,
            side: up.cross(tangent),
            up,
        }
    }

    fn parameter(&self, length: f64) -> f64 {
        let above = self
            .lengths
            .partition_point(|&value| value < length)
            .clamp(1, TABLE_STEPS);
        let (low, high) = (self.lengths[above - 1], self.lengths[above]);
        ((above - 1) as f64 + (length - low) / (high - low)) * TAU / TABLE_STEPS as f64
    }
}

fn velocity(t: f64) -> Vector {
    Vector(
        t.cos() + 4.0 * (2.0 * t).cos(),
        4.0 * (2.0 * t).sin() - t.sin(),
        -3.0 * (3.0 * t).cos(),
    )
}
