//! Runs passes that write words, and brings the words to memory.
//!
//! A pass writes into one scratch buffer on the device, which is then copied to a staging buffer that can be mapped. What is
//! larger than a storage binding may be goes in bands of rows. All jobs of a frame share one submission and one wait.

use std::sync::mpsc;
use std::time::Duration;

use bytemuck::bytes_of;
use wgpu::BufferUsages;
use wgpu::util::DeviceExt as _;

use super::compose::Uniform;
use super::copied;
use super::passes::{Pass, Passes, RANGE_KEYS, TARGET, UNIFORM, WORDS, WORKGROUP_PX};
use crate::device::{GpuDevice, GpuError};

/// One pass over one target.
#[derive(Debug)]
pub(super) struct Job<'t> {
    pub(super) pass: Pass,
    pub(super) view: &'t wgpu::TextureView,
    /// Copied as it is, in padded rows ([`copied`](super::copied)), instead of running the pass.
    pub(super) copied: Option<&'t wgpu::Texture>,
    /// With the size of the target; rows are filled in per band.
    pub(super) uniform: Uniform,
    /// Whether the range of the target's values is found first.
    pub(super) needs_range: bool,
}

/// Buffers that are kept from frame to frame.
#[derive(Debug)]
pub(super) struct Readback {
    /// The most bytes that a pass may write at once.
    pub(super) max_band_bytes: u64,
    scratch: Option<wgpu::Buffer>,
    range: Option<wgpu::Buffer>,
    /// Staging buffers of the last frame, unmapped.
    idle: Vec<wgpu::Buffer>,
}

/// What mapping the staging buffers came to, one message each.
type Arrivals = mpsc::Receiver<Result<(), wgpu::BufferAsyncError>>;

/// Bytes of the least and the greatest key.
const RANGE_BYTES: u64 = 8;

/// Words on their way to memory.
struct Staged {
    /// Number of the job; `None` for the range.
    job: Option<usize>,
    bytes: u64,
    buffer: wgpu::Buffer,
}

impl Readback {
    /// For a device with these limits.
    pub(super) fn new(limits: &wgpu::Limits) -> Self {
        Self {
            max_band_bytes: limits
                .max_buffer_size
                .min(limits.max_storage_buffer_binding_size),
            scratch: None,
            range: None,
            idle: Vec::new(),
        }
    }

