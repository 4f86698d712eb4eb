//! The user's habits in moving the camera. Plain data, kept from one start to the next.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

/// The factors on the flying speed that can be chosen.
pub(crate) const FLY_SPEEDS: RangeInclusive<f64> = 0.01..=100.0;

/// How the camera answers to pointer and keys.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct NavigationOptions {
    /// The horizon stays level; otherwise the scene turns freely and can roll.
    pub(crate) turntable: bool,
    /// A drag that is let go of in motion glides on.
    pub(crate) inertia: bool,
    /// The camera flies to another view; otherwise it is there at once.
    pub(crate) flights: bool,
    /// What two fingers on a trackpad do.
    pub(crate) scroll: ScrollAction,
    /// Factor on the speed of flying, within [`FLY_SPEEDS`].
    pub(crate) fly_speed: f64,
    /// Whether a corner of the picture shows the axes and the lights.
    pub(crate) gizmo: bool,
}

/// What two fingers that scroll do; a wheel's notches always zoom.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum ScrollAction {
    /// Zoom to the pointer.
    #[default]
    Zoom,
    /// Turn around the pivot.
    Turn,
    /// Shift the scene.
    Shift,
}

impl Default for NavigationOptions {
    fn default() -> Self {
        Self {
            turntable: true,
            inertia: false,
            flights: true,
            scroll: ScrollAction::default(),
            fly_speed: 1.0,
            gizmo: true,
        }
    }
}

impl ScrollAction {
    /// All, with their names.
    pub(crate) const ALL: [(Self, &'static str); 3] = [
        (Self::Zoom, "zoom"),
        (Self::Turn, "turn"),
        (Self::Shift, "shift"),
    ];
}

impl NavigationOptions {
    /// The same with another speed of flying, kept within [`FLY_SPEEDS`]; a factor that is no number changes nothing.
    #[must_use]
    pub(crate) fn with_speed_times(mut self, factor: f64) -> Self {
        let wanted = self.fly_speed * factor;
        if wanted.is_finite() {
            self.fly_speed = wanted.clamp(*FLY_SPEEDS.start(), *FLY_SPEEDS.end());
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_speed_stays_within_reason() {
        let options = NavigationOptions::default();
        assert_eq!(options.with_speed_times(1e9).fly_speed, 100.0);
        assert_eq!(options.with_speed_times(0.0).fly_speed, 0.01);
        assert_eq!(options.with_speed_times(f64::NAN).fly_speed, 1.0);
    }

    #[test]
    fn what_a_file_lacks_takes_its_default() {
        let options: NavigationOptions =
            serde_json::from_str("{\"inertia\": true, \"scroll\": \"turn\"}").expect("readable");
        let expected = NavigationOptions {
            inertia: true,
            scroll: ScrollAction::Turn,
            ..NavigationOptions::default()
        };
        assert_eq!(options, expected);
    }
}
