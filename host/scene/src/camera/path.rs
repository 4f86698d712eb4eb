//! A camera's path: through views at their times, smoothly.
//!
//! ```text
//! pivot (or eye)                  cubic, with the rate of a parabola through the neighbours at each view
//! distance, height, near, far     their logarithms, monotone cubic: never beyond the two views that they are between
//! direction                       azimuth and polar angle, monotone cubic, where all views have one `up`: the horizon stays level
//!                                 else a cubic of rotations, which turns at one rate before and behind each view
//! ```
//!
//! The rate of change is continuous at every view. The camera rests at the first and at the last one, unless both are the
//! same view: then the path is closed and goes on through it. On a stretch that is [`Easing::Linear`] it goes at an even
//! pace, as a flight between two views does ([`Camera::between`]), and the stretches beside it begin and end at that pace.
//!
//! sources: Fritsch and Butland, A method for constructing local monotone piecewise cubic interpolants, SIAM J. Sci. Stat.
//! Comput. 5(2), 1984; Kim, Kim and Shin, A general construction scheme for unit quaternion curves with simple high order
//! derivatives, SIGGRAPH 1995.

use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

use super::between::{Level, SAME_DIRECTION_RAD, narrow, nearest_turn, rotation};
use super::{Camera, Projection};

/// How the camera goes on from a view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Easing {
    /// Without a jump in its speed.
    #[default]
    Smooth,
    /// At an even pace.
    Linear,
}

/// A view at its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraKey {
    /// Seconds from the path's beginning.
    pub time_s: f64,
    /// The view.
    pub camera: Camera,
    /// How the camera goes on to the next one.
    pub easing: Easing,
}

/// Keys that make no path.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CameraPathError {
    /// There is none.
    #[error("the path has no views; expected at least one")]
    Empty,
    /// A time that is none.
    #[error("view {number} of the path: expected a time from 0 s, found {found} s")]
    Time {
        /// Which one, from 1.
        number: usize,
        /// Its time, seconds.
        found: f64,
    },
    /// A view that does not come after the one before it.
    #[error(
        "view {number} of the path is at {found} s, the one before it at {before} s; expected times that rise"
    )]
    Order {
        /// Which one, from 1.
        number: usize,
        /// Its time, seconds.
        found: f64,
        /// That of the one before, seconds.
        before: f64,
    },
}

/// A path through views at their times.
#[derive(Clone, Debug)]
pub struct CameraPath {
    keys: Vec<CameraKey>,
    knots: Vec<Knot>,
    /// Directions are azimuth and polar angle in this frame; rotations if there is none.
    level: Option<Level>,
    /// What `Knot::point` is: the eye, for a camera that looks around, else the pivot.
    holds_eye: bool,
}

/// Places in [`Knot::numbers`].
const DISTANCE: usize = 0;
const HEIGHT: usize = 1;
const NEAR: usize = 2;
const FAR: usize = 3;
const AZIMUTH: usize = 4;
const POLAR: usize = 5;
const NUMBER_COUNT: usize = 6;

