//! How long the pictures of the last two seconds took, and how many there were.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use super::comparison::{Spread, spread};

/// How far back is looked.
const SPAN: Duration = Duration::from_secs(2);

/// The pictures of the last two seconds.
#[derive(Debug, Default)]
pub(crate) struct FrameTimes {
    arrivals: VecDeque<(Instant, Duration)>,
}

/// What they say together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FrameSummary {
    /// Half of them took less.
    pub(crate) median: Duration,
    /// One in twenty took longer.
    pub(crate) p95: Duration,
    /// Pictures a second, from the first to the last; none with fewer than three.
    pub(crate) rate: Option<f64>,
}

impl FrameTimes {
    /// Notes a picture that took `time`.
    pub(crate) fn note(&mut self, time: Duration, now: Instant) {
        self.forget_old(now);
        self.arrivals.push_back((now, time));
    }

    /// What the pictures of the last two seconds say; `None` if there were none.
    pub(crate) fn summary(&mut self, now: Instant) -> Option<FrameSummary> {
        self.forget_old(now);
        let Spread { median, p95 } = spread(self.arrivals.iter().map(|(_, time)| *time).collect())?;
        let last = self.arrivals.len() - 1;
        let (first_at, last_at) = (self.arrivals.front()?.0, self.arrivals.back()?.0);
        let span = (last_at - first_at).as_secs_f64();
        Some(FrameSummary {
            median,
            p95,
            rate: (last >= 2 && span > 0.0).then(|| last as f64 / span),
        })
    }

    /// When the summary changes by itself: the oldest picture leaves it.
    pub(crate) fn next_change(&self, now: Instant) -> Option<Duration> {
        // One look when all have left is enough; nobody watches single ones go.
        let (at, _) = self.arrivals.back()?;
        Some((*at + SPAN).saturating_duration_since(now))
    }

    fn forget_old(&mut self, now: Instant) {
        while let Some((at, _)) = self.arrivals.front()
            && now >= *at + SPAN
        {
            self.arrivals.pop_front();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn millis(millis: u64) -> Duration {
        Duration::from_millis(millis)
    }

    #[test]
    fn median_p95_and_rate_are_of_the_last_two_seconds() {
        let (mut times, start) = (FrameTimes::default(), Instant::now());
        times.note(millis(900), start);
        for number in 1..=20 {
            times.note(millis(number), start + millis(1000 + 50 * number));
        }
        let now = start + millis(2100);
        let summary = times.summary(now).expect("twenty pictures");
        assert_eq!(summary.median, millis(11));
        assert_eq!(summary.p95, millis(20));
        let rate = summary.rate.expect("many");
        assert!((rate - 20.0).abs() < 1e-6, "{rate}");
    }

    #[test]
    fn after_two_seconds_nothing_is_said() {
        let (mut times, start) = (FrameTimes::default(), Instant::now());
        times.note(millis(5), start);
        assert_eq!(times.next_change(start), Some(SPAN));
        assert!(times.summary(start + millis(1999)).is_some());
        assert_eq!(times.summary(start + SPAN), None);
        assert_eq!(times.next_change(start + SPAN), None);
    }
}