    /// Runs the jobs, waits for their words, and hands them on: the number of the job, and words that follow those before.
    ///
    /// Returns the least and the greatest value in view, as keys, of the job that needed them.
    pub(super) fn run(
        &mut self,
        gpu: &GpuDevice,
        passes: &Passes,
        jobs: &[Job<'_>],
        timeout: Duration,
        mut take: impl FnMut(usize, &[u32]),
    ) -> Result<Option<[u32; 2]>, GpuError> {
        let (staged, arrived, submission) = gpu.scoped(|| self.submit(gpu, passes, jobs))?;
        gpu.wait(Some(submission), timeout)?;
        for _ in &staged {
            // The wait above ran the callbacks; one that is missing will not come any more.
            match arrived.try_recv() {
                Ok(Ok(())) => {}
                Ok(Err(error)) => return Err(GpuError::Failed(format!("reading back: {error}"))),
                Err(_) => {
                    return Err(GpuError::Failed(
                        "reading back: the device gave no answer; try again, or choose another adapter".into(),
                    ));
                }
            }
        }
        let mut range_keys = None;
        for Staged { job, bytes, buffer } in staged {
            let view = buffer.slice(..bytes).get_mapped_range();
            let view = view.map_err(|error| GpuError::Failed(format!("reading back: {error}")))?;
            let mapped: &[u32] = bytemuck::cast_slice(&view);
            match job {
                Some(job) => take(job, mapped),
                None => range_keys = mapped.try_into().ok(),
            }
            drop(view);
            buffer.unmap();
            self.idle.push(buffer);
        }
        Ok(range_keys)
    }

    /// Records and submits everything, and asks for the staging buffers to be mapped.
    fn submit(
        &mut self,
        gpu: &GpuDevice,
        passes: &Passes,
        jobs: &[Job<'_>],
    ) -> (Vec<Staged>, Arrivals, wgpu::SubmissionIndex) {
        let device = &gpu.device;
        let widest = jobs
            .iter()
            .filter(|job| job.copied.is_none())
            .map(|job| self.band_rows(job) * row_bytes(job))
            .max()
            .unwrap_or(4);
        let scratch = kept_or_new(&mut self.scratch, device, widest);
        let range = kept_or_new(&mut self.range, device, RANGE_BYTES);
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("compose"),
        });
        let mut staged = Vec::new();
        let mut last_idle = core::mem::take(&mut self.idle);
        let mut stage = |job, bytes| {
            let buffer = take_or_new(&mut last_idle, device, bytes);
            let copy = buffer.clone();
            staged.push(Staged { job, bytes, buffer });
            copy
        };
        let pass_over = |encoder: &mut wgpu::CommandEncoder,
                         pass,
                         job: &Job<'_>,
                         uniform: &Uniform| {
            let (pipeline, layout) = passes.find(pass);
            let group = bind_group(device, layout, uniform, job.view, [&scratch, &range]);
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &group, &[]);
            let [width, _] = uniform.size_px;
            let [across, down] = WORKGROUP_PX;
            pass.dispatch_workgroups(width.div_ceil(across), uniform.row_count.div_ceil(down), 1);
        };
        for (index, job) in jobs.iter().enumerate() {
            if let Some(texture) = job.copied {
                let row_bytes = copied::row_bytes(texture);
                let bytes = u64::from(row_bytes) * u64::from(texture.height());
                encoder.copy_texture_to_buffer(
                    texture.as_image_copy(),
                    wgpu::TexelCopyBufferInfo {
                        buffer: &stage(Some(index), bytes),
                        layout: wgpu::TexelCopyBufferLayout {
                            offset: 0,
                            bytes_per_row: Some(row_bytes),
                            rows_per_image: None,
                        },
                    },
                    texture.size(),
                );
                continue;
            }
            if job.needs_range {
                gpu.queue
                    .write_buffer(&range, 0, bytemuck::cast_slice(&[u32::MAX, 0]));
                pass_over(
                    &mut encoder,
                    Pass::Range(job.pass.format()),
                    job,
                    &job.uniform,
                );
                let staged = stage(None, RANGE_BYTES);
                encoder.copy_buffer_to_buffer(&range, 0, &staged, 0, RANGE_BYTES);
            }
            let height = job.uniform.size_px[1];
            let band_rows = self.band_rows(job) as u32;
            for first_row in (0..height).step_by(band_rows as usize) {
                let uniform = Uniform {
                    first_row,
                    row_count: band_rows.min(height - first_row),
                    ..job.uniform
                };
                pass_over(&mut encoder, job.pass, job, &uniform);
                let bytes = u64::from(uniform.row_count) * row_bytes(job);
                let staged = stage(Some(index), bytes);
                encoder.copy_buffer_to_buffer(&scratch, 0, &staged, 0, bytes);
            }
        }
        let submission = gpu.queue.submit([encoder.finish()]);
        let (sender, arrived) = mpsc::channel();
        for Staged { bytes, buffer, .. } in &staged {
            let sender = sender.clone();
            buffer
                .slice(..*bytes)
                .map_async(wgpu::MapMode::Read, move |result| {
                    // Nobody listens any more after a timeout.
                    sender.send(result).ok();
                });
        }
        (staged, arrived, submission)
    }

    /// Rows that a job may write at once, at least 1: a row has 16 bytes a pixel at most, and every device can bind the
    /// rows of its largest texture.
    fn band_rows(&self, job: &Job<'_>) -> u64 {
        (self.max_band_bytes / row_bytes(job)).clamp(1, u64::from(job.uniform.size_px[1]))
    }

    /// Bytes of all buffers.
    pub(super) fn bytes(&self) -> u64 {
        let all = self.idle.iter().chain(&self.scratch).chain(&self.range);
        all.map(wgpu::Buffer::size).sum()
    }
}

/// Bytes that a job writes a row.
fn row_bytes(job: &Job<'_>) -> u64 {
    let words = match job.pass {
        Pass::Read(format) => format.channels(),
        Pass::Range(_) | Pass::Colours | Pass::Compose(_) => 1,
    };
    u64::from(job.uniform.size_px[0]) * u64::from(words) * 4
}

/// The buffer of last time if it is large enough, or a new one.
fn kept_or_new(kept: &mut Option<wgpu::Buffer>, device: &wgpu::Device, bytes: u64) -> wgpu::Buffer {
    if let Some(buffer) = kept.take_if(|buffer| buffer.size() < bytes) {
        buffer.destroy();
    }
    let create = || {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("composed words"),
            size: bytes,
            usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    };
    kept.get_or_insert_with(create).clone()
}

/// A staging buffer of last time that is large enough and not far too large, or a new one.
fn take_or_new(idle: &mut Vec<wgpu::Buffer>, device: &wgpu::Device, bytes: u64) -> wgpu::Buffer {
    let fits = |buffer: &wgpu::Buffer| (bytes..=bytes * 2).contains(&buffer.size());
    match idle.iter().position(fits) {
        Some(index) => idle.swap_remove(index),
        None => device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("staged words"),
            size: bytes,
            usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        }),
    }
}

fn bind_group(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    uniform: &Uniform,
    view: &wgpu::TextureView,
    [scratch, range]: [&wgpu::Buffer; 2],
) -> wgpu::BindGroup {
    let uniform = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("composition"),
        contents: bytes_of(uniform),
        usage: BufferUsages::UNIFORM,
    });
    let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("compose"),
        layout,
        entries: &[
            entry(UNIFORM, uniform.as_entire_binding()),
            entry(TARGET, wgpu::BindingResource::TextureView(view)),
            entry(WORDS, scratch.as_entire_binding()),
            entry(RANGE_KEYS, range.as_entire_binding()),
        ],
    })
}