/// A view as what is interpolated, with rates per second.
#[derive(Clone, Copy, Debug)]
struct Knot {
    point: DVec3,
    point_rate: DVec3,
    /// Logarithms of sizes, then angles.
    numbers: [f64; NUMBER_COUNT],
    number_rates: [f64; NUMBER_COUNT],
    rotation: DQuat,
    /// In the view's own axes, radians per second.
    spin: DVec3,
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

impl CameraPath {
    /// The path through `keys`.
    ///
    /// # Errors
    /// There are none; a time is negative, infinite or NaN; times do not rise.
    pub fn new(keys: Vec<CameraKey>) -> Result<Self, CameraPathError> {
        check(&keys)?;
        let is_flat =
            |key: &CameraKey| matches!(key.camera.projection, Projection::Orthographic { .. });
        let are_mixed = keys.iter().any(is_flat) && !keys.iter().all(is_flat);
        let cameras: Vec<Camera> = keys
            .iter()
            .map(|key| match key.camera.projection {
                Projection::Orthographic { .. } if are_mixed => narrow(&key.camera),
                _ => key.camera,
            })
            .collect();
        let length = |place: fn(&Camera) -> DVec3| -> f64 {
            let pairs = cameras.windows(2);
            pairs
                .map(|pair| place(&pair[0]).distance(place(&pair[1])))
                .sum()
        };
        let holds_eye = !keys.iter().any(is_flat)
            && length(|camera| camera.eye) < length(|camera| camera.pivot);
        let level = level_of(&cameras);
        let mut knots: Vec<Knot> = cameras
            .iter()
            .map(|camera| Knot::of(camera, level.as_ref(), holds_eye))
            .collect();
        for index in 1..knots.len() {
            let before = knots[index - 1];
            knots[index].follow(&before);
        }
        let is_closed = keys.len() > 2
            && keys.first().map(|key| key.camera) == keys.last().map(|key| key.camera);
        set_rates(&mut knots, &keys, is_closed);
        Ok(Self {
            keys,
            knots,
            level,
            holds_eye,
        })
    }

    /// The views at their times.
    pub fn keys(&self) -> &[CameraKey] {
        &self.keys
    }

    /// The time of the last view, seconds.
    pub fn end_s(&self) -> f64 {
        self.keys.last().map_or(0.0, |key| key.time_s)
    }

    /// The view at a time: exactly that of a key at its time, the first one's before it and the last one's after it.
    pub fn at(&self, time_s: f64) -> Camera {
        let next = self.keys.partition_point(|key| key.time_s <= time_s);
        // `new` has seen to it that there is a first one.
        let Some(index) = next.checked_sub(1) else {
            return self.keys[0].camera;
        };
        let key = &self.keys[index];
        let Some(end) = self.keys.get(next).filter(|_| key.time_s < time_s) else {
            return key.camera;
        };
        let secs = end.time_s - key.time_s;
        let part = (time_s - key.time_s) / secs;
        match key.easing {
            Easing::Linear => key.camera.between(&end.camera, part),
            Easing::Smooth => self.smooth(index, secs, part, end),
        }
    }

