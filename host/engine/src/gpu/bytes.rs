//! What an owner holds on the device, in bytes, against its quota.

use crate::device::GpuError;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use wgpu::Features;

/// One plugin instance, as the service knows it.
#[derive(Debug)]
pub(super) struct OwnerState {
    /// For messages and debuggers.
    pub(super) name: String,
    /// Optional features that its manifest asks for and the device has.
    pub(super) granted: Features,
    /// Set when everything of it was freed; what still runs gets errors.
    pub(super) freed: AtomicBool,
    quota: u64,
    held: AtomicU64,
}

impl OwnerState {
    pub(super) fn new(name: &str, granted: Features, quota: u64) -> Self {
        Self {
            name: name.into(),
            granted,
            freed: AtomicBool::new(false),
            quota,
            held: AtomicU64::new(0),
        }
    }

    /// Bytes held now.
    pub(super) fn held(&self) -> u64 {
        self.held.load(Ordering::Relaxed)
    }

    /// Takes `bytes` of the quota until the charge is dropped.
    pub(super) fn charge(self: &Arc<Self>, bytes: u64) -> Result<Charge, GpuError> {
        self.held
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, |held| {
                held.checked_add(bytes).filter(|sum| *sum <= self.quota)
            })
            .map_err(|held| {
                GpuError::OutOfMemory(format!(
                    "{bytes} bytes do not fit: '{}' holds {held} bytes of its quota of {}; free something, \
                     or raise the quota",
                    self.name, self.quota
                ))
            })?;
        Ok(Charge {
            owner: Arc::clone(self),
            bytes,
        })
    }
}

/// Bytes taken from an owner's quota. A resource and all that refers to it (views, bind groups) share one, so that the
/// bytes count for as long as the device must keep them.
#[derive(Debug)]
pub(super) struct Charge {
    owner: Arc<OwnerState>,
    bytes: u64,
}

impl Drop for Charge {
    fn drop(&mut self) {
        self.owner.held.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quota_is_a_bound_and_comes_back() {
        let owner = Arc::new(OwnerState::new("test", Features::empty(), 100));
        let most = owner.charge(60).expect("60 of 100");
        let error = owner.charge(41).expect_err("101 of 100");
        assert!(matches!(error, GpuError::OutOfMemory(_)));
        assert!(error.to_string().contains("60 bytes of its quota of 100"));
        owner.charge(u64::MAX).expect_err("would overflow");
        drop(most);
        assert_eq!(owner.held(), 0);
        owner.charge(100).expect("all of it");
    }
}
