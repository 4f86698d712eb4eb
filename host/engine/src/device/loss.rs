//! Loss of the device, and errors that no scope caught.

use super::errors::{GpuError, with_causes};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Uncaught errors that are kept until someone asks; a driver in trouble may report one per call.
const KEPT_ERRORS: usize = 100;

/// State that wgpu's callbacks write, from any thread.
#[derive(Debug, Default)]
pub(super) struct Loss {
    lost: AtomicBool,
    reason: Mutex<String>,
    errors: Mutex<Vec<String>>,
}

impl Loss {
    /// Sets the device's callbacks. Without them wgpu panics on an error outside a scope.
    pub(super) fn watch(device: &wgpu::Device) -> Arc<Self> {
        let loss = Arc::new(Self::default());
        let watching = Arc::clone(&loss);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            watching.add_error(with_causes(&error));
        }));
        let watching = Arc::clone(&loss);
        device.set_device_lost_callback(move |_reason, message| watching.set_lost(&message));
        loss
    }

    pub(super) fn is_lost(&self) -> bool {
        self.lost.load(Ordering::Acquire)
    }

    /// Marks the device as lost; the first reason stays.
    pub(super) fn set_lost(&self, why: &str) {
        let mut reason = self.reason.lock().unwrap_or_else(PoisonError::into_inner);
        if reason.is_empty() {
            why.trim_end_matches('.').clone_into(&mut reason);
        }
        drop(reason);
        self.lost.store(true, Ordering::Release);
    }

    pub(super) fn check(&self) -> Result<(), GpuError> {
        if !self.is_lost() {
            return Ok(());
        }
        let reason = self.reason.lock().unwrap_or_else(PoisonError::into_inner);
        let because = if reason.is_empty() {
            String::new()
        } else {
            format!(" ({reason})")
        };
        Err(GpuError::DeviceLost(format!(
            "the graphics device is lost{because}; what was made with it must be made again on the next one"
        )))
    }

    fn add_error(&self, text: String) {
        let mut errors = self.errors.lock().unwrap_or_else(PoisonError::into_inner);
        if errors.len() < KEPT_ERRORS {
            errors.push(text);
        }
    }

    pub(super) fn take_errors(&self) -> Vec<String> {
        std::mem::take(&mut self.errors.lock().unwrap_or_else(PoisonError::into_inner))
    }
}
