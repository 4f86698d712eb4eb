//! One running call into a plugin: cancel, deadline and progress, shared between the worker and who watches it.

use abi_stable::sabi_trait::TD_Opaque;
use abi_stable::sabi_types::RRef;
use abi_stable::std_types::{ROption, RStr};
use pointstage_plugin_api::abi::{CallObject, CallObject_TO, CallRef, ExtensionBox};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Bytes of a stage text that are kept.
const LONGEST_STAGE: usize = 200;

/// State of one call. The plugin reads it through [`CallState::border`]; any thread may cancel it.
#[derive(Debug, Default)]
pub struct CallState {
    cancelled: AtomicBool,
    deadline: Option<Instant>,
    progress: Mutex<(f32, String)>,
}

impl CallState {
    /// A call that runs until it is done or cancelled.
    pub fn new() -> Self {
        Self::default()
    }

    /// A call whose result nobody wants after `deadline`.
    pub fn with_deadline(deadline: Instant) -> Self {
        Self {
            deadline: Some(deadline),
            ..Self::default()
        }
    }

    /// Asks the plugin to stop. It should return within 200 ms.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Whether [`CallState::cancel`] was called.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// What the plugin last told: 0..1, and what it does.
    pub fn progress(&self) -> (f32, String) {
        self.progress
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }

    /// The plugin's view of this call.
    pub fn border(&self) -> CallRef<'_> {
        CallObject_TO::from_ptr(RRef::new(self), TD_Opaque)
    }
}

impl CallObject for CallState {
    fn should_stop(&self) -> u32 {
        let late = self
            .deadline
            .is_some_and(|deadline| Instant::now() >= deadline);
        u32::from(late || self.is_cancelled())
    }

    fn progress(&self, fraction: f32, stage: RStr<'_>) {
        // A NaN counts as nothing done.
        let fraction = if fraction >= 0.0 {
            fraction.min(1.0)
        } else {
            0.0
        };
        let stage = shorten(stage.as_str(), LONGEST_STAGE).to_owned();
        *self.progress.lock().unwrap_or_else(PoisonError::into_inner) = (fraction, stage);
    }

    fn extension(&self, _name: RStr<'_>) -> ROption<ExtensionBox> {
        ROption::RNone
    }
}

/// The first `bytes` bytes of `text`, or a little less: never inside a letter.
pub(super) fn shorten(text: &str, bytes: usize) -> &str {
    let end = text.floor_char_boundary(bytes);
    &text[..end]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn a_cancel_reaches_the_plugins_side() {
        let call = CallState::new();
        let border = call.border();
        assert_eq!(border.should_stop(), 0);
        call.cancel();
        assert_eq!(border.should_stop(), 1);
    }

    #[test]
    fn a_deadline_that_has_passed_stops_the_call() {
        let now = Instant::now();
        let late = CallState::with_deadline(now);
        assert_eq!(late.border().should_stop(), 1);
        let early = CallState::with_deadline(now + Duration::from_hours(1));
        assert_eq!(early.border().should_stop(), 0);
    }

    #[test]
    fn progress_is_kept_in_range_and_short() {
        let call = CallState::new();
        call.border()
            .progress(7.0, "é".repeat(1_000).as_str().into());
        let (fraction, stage) = call.progress();
        assert_eq!(fraction, 1.0);
        assert!(stage.len() <= LONGEST_STAGE, "{} bytes", stage.len());
        call.border().progress(f32::NAN, "x".into());
        assert_eq!(call.progress(), (0.0, "x".to_owned()));
    }
}
