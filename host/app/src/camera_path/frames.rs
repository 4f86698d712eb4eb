//! Which pictures a film of a path has.

use std::ops::RangeInclusive;

/// Pictures a second where nothing is said.
pub(crate) const DEFAULT_FPS: f64 = 30.0;

/// The fewest and the most pictures a second.
pub(crate) const FPS: RangeInclusive<f64> = 0.01..=1000.0;

/// The most pictures of a film: numbers of seven digits still sort in a folder, and nobody waits for more.
const MOST_FRAMES: u32 = 1_000_000;

/// What is lost in rounding when seconds are multiplied by pictures a second.
const ROUNDING: f64 = 1e-6;

/// The times of a film's pictures: the first at 0, then one every 1/fps seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FrameTimes {
    /// How many there are; at least 1.
    pub(crate) count: u32,
    fps: f64,
}

impl FrameTimes {
    /// The time of a picture, from 0, seconds.
    pub(crate) fn at(self, index: u32) -> f64 {
        f64::from(index) / self.fps
    }
}

/// The pictures of a film of `duration_s` seconds. The last one shows the end; where that `is_closed`, which means that it is
/// as the beginning, it is left out, so that a film that is played again and again does not show it twice.
///
/// # Errors
/// There are more than a million.
pub(crate) fn frame_times(
    duration_s: f64,
    fps: f64,
    is_closed: bool,
) -> Result<FrameTimes, String> {
    let steps = (duration_s * fps + ROUNDING).floor();
    let most = f64::from(MOST_FRAMES - 1);
    if !(0.0..=most).contains(&steps) {
        return Err(format!(
            "{duration_s} s at {fps} pictures a second: expected at most {MOST_FRAMES} pictures; choose fewer a second"
        ));
    }
    // What is left of the last step is shown by no picture, so a closed film that does not fit keeps its last one.
    let fits = (duration_s * fps - steps).abs() <= ROUNDING;
    let steps = steps as u32;
    let count = if is_closed && fits { steps } else { steps + 1 };
    Ok(FrameTimes {
        count: count.max(1),
        fps,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_open_film_shows_its_end_and_a_closed_one_not_twice() {
        for (duration, fps, is_closed, count) in [
            (4.0, 30.0, false, 121),
            (4.0, 30.0, true, 120),
            // 0.1 · 30 is not quite 3.
            (0.1, 30.0, true, 3),
            (0.7, 10.0, false, 8),
            (1.05, 10.0, true, 11),
            (0.0, 30.0, true, 1),
            (0.0, 30.0, false, 1),
        ] {
            let times = frame_times(duration, fps, is_closed).expect("few pictures");
            assert_eq!(
                times.count, count,
                "{duration} s at {fps}, closed {is_closed}"
            );
        }
        let times = frame_times(4.0, 30.0, false).expect("few pictures");
        assert_eq!((times.at(0), times.at(60), times.at(120)), (0.0, 2.0, 4.0));
    }

    #[test]
    fn a_film_that_nobody_waits_for_is_refused() {
        let error = frame_times(86_400.0, 1000.0, false).expect_err("too many");
        assert!(error.contains("at most 1000000 pictures"), "{error}");
        assert!(frame_times(f64::INFINITY, 30.0, true).is_err());
    }
}
