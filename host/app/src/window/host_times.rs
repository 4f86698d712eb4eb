//! How long the host itself takes between a gesture and the picture of it, beside the renderer's own time.

use std::time::{Duration, Instant};

use pointstage_engine::stage::FrameStats;

/// The parts of the last picture's way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct HostTimes {
    /// When the pass began that is under way.
    pass_began: Option<Instant>,
    /// From the beginning of the pass that saw the gesture to the request.
    pub(crate) ask: Duration,
    /// In the engine, without the renderer's calls and its work on the device: upload, composition, read-back.
    pub(crate) engine: Duration,
    /// Taking the picture over into the window.
    pub(crate) show: Duration,
}

impl HostTimes {
    /// Notes that a pass begins.
    pub(crate) fn pass_begins(&mut self) {
        self.pass_began = Some(Instant::now());
    }

    /// Notes that a picture was asked for in this pass.
    pub(crate) fn asked(&mut self) {
        self.ask = self
            .pass_began
            .map_or(Duration::ZERO, |began| began.elapsed());
    }

    /// Notes that a picture was taken over, since `began`.
    pub(crate) fn shown(&mut self, stats: &FrameStats, began: Instant) {
        let renderer = stats.plugin_cpu + stats.device_wall;
        self.engine = stats.total.saturating_sub(renderer);
        self.show = began.elapsed();
    }
}
