//! What the pictures of the last seconds took, part by part.

use std::collections::{BTreeMap, VecDeque};
use std::time::{Duration, Instant};

use pointstage_engine::stage::FrameStats;

/// How far back is looked.
pub(crate) const SPAN: Duration = Duration::from_secs(10);

/// The pictures of the last [`SPAN`]; the last one at least.
#[derive(Debug, Default)]
pub(crate) struct FrameLog {
    frames: VecDeque<(Instant, FrameCost)>,
}

/// What one picture took.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FrameCost {
    /// The whole frame, by wall clock.
    pub(crate) total: Duration,
    /// Inside the renderer, on the CPU.
    pub(crate) cpu: Duration,
    /// From submission to completion on the device, by wall clock.
    pub(crate) device: Duration,
    /// By the device's own timestamps, pass by pass.
    pub(crate) passes: Vec<(String, Duration)>,
    /// Held on the device: by the renderer, by the scene, by the view's targets, bytes.
    pub(crate) bytes: [u64; 3],
}

/// What some durations say together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Spread {
    /// Half of them are shorter.
    pub(crate) median: Duration,
    /// One in twenty is longer.
    pub(crate) p95: Duration,
}

impl FrameLog {
    /// Notes a picture.
    pub(crate) fn note(&mut self, stats: &FrameStats, now: Instant) {
        let cost = FrameCost {
            total: stats.total,
            cpu: stats.plugin_cpu,
            device: stats.device_wall,
            passes: stats
                .passes
                .iter()
                .map(|pass| (pass.label.clone(), pass.time))
                .collect(),
            bytes: [stats.plugin_bytes, stats.scene_bytes, stats.target_bytes],
        };
        self.frames.push_back((now, cost));
        while self.frames.len() > 1
            && let Some((at, _)) = self.frames.front()
            && now >= *at + SPAN
        {
            self.frames.pop_front();
        }
    }

    /// The pictures with how long ago they came, from the oldest on.
    pub(crate) fn frames(&self, now: Instant) -> impl Iterator<Item = (Duration, &FrameCost)> {
        let frames = self.frames.iter();
        frames.map(move |(at, cost)| (now.saturating_duration_since(*at), cost))
    }

    /// The last picture's cost.
    pub(crate) fn last(&self) -> Option<&FrameCost> {
        self.frames.back().map(|(_, cost)| cost)
    }

    /// Median and 95th percentile of a part of the cost.
    pub(crate) fn spread(&self, part: impl Fn(&FrameCost) -> Duration) -> Option<Spread> {
        spread(self.frames.iter().map(|(_, cost)| part(cost)).collect())
    }

    /// The same of each pass on the device, in the order in which they were first seen.
    pub(crate) fn passes(&self) -> Vec<(&str, Spread)> {
        let mut order: Vec<&str> = Vec::new();
        let mut times: BTreeMap<&str, Vec<Duration>> = BTreeMap::new();
        for (name, time) in self.frames.iter().flat_map(|(_, cost)| &cost.passes) {
            let of_pass = times.entry(name).or_default();
            if of_pass.is_empty() {
                order.push(name);
            }
            of_pass.push(*time);
        }
        let spreads = order.into_iter();
        spreads
            .filter_map(|name| Some((name, spread(times.remove(name)?)?)))
            .collect()
    }
}

/// By the nearest rank; `None` of nothing.
pub(crate) fn spread(mut times: Vec<Duration>) -> Option<Spread> {
    times.sort_unstable();
    let last = times.len().checked_sub(1)?;
    let rank = |part: f64| times[((last as f64 * part).ceil() as usize).min(last)];
    Some(Spread {
        median: rank(0.5),
        p95: rank(0.95),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(millis: u64) -> FrameStats {
        FrameStats {
            total: Duration::from_millis(millis),
            plugin_cpu: Duration::from_millis(1),
            ..FrameStats::default()
        }
    }

    #[test]
    fn old_pictures_are_forgotten_but_the_last_one_stays() {
        let (mut log, start) = (FrameLog::default(), Instant::now());
        log.note(&frame(900), start);
        for number in 1..=20 {
            log.note(&frame(number), start + SPAN);
        }
        let total = log.spread(|cost| cost.total).expect("twenty pictures");
        assert_eq!(total.median, Duration::from_millis(11));
        assert_eq!(total.p95, Duration::from_millis(20));
        log.note(&frame(7), start + SPAN * 3);
        assert_eq!(log.frames(start + SPAN * 4).count(), 1);
        assert_eq!(log.last().map(|cost| cost.total.as_millis()), Some(7));
    }
}
