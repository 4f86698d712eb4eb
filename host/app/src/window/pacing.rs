//! How often pictures are drawn, and how long moving ones may take. Plain data.

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
        Self {
            rate_limit: None,
            target_rate: None,
            cross_fade: true,
        }
    }
}
