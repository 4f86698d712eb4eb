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

mod cubic;
mod knots;

use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

use super::between::{Level, SAME_DIRECTION_RAD, narrow};
use super::{Camera, Projection};
use cubic::{Cubic, turned};
use knots::{AZIMUTH, DISTANCE, FAR, HEIGHT, Knot, NEAR, POLAR, set_rates};

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

#[cfg(test)]
mod tests;
