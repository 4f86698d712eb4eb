//! How often pictures are drawn, and how long moving ones may take.

use std::time::{Duration, Instant};

use crate::preferences;

/// The fastest rate that a limit or a target may name, pictures a second.
pub(crate) const FASTEST_RATE: u32 = 60;

/// How often pictures are drawn, and how long moving ones may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Pacing {
    /// Most pictures a second, 0 to [`FASTEST_RATE`]; 0 draws only when asked to. `None` for no limit.
    pub(crate) rate_limit: Option<u32>,
    /// Pictures a second that a moving view should reach, 1 to [`FASTEST_RATE`]: the host draws fewer pixels until it does.
    /// `None` always draws every pixel.
    pub(crate) target_rate: Option<u32>,
    /// Whether the main renderer's picture fades in when it takes over from the preview.
    pub(crate) cross_fade: bool,
}

impl Default for Pacing {
    fn default() -> Self {
        preferences::Pacing::default().into()
    }
}

/// The smallest part of its width and height that a moving picture is drawn in.
const LEAST_SCALE: f32 = 0.25;

/// Tells how large moving pictures may be and when the next one may be asked for.
#[derive(Debug)]
pub(crate) struct Pacer {
    asked_at: Option<Instant>,
    /// Moving pictures are drawn in this part of their width and height.
    scale: f32,
    /// The renderer from whose pictures was learnt.
    learnt_from: String,
    /// Time and scale of the last moving picture.
    last: Option<(Duration, f32)>,
    /// Fewer pixels did not make it faster: what takes the time is something else.
    is_useless: bool,
    /// Something waits for its turn.
    is_waiting: bool,
}

impl Default for Pacer {
    fn default() -> Self {
        Self {
            asked_at: None,
            scale: 1.0,
            learnt_from: String::new(),
            last: None,
            is_useless: false,
            is_waiting: false,
        }
    }
}

impl Pacer {
    /// How long the next picture has to wait for the limit's sake; `None` if it need not. A limit of 0 waits for ever.
    pub(crate) fn wait(&mut self, pacing: &Pacing, now: Instant) -> Option<Duration> {
        let wait = match (pacing.rate_limit, self.asked_at) {
            (None, _) | (_, None) => Duration::ZERO,
            (Some(0), _) => Duration::MAX,
            (Some(rate), Some(asked_at)) => {
                let period = Duration::from_secs(1) / rate;
                (asked_at + period).saturating_duration_since(now)
            }
        };
        self.is_waiting = !wait.is_zero() && wait != Duration::MAX;
        (!wait.is_zero()).then_some(wait)
    }

    /// Whether a picture waits for its turn.
    pub(crate) fn is_waiting(&self) -> bool {
        self.is_waiting
    }

    /// Notes that a picture was asked for.
    pub(crate) fn asked(&mut self, now: Instant) {
        self.asked_at = Some(now);
        self.is_waiting = false;
    }

    /// The size in which a moving picture is drawn, px.
    pub(crate) fn moving_size(&self, pacing: &Pacing, size_px: [u32; 2]) -> [u32; 2] {
        match pacing.target_rate {
            Some(_) => size_px.map(|side| ((side as f32 * self.scale).round() as u32).max(1)),
            None => size_px,
        }
    }

    /// Learns from the time that a renderer's moving picture took, drawn in this part of the viewport's height.
    pub(crate) fn took(&mut self, pacing: &Pacing, renderer: &str, time: Duration, scale: f32) {
        if self.learnt_from != renderer {
            self.forget();
            renderer.clone_into(&mut self.learnt_from);
        }
        let Some(rate) = pacing.target_rate else {
            self.forget();
            return;
        };
        let wanted = 1.0 / f64::from(rate.max(1));
        let seconds = time.as_secs_f64().max(1e-6);
        if let Some((before, before_scale)) = self.last
            && scale < 0.8 * before_scale
            && seconds > 0.9 * before.as_secs_f64()
        {
            self.is_useless = true;
        }
        self.last = Some((time, scale));
        if self.is_useless {
            self.scale = 1.0;
        } else if seconds > 1.15 * wanted {
            // Time goes with the pixels, so with the square of the scale; never by more than half at once.
            let factor = (wanted / seconds).sqrt().max(0.5) as f32;
            self.scale = (scale * factor).max(LEAST_SCALE);
        } else if seconds < 0.6 * wanted {
            self.scale = (scale * 1.25).min(1.0);
        }
    }

    fn forget(&mut self) {
        self.scale = 1.0;
        self.last = None;
        self.is_useless = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn target(rate: u32) -> Pacing {
        Pacing {
            target_rate: Some(rate),
            ..Pacing::default()
        }
    }

    /// The scale after many pictures of a renderer that takes `time_of(scale)` seconds.
    fn settled_scale(pacing: &Pacing, time_of: impl Fn(f64) -> f64) -> f32 {
        let mut pacer = Pacer::default();
        for _ in 0..50 {
            let scale = pacer.moving_size(pacing, [1000, 1000])[1] as f32 / 1000.0;
            let time = Duration::from_secs_f64(time_of(f64::from(scale)));
            pacer.took(pacing, "points", time, scale);
        }
        pacer.moving_size(pacing, [1000, 1000])[1] as f32 / 1000.0
    }

    #[test]
    fn a_renderer_bound_by_pixels_reaches_the_target() {
        let scale = settled_scale(&target(30), |scale| 0.1 * scale * scale);
        let time = 0.1 * f64::from(scale * scale);
        assert!(
            (0.6 / 30.0..1.2 / 30.0).contains(&time),
            "{scale}: {time} s"
        );
    }

    #[test]
    fn a_fast_renderer_draws_every_pixel() {
        assert_eq!(settled_scale(&target(30), |_| 0.005), 1.0);
    }

    #[test]
    fn where_fewer_pixels_do_not_help_none_are_given_up() {
        assert_eq!(settled_scale(&target(30), |_| 0.2), 1.0);
    }

    #[test]
    fn without_a_target_the_size_stays() {
        assert_eq!(settled_scale(&Pacing::default(), |_| 0.5), 1.0);
    }

    #[test]
    fn the_limit_spaces_pictures_out() {
        let limited = |rate| Pacing {
            rate_limit: Some(rate),
            ..Pacing::default()
        };
        let (mut pacer, now) = (Pacer::default(), Instant::now());
        assert_eq!(pacer.wait(&limited(10), now), None, "the first one");
        pacer.asked(now);
        let later = now + Duration::from_millis(40);
        let wait = pacer.wait(&limited(10), later);
        assert_eq!(wait, Some(Duration::from_millis(60)));
        assert!(pacer.is_waiting());
        let due = now + Duration::from_millis(100);
        assert_eq!(pacer.wait(&limited(10), due), None);
        assert_eq!(pacer.wait(&limited(0), due), Some(Duration::MAX));
        assert!(!pacer.is_waiting(), "nothing comes by itself");
        assert_eq!(pacer.wait(&Pacing::default(), later), None);
    }
}