    fn smooth(&self, index: usize, secs: f64, part: f64, end: &CameraKey) -> Camera {
        let (from, to) = (&self.knots[index], &self.knots[index + 1]);
        let cubic = Cubic::at(part, secs);
        let number = |place: usize| {
            cubic.number(
                [from.numbers[place], to.numbers[place]],
                [from.number_rates[place], to.number_rates[place]],
            )
        };
        let size = |place: usize| number(place).exp();
        let (back, up) = if let Some(level) = &self.level {
            (level.back(number(AZIMUTH), number(POLAR)), end.camera.up)
        } else {
            let turn = turned(from, to, secs, part);
            (turn * DVec3::Z, turn * DVec3::Y)
        };
        let point = cubic.point([from.point, to.point], [from.point_rate, to.point_rate]);
        let (distance, height) = (size(DISTANCE), size(HEIGHT));
        let (eye, pivot) = if self.holds_eye {
            (point, point - back * distance)
        } else {
            (point + back * distance, point)
        };
        let is_flat =
            |key: &CameraKey| matches!(key.camera.projection, Projection::Orthographic { .. });
        let projection = if self.keys.iter().all(is_flat) {
            Projection::Orthographic { height }
        } else {
            let fov_y_rad = 2.0 * (0.5 * height / distance).atan();
            Projection::Perspective { fov_y_rad }
        };
        Camera {
            eye,
            pivot,
            up,
            projection,
            near: size(NEAR),
            far: size(FAR),
        }
    }
}

impl Camera {
    /// The view after eye, pivot and `up` have turned by `degrees` around an axis through `centre`: to the eye's right if
    /// they are positive and the axis points upwards. Whole turns end where they began, to the last bit.
    #[must_use]
    pub fn turned_around(&self, centre: DVec3, axis: DVec3, degrees: f64) -> Self {
        let degrees = degrees.rem_euclid(360.0);
        let Some(axis) = axis.try_normalize().filter(|_| degrees > 0.0) else {
            return *self;
        };
        let turn = DQuat::from_axis_angle(axis, degrees.to_radians());
        // An `up` along the axis stays what it is.
        let up = if self.up.cross(axis).length() < SAME_DIRECTION_RAD * self.up.length() {
            self.up
        } else {
            turn * self.up
        };
        Self {
            eye: centre + turn * (self.eye - centre),
            pivot: centre + turn * (self.pivot - centre),
            up,
            ..*self
        }
    }
}

fn check(keys: &[CameraKey]) -> Result<(), CameraPathError> {
    if keys.is_empty() {
        return Err(CameraPathError::Empty);
    }
    for (index, key) in keys.iter().enumerate() {
        let (number, found) = (index + 1, key.time_s);
        if !(found.is_finite() && found >= 0.0) {
            return Err(CameraPathError::Time { number, found });
        }
        if let Some(before) = index.checked_sub(1).map(|before| keys[before].time_s)
            && found <= before
        {
            return Err(CameraPathError::Order {
                number,
                found,
                before,
            });
        }
    }
    Ok(())
}

/// The frame in which all views are level, if there is one and none looks along its axis.
fn level_of(cameras: &[Camera]) -> Option<Level> {
    let first = cameras.first()?;
    let axis = first.up.try_normalize()?;
    let is_level = |camera: &Camera| {
        let [_, _, back] = camera.axes_world();
        camera.up.angle_between(axis) < SAME_DIRECTION_RAD
            && axis.angle_between(back).sin() > SAME_DIRECTION_RAD
    };
    let level = Level::new(first, axis);
    cameras.iter().all(is_level).then_some(level)
}

impl Knot {
    fn of(camera: &Camera, level: Option<&Level>, holds_eye: bool) -> Self {
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
    fn follow(&mut self, before: &Self) {
        let azimuth = &mut self.numbers[AZIMUTH];
        *azimuth = before.numbers[AZIMUTH] + nearest_turn(*azimuth - before.numbers[AZIMUTH]);
        if before.rotation.dot(self.rotation) < 0.0 {
            self.rotation = -self.rotation;
        }
    }
}

/// Gives every knot the rates at which the path goes through it.
fn set_rates(knots: &mut [Knot], keys: &[CameraKey], is_closed: bool) {
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

/// The weights of a cubic between two values with given rates.
struct Cubic {
    values: [f64; 2],
    rates: [f64; 2],
}

impl Cubic {
    fn at(part: f64, secs: f64) -> Self {
        let (square, cube) = (part * part, part * part * part);
        let end = 3.0 * square - 2.0 * cube;
        Self {
            values: [1.0 - end, end],
            rates: [secs * (cube - 2.0 * square + part), secs * (cube - square)],
        }
    }

    fn number(&self, values: [f64; 2], rates: [f64; 2]) -> f64 {
        // From the first value on, so that what does not change stays to the last bit.
        values[0]
            + (values[1] - values[0]) * self.values[1]
            + rates[0] * self.rates[0]
            + rates[1] * self.rates[1]
    }

    fn point(&self, points: [DVec3; 2], rates: [DVec3; 2]) -> DVec3 {
        points[0]
            + (points[1] - points[0]) * self.values[1]
            + rates[0] * self.rates[0]
            + rates[1] * self.rates[1]
    }
}

/// A cubic Bézier curve of rotations, cumulative form (Kim, Kim and Shin 1995, section 4).
fn turned(from: &Knot, to: &Knot, secs: f64, part: f64) -> DQuat {
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
fn axis_times_angle(rotation: DQuat) -> DVec3 {
    let rotation = if rotation.w < 0.0 {
        -rotation
    } else {
        rotation
    };
    rotation.to_scaled_axis()
}

#[cfg(test)]
#[path = "path_tests.rs"]
mod tests;
