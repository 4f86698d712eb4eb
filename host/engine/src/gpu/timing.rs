//! How long each pass took on the device, by timestamps at its begin and end.

use crate::device::GpuDevice;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use wgpu::Features;

/// Whether passes are timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Timings {
    /// No.
    Off,
    /// Where the device has timestamps.
    On,
}

/// A time of one pass.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PassTime {
    /// The pass's label.
    pub label: String,
    /// On the device, by timestamps.
    pub time: Duration,
}

/// What is known of the passes' times.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PassTimes {
    /// Not asked for, or the device has no timestamps.
    Unavailable,
    /// The device has not finished.
    Pending,
    /// In the order of the passes.
    Known(Vec<PassTime>),
}

/// Passes that the smallest query set holds; most frames have fewer.
const LEAST_PASSES: u32 = 16;
/// Passes that the largest one holds: two queries each of WebGPU's 4096. Later passes go untimed.
const MOST_PASSES: u32 = 2048;
/// Bytes of a timestamp.
const TIMESTAMP_BYTES: u64 = 8;

const MAPPING: u8 = 0;
const MAPPED: u8 = 1;
const FAILED: u8 = 2;

/// Queries of one replay, with the buffers they go through. Reused: they make a ring as long as frames are in flight.
#[derive(Debug)]
pub(super) struct Queries {
    pub(super) set: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    staging: wgpu::Buffer,
    passes: u32,
}

impl Queries {
    fn new(device: &wgpu::Device, passes: u32) -> Self {
        let buffer = |label, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: u64::from(passes) * 2 * TIMESTAMP_BYTES,
                usage,
                mapped_at_creation: false,
            })
        };
        Self {
            set: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("pass times"),
                ty: wgpu::QueryType::Timestamp,
                count: passes * 2,
            }),
            resolved: buffer(
                "pass times, resolved",
                wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
            ),
            staging: buffer(
                "pass times, staging",
                wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            ),
            passes,
        }
    }

    /// Begin and end query of a pass, if it fits.
    pub(super) fn of_pass(&self, pass: usize) -> Option<[u32; 2]> {
        let pass = u32::try_from(pass)
            .ok()
            .filter(|pass| *pass < self.passes)?;
        Some([pass * 2, pass * 2 + 1])
    }

    /// Resolves the queries of the first passes at the end of the encoder.
    pub(super) fn resolve(&self, encoder: &mut wgpu::CommandEncoder, passes: usize) {
        let queries = self.timed(passes) * 2;
        if queries == 0 {
            return;
        }
        let size = u64::from(queries) * TIMESTAMP_BYTES;
        encoder.resolve_query_set(&self.set, 0..queries, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.staging, 0, size);
    }

    /// How many of these passes have queries.
    fn timed(&self, passes: usize) -> u32 {
        u32::try_from(passes).unwrap_or(u32::MAX).min(self.passes)
    }
}

/// Query sets that no frame uses.
#[derive(Debug)]
pub(super) struct Pool {
    supported: bool,
    /// Nanoseconds of a tick.
    period: f64,
    idle: Mutex<Vec<Queries>>,
}

impl Pool {
    pub(super) fn new(gpu: &GpuDevice) -> Self {
        let supported = gpu.features.contains(Features::TIMESTAMP_QUERY);
        Self {
            supported,
            period: if supported {
                f64::from(gpu.queue.get_timestamp_period())
            } else {
                0.0
            },
            idle: Mutex::default(),
        }
    }

    /// Queries for as many passes, or none if there is nothing to time or nothing to time with.
    pub(super) fn take(
        &self,
        device: &wgpu::Device,
        timings: Timings,
        passes: usize,
    ) -> Option<Queries> {
        if !self.supported || timings == Timings::Off || passes == 0 {
            return None;
        }
        let wanted = u32::try_from(passes)
            .unwrap_or(u32::MAX)
            .clamp(LEAST_PASSES, MOST_PASSES)
            .next_power_of_two();
        let mut idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner);
        let fitting = idle.iter().position(|queries| queries.passes >= wanted);
        match fitting {
            Some(index) => Some(idle.swap_remove(index)),
            None => Some(Queries::new(device, wanted)),
        }
    }

    /// Takes queries back of which nothing was submitted, or which were read.
    pub(super) fn give_back(&self, queries: Queries) {
        self.idle
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(queries);
    }
}

/// The times of one submitted replay, on their way.
#[derive(Debug)]
pub(super) struct Timing {
    queries: Option<Queries>,
    status: Arc<AtomicU8>,
    pool: Arc<Pool>,
}

impl Timing {
    /// Starts mapping what a submitted command buffer resolves.
    pub(super) fn start(queries: Queries, pool: &Arc<Pool>) -> Self {
        let status = Arc::new(AtomicU8::new(MAPPING));
        let mapped = Arc::clone(&status);
        queries
            .staging
            .map_async(wgpu::MapMode::Read, .., move |result| {
                let status = if result.is_ok() { MAPPED } else { FAILED };
                mapped.store(status, Ordering::Release);
            });
        Self {
            queries: Some(queries),
            status,
            pool: Arc::clone(pool),
        }
    }

    /// The times if they have arrived. The caller has polled the device.
    pub(super) fn times(&mut self, labels: &[String]) -> PassTimes {
        let status = self.status.load(Ordering::Acquire);
        let (MAPPED, Some(queries)) = (status, &self.queries) else {
            return if status == MAPPING {
                PassTimes::Pending
            } else {
                PassTimes::Unavailable
            };
        };
        let timed = queries.timed(labels.len()) as usize;
        let Ok(range) = queries.staging.get_mapped_range(..) else {
            return PassTimes::Unavailable;
        };
        let ticks: Vec<u64> = range
            .chunks_exact(TIMESTAMP_BYTES as usize)
            .take(timed * 2)
            .map(|bytes| u64::from_le_bytes(bytes.try_into().expect("chunks of 8 bytes")))
            .collect();
        drop(range);
        let times = labels
            .iter()
            .zip(ticks.chunks_exact(2))
            .map(|(label, ends)| PassTime {
                label: label.clone(),
                // Some drivers order begin and end the wrong way round for empty passes.
                time: Duration::from_nanos(
                    (ends[1].saturating_sub(ends[0]) as f64 * self.pool.period) as u64,
                ),
            })
            .collect();
        PassTimes::Known(times)
    }
}

impl Drop for Timing {
    fn drop(&mut self) {
        if let Some(queries) = self.queries.take() {
            // Unmapping also cancels a mapping that was not waited for. The next user's submission is later in the queue.
            queries.staging.unmap();
            self.pool.give_back(queries);
        }
    }
}
