//! How long pictures take: drawn to their end, clocked, and summed up.

use std::time::Duration;

use pointstage_engine::stage::{FrameRequest, FrameResult, Notice, Stage};
use serde::Serialize;

use crate::cli::drawing::{self, Cost};
use crate::cli::{Failure, Outcome};

/// Draws until the picture does not refine any more, and says what it cost. Fails if another renderer stood in: its picture
/// and its time would go under a wrong name.
pub(crate) fn draw(stage: &mut Stage, request: &FrameRequest) -> Outcome<(FrameResult, Cost)> {
    let (result, cost) = drawing::draw_in_silence(stage, request)?;
    check_drawer(&request.renderer, &result.drawn_by, &result.notices)?;
    result.notices.iter().for_each(drawing::say);
    Ok((result, cost))
}

fn check_drawer(asked: &str, drawn_by: &str, notices: &[Notice]) -> Outcome {
    if drawn_by == asked {
        return Ok(());
    }
    let said: Vec<&str> = notices.iter().map(|notice| notice.text.as_str()).collect();
    Err(Failure::Failed(anyhow::anyhow!(
        "renderer '{asked}' did not draw, '{drawn_by}' stood in for it, so nothing is compared: {}",
        said.join("; ")
    )))
}

/// Milliseconds.
pub(crate) fn millis(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// Times of several pictures, ms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Spread {
    /// Half of the pictures took no longer.
    pub(crate) median: f64,
    /// 95 of 100 took no longer.
    pub(crate) p95: f64,
    /// 99 of 100 took no longer.
    pub(crate) p99: f64,
}

impl Spread {
    /// Of these times, by nearest rank, so that each number is a time that was measured; none of nothing.
    pub(crate) fn of(times_ms: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut times: Vec<f64> = times_ms.into_iter().collect();
        times.sort_by(f64::total_cmp);
        let at = |percent: usize| {
            let rank = (times.len() * percent).div_ceil(100).max(1);
            times.get(rank - 1).copied()
        };
        Some(Self {
            median: at(50)?,
            p95: at(95)?,
            p99: at(99)?,
        })
    }
}

/// Where the times of the device come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Clock {
    /// The sum of the passes, by timestamps of the device.
    Timestamps,
    /// The program's clock around submission and completion.
    WallClock,
}

/// What several pictures cost.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Times {
    /// Pictures that count.
    pub(crate) frames: usize,
    /// From the request to the picture in memory.
    pub(crate) frame_ms: Spread,
    /// Within the renderer's code on the CPU.
    pub(crate) cpu_ms: Spread,
    /// On the device; none for renderers on the CPU.
    pub(crate) gpu_ms: Option<Spread>,
    /// What `gpu_ms` was measured with.
    pub(crate) gpu_clock: Option<Clock>,
}

impl Times {
    /// Of these pictures; none of none.
    pub(crate) fn of(costs: &[Cost]) -> Option<Self> {
        let spread = |part: fn(&Cost) -> Duration| Spread::of(costs.iter().map(part).map(millis));
        // One clock for all of them, so that they can be compared.
        let clock = if !costs.is_empty() && costs.iter().all(|cost| cost.passes.is_some()) {
            Some(Clock::Timestamps)
        } else if costs.iter().any(|cost| !cost.device_wall.is_zero()) {
            Some(Clock::WallClock)
        } else {
            None
        };
        let gpu_ms = match clock {
            Some(Clock::Timestamps) => spread(|cost| cost.passes.unwrap_or_default()),
            Some(Clock::WallClock) => spread(|cost| cost.device_wall),
            None => None,
        };
        Some(Self {
            frames: costs.len(),
            frame_ms: spread(|cost| cost.wall)?,
            cpu_ms: spread(|cost| cost.plugin_cpu)?,
            gpu_ms,
            gpu_clock: clock,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pointstage_engine::stage::Severity;

    #[test]
    fn a_stand_in_is_a_failure_with_the_reason() {
        let notice = Notice {
            severity: Severity::Error,
            plugin: "a".to_owned(),
            text: "out of memory".to_owned(),
            detail: String::new(),
        };
        check_drawer("a", "a", std::slice::from_ref(&notice)).expect("it drew itself");
        match check_drawer("a", "b", &[notice]) {
            Err(Failure::Failed(error)) => {
                let text = error.to_string();
                assert!(text.contains("'a' did not draw, 'b' stood in"), "{text}");
                assert!(text.contains("out of memory"), "{text}");
            }
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn percentiles_are_times_that_were_measured() {
        let spread = Spread::of((1..=200).rev().map(f64::from)).expect("times");
        assert_eq!(
            [spread.median, spread.p95, spread.p99],
            [100.0, 190.0, 198.0]
        );
        let one = Spread::of([7.0]).expect("a time");
        assert_eq!([one.median, one.p95, one.p99], [7.0; 3]);
        assert_eq!(Spread::of([]), None);
    }

    #[test]
    fn the_clock_of_the_device_is_said_and_one_for_all() {
        let cost = |passes: Option<u64>, wall: u64| Cost {
            wall: Duration::from_millis(9),
            plugin_cpu: Duration::from_millis(1),
            device_wall: Duration::from_millis(wall),
            passes: passes.map(Duration::from_millis),
        };
        let of = |costs: &[Cost]| {
            let times = Times::of(costs).expect("pictures");
            (times.gpu_clock, times.gpu_ms.map(|gpu| gpu.median))
        };
        assert_eq!(
            of(&[cost(Some(3), 5)]),
            (Some(Clock::Timestamps), Some(3.0))
        );
        assert_eq!(
            of(&[cost(Some(3), 5), cost(None, 5)]),
            (Some(Clock::WallClock), Some(5.0))
        );
        assert_eq!(of(&[cost(None, 0)]), (None, None));
        assert_eq!(Times::of(&[]), None);
    }
}
