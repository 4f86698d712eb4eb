//! Read-backs: a ticket is filled by one `ReadBack` command and polled later; nobody waits.

use super::bytes::Charge;
use crate::device::GpuError;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

const MAPPING: u8 = 0;
const MAPPED: u8 = 1;
const FAILED: u8 = 2;

/// One read-back.
#[derive(Debug, Default)]
pub(super) struct Ticket(Mutex<State>);

#[derive(Debug, Default)]
enum State {
    /// No submitted command fills it yet.
    #[default]
    Empty,
    /// The copy is on its way.
    Pending {
        staging: wgpu::Buffer,
        status: Arc<AtomicU8>,
        #[expect(dead_code, reason = "held for its drop")]
        charge: Charge,
    },
    /// The bytes were handed out.
    Taken,
}

impl Ticket {
    fn lock(&self) -> std::sync::MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Refuses a second read-back.
    pub(super) fn check_empty(&self) -> Result<(), GpuError> {
        match *self.lock() {
            State::Empty => Ok(()),
            State::Pending { .. } | State::Taken => Err(GpuError::validation(
                "the ticket was used by an earlier ReadBack; make a ticket for each",
            )),
        }
    }

    /// Starts mapping the staging buffer, into which a submitted command copies.
    pub(super) fn fill(&self, staging: wgpu::Buffer, charge: Charge) {
        let status = Arc::new(AtomicU8::new(MAPPING));
        let mapped = Arc::clone(&status);
        staging.map_async(wgpu::MapMode::Read, .., move |result| {
            let status = if result.is_ok() { MAPPED } else { FAILED };
            mapped.store(status, Ordering::Release);
        });
        *self.lock() = State::Pending {
            staging,
            status,
            charge,
        };
    }

    /// The bytes, once. The caller has polled the device.
    pub(super) fn take(&self) -> Result<Option<Vec<u8>>, GpuError> {
        let mut state = self.lock();
        let bytes = match &*state {
            State::Empty => return Ok(None),
            State::Taken => {
                return Err(GpuError::validation(
                    "the ticket's bytes were taken by an earlier poll; keep them, or make another ticket",
                ));
            }
            State::Pending {
                staging, status, ..
            } => match status.load(Ordering::Acquire) {
                MAPPING => return Ok(None),
                MAPPED => staging
                    .get_mapped_range(..)
                    .map(|range| range.to_vec())
                    .map_err(|error| GpuError::Failed(format!("reading back: {error}"))),
                _ => Err(GpuError::Failed(
                    "the device could not hand the bytes over; read back again".into(),
                )),
            },
        };
        *state = State::Taken;
        bytes.map(Some)
    }
}
