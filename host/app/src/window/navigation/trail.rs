//! Where the pointer was lately in a drag, and so how fast it went when it was let go of.
//!
//! The toolkit's own speed wants three passes within a tenth of a second, which a window that draws in software does not make.

use egui::{Pos2, Vec2};

/// The time that counts, seconds: a pointer that rested for as long has no speed.
const WINDOW_SECS: f64 = 0.15;

/// Places with their times, seconds; all but the first within the window.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Trail(Vec<(f64, Pos2)>);

impl Trail {
    /// Notes where the pointer is.
    pub(crate) fn add(&mut self, now: f64, at: Pos2) {
        self.0.push((now, at));
        let old = self
            .0
            .iter()
            .take_while(|(time, _)| *time <= now - WINDOW_SECS);
        // One at the window's beginning or before it stays.
        let gone = old.count().saturating_sub(1);
        self.0.drain(..gone);
    }

    /// Points a second over the window until the last place.
    pub(crate) fn velocity(&self) -> Vec2 {
        let (Some((began, from)), Some((ended, to))) = (self.0.first(), self.0.last()) else {
            return Vec2::ZERO;
        };
        let secs = (ended - began) as f32;
        if secs > 0.0 {
            (*to - *from) / secs
        } else {
            Vec2::ZERO
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{pos2, vec2};

    /// A pointer that goes 300 points a second to the right, seen at these times.
    fn seen_at(times: &[f64]) -> Trail {
        let mut trail = Trail::default();
        for time in times {
            trail.add(*time, pos2(300.0 * *time as f32, 7.0));
        }
        trail
    }

    #[test]
    fn the_speed_is_the_same_at_any_rate_of_passes() {
        let smooth: Vec<f64> = (0..60).map(|pass| f64::from(pass) / 60.0).collect();
        for times in [&smooth[..], &[0.0, 0.4], &[0.0, 0.09, 0.18, 0.27]] {
            let off = seen_at(times).velocity() - vec2(300.0, 0.0);
            assert!(off.length() < 0.5, "{times:?}: {off:?}");
        }
    }

    #[test]
    fn a_pointer_that_rested_has_none() {
        let mut trail = seen_at(&[0.0, 0.05, 0.1]);
        trail.add(0.5, pos2(30.0, 7.0));
        assert_eq!(trail.velocity(), Vec2::ZERO);
        assert_eq!(Trail::default().velocity(), Vec2::ZERO);
        assert_eq!(seen_at(&[1.0]).velocity(), Vec2::ZERO);
    }
}
