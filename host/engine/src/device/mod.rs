//! The engine's own GPU device, apart from any window's.
//!
//! [`GpuDevice::open`] chooses an adapter ([`adapter`](self)), enables every optional feature that Pointstage knows and
//! the adapter has, and takes the adapter's own limits. From then on errors are values: calls into wgpu run inside
//! [`GpuDevice::scoped`], and what happens outside a scope is collected for [`GpuDevice::take_errors`]. A lost device
//! says so by [`GpuDevice::is_lost`]; whoever owns it opens a new one, with a new generation.

mod adapter;
mod errors;
mod loss;

pub use adapter::{AdapterSummary, Backend, UnknownBackend};
pub use errors::{GpuError, OpenDeviceError};

use loss::Loss;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;
use wgpu::Features;

/// Counts the devices of this process.
static GENERATIONS: AtomicU64 = AtomicU64::new(0);

/// Which adapter to open.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DeviceOptions {
    /// Only adapters of this interface.
    pub backend: Option<Backend>,
    /// A number of [`GpuDevice::list_adapters`], or part of a name, in any case.
    pub adapter: Option<String>,
}

/// An open device and its queue. Thread: any.
#[derive(Debug)]
pub struct GpuDevice {
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// The adapter's name, driver, interface and kind.
    pub info: wgpu::AdapterInfo,
    /// Which device of this process it is, from 1.
    pub generation: u64,
    /// What is optional in WebGPU and enabled here.
    pub features: Features,
    /// The largest sizes and counts.
    pub limits: wgpu::Limits,
    adapter: wgpu::Adapter,
    loss: Arc<Loss>,
}

impl GpuDevice {
    /// Optional features that Pointstage enables where the adapter has them. A plugin sees one only if its manifest asks.
    pub const KNOWN_FEATURES: Features = Features::TIMESTAMP_QUERY
        .union(Features::TIMESTAMP_QUERY_INSIDE_ENCODERS)
        .union(Features::TIMESTAMP_QUERY_INSIDE_PASSES)
        .union(Features::SHADER_INT64)
        .union(Features::SHADER_INT64_ATOMIC_MIN_MAX)
        .union(Features::SHADER_INT64_ATOMIC_ALL_OPS)
        .union(Features::SHADER_FLOAT32_ATOMIC)
        .union(Features::SHADER_F16)
        .union(Features::SHADER_F64)
        .union(Features::SHADER_I16)
        .union(Features::SHADER_EARLY_DEPTH_TEST)
        .union(Features::SUBGROUP)
        .union(Features::SUBGROUP_BARRIER)
        .union(Features::SUBGROUP_VERTEX)
        .union(Features::PRIMITIVE_INDEX)
        .union(Features::CLIP_DISTANCES)
        .union(Features::TEXTURE_ATOMIC)
        .union(Features::TEXTURE_INT64_ATOMIC)
        .union(Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES)
        .union(Features::FLOAT32_BLENDABLE)
        .union(Features::FLOAT32_FILTERABLE)
        .union(Features::RG11B10UFLOAT_RENDERABLE)
        .union(Features::BGRA8UNORM_STORAGE)
        .union(Features::VERTEX_WRITABLE_STORAGE)
        .union(Features::INDIRECT_FIRST_INSTANCE)
        .union(Features::IMMEDIATES);

    /// Opens the adapter that the options name, or the best one: a real GPU, else a software one.
    ///
    /// # Errors
    ///
    /// No adapter, none of that name, one that lacks what Pointstage needs, or one that refuses.
    pub fn open(options: &DeviceOptions) -> Result<Arc<Self>, OpenDeviceError> {
        let adapter = adapter::choose(options)?;
        let info = adapter.get_info();
        adapter::check_suitable(&adapter, &info)?;
        let features = adapter.features() & Self::KNOWN_FEATURES;
        let limits = adapter.limits();
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("pointstage"),
            required_features: features,
            required_limits: limits.clone(),
            ..Default::default()
        };
        let (device, queue) =
            pollster::block_on(adapter.request_device(&descriptor)).map_err(|source| {
                OpenDeviceError::Refused {
                    adapter: info.name.clone(),
                    source: Box::new(source),
                }
            })?;
        let loss = Loss::watch(&device);
        Ok(Arc::new(Self {
            device,
            queue,
            info,
            generation: GENERATIONS.fetch_add(1, Ordering::Relaxed) + 1,
            features,
            limits,
            adapter,
            loss,
        }))
    }

    /// All adapters, in the order that numbers them.
    pub fn list_adapters() -> Vec<AdapterSummary> {
        adapter::list()
    }

    /// Whether the adapter runs on the CPU (Mesa's lavapipe and llvmpipe, WARP).
    pub fn is_software(&self) -> bool {
        adapter::is_software(&self.info)
    }

    /// The interface's name: 'vulkan', 'gl', 'metal', 'dx12'.
    pub fn backend_name(&self) -> &'static str {
        self.info.backend.to_str()
    }

    /// What the adapter can do with textures of a format.
    pub fn format_features(&self, format: wgpu::TextureFormat) -> wgpu::TextureFormatFeatures {
        self.adapter.get_texture_format_features(format)
    }

    /// What the adapter lacks of WebGPU's baseline, as flags of what it has.
    pub fn downlevel_flags(&self) -> wgpu::DownlevelFlags {
        self.adapter.get_downlevel_capabilities().flags
    }

    /// Whether the device is gone: lost by the driver, or destroyed.
    pub fn is_lost(&self) -> bool {
        self.loss.is_lost()
    }

    /// [`GpuError::DeviceLost`] once the loss is known. Costs nothing; a driver's loss is known at once, but a
    /// destroyed wgpu device only when it is polled.
    ///
    /// # Errors
    ///
    /// Only that one.
    pub fn check_not_lost(&self) -> Result<(), GpuError> {
        self.loss.check()
    }

    /// [`GpuError::DeviceLost`] once the device is gone. Polls the device, which also runs the callbacks of what has
    /// finished; never waits, but takes some microseconds.
    ///
    /// # Errors
    ///
    /// Only that one.
    pub fn check_alive(&self) -> Result<(), GpuError> {
        // What the poll itself says is of no interest here.
        self.device.poll(wgpu::PollType::Poll).ok();
        self.loss.check()
    }

    /// Destroys the device. Everything made with it answers that the device is lost.
    pub fn destroy(&self) {
        self.loss.set_lost("it was destroyed on request");
        self.device.destroy();
    }

    /// Errors that no scope caught since the last call, oldest first.
    pub fn take_errors(&self) -> Vec<String> {
        self.loss.take_errors()
    }

    /// Runs `f` with wgpu's errors on this thread turned into a value: the first one of any kind.
    ///
    /// # Errors
    ///
    /// What wgpu reported, or that the device is lost.
    pub fn scoped<T>(&self, f: impl FnOnce() -> T) -> Result<T, GpuError> {
        self.loss.check()?;
        let internal = self.device.push_error_scope(wgpu::ErrorFilter::Internal);
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let validation = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let value = f();
        let validation = errors::popped(validation);
        let memory = errors::popped(memory);
        let internal = errors::popped(internal);
        self.loss.check()?;
        match memory.or(internal).or(validation) {
            Some(error) => Err(GpuError::from_wgpu(&error)),
            None => Ok(value),
        }
    }

    /// Waits until the device has done all submitted work.
    ///
    /// # Errors
    ///
    /// The device is lost, or `timeout` has passed.
    pub fn wait_idle(&self, timeout: Duration) -> Result<(), GpuError> {
        self.wait(None, timeout)
    }

    /// Waits until the device has done a submission, or all of them.
    ///
    /// # Errors
    ///
    /// The device is lost, or `timeout` has passed.
    pub fn wait(
        &self,
        submission_index: Option<wgpu::SubmissionIndex>,
        timeout: Duration,
    ) -> Result<(), GpuError> {
        self.loss.check()?;
        let wait = wgpu::PollType::Wait {
            submission_index,
            timeout: Some(timeout),
        };
        let status = self.device.poll(wait);
        self.loss.check()?;
        match status {
            Ok(_) => Ok(()),
            Err(wgpu::PollError::Timeout) => Err(GpuError::Failed(format!(
                "the device has not finished within {:.1} s; draw less, or choose another adapter",
                timeout.as_secs_f64()
            ))),
            Err(error) => {
                // What a destroyed device was given last was never submitted, so there is nothing to wait for.
                self.check_alive()?;
                Err(GpuError::Failed(format!("waiting for the device: {error}")))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A device of this machine, or a line that says why the test is skipped.
    fn device() -> Option<Arc<GpuDevice>> {
        GpuDevice::open(&DeviceOptions::default())
            .inspect_err(|error| eprintln!("skipped: {error}"))
            .ok()
    }

    #[test]
    fn errors_in_a_scope_are_values() {
        let Some(gpu) = device() else { return };
        let result = gpu.scoped(|| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("too big"),
                size: u64::MAX - 3,
                usage: wgpu::BufferUsages::STORAGE,
                mapped_at_creation: false,
            })
        });
        let error = result.expect_err("no device has that much memory");
        assert!(error.to_string().contains("too big"), "{error}");
        assert!(gpu.take_errors().is_empty());
    }

    #[test]
    fn errors_outside_a_scope_are_collected() {
        let Some(gpu) = device() else { return };
        let _buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("unscoped"),
            size: u64::MAX - 3,
            usage: wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        });
        let errors = gpu.take_errors();
        assert_eq!(errors.len(), 1, "{errors:?}");
        assert!(gpu.take_errors().is_empty());
    }

    #[test]
    fn a_destroyed_device_is_lost_and_a_new_one_is_another_generation() {
        let Some(gpu) = device() else { return };
        gpu.device.destroy();
        assert!(matches!(gpu.check_alive(), Err(GpuError::DeviceLost(_))));
        assert!(gpu.is_lost());
        assert!(matches!(gpu.scoped(|| ()), Err(GpuError::DeviceLost(_))));
        let next = GpuDevice::open(&DeviceOptions::default()).expect("it opened before");
        assert!(next.generation > gpu.generation);
        assert!(!next.is_lost());
    }

    #[test]
    fn an_unknown_adapter_is_refused_with_those_that_exist() {
        let Some(gpu) = device() else { return };
        let options = DeviceOptions {
            adapter: Some("no such adapter".into()),
            ..Default::default()
        };
        let error = GpuDevice::open(&options).expect_err("nothing has that name");
        assert!(error.to_string().contains(&gpu.info.name), "{error}");
    }

    #[test]
    fn an_adapter_is_found_by_its_number_and_by_part_of_its_name() {
        let Some(_) = device() else { return };
        for summary in GpuDevice::list_adapters() {
            for wanted in [summary.number.to_string(), summary.name.to_uppercase()] {
                let options = DeviceOptions {
                    adapter: Some(wanted),
                    backend: Some(summary.backend),
                };
                match GpuDevice::open(&options) {
                    Ok(gpu) => assert_eq!(gpu.info.name, summary.name),
                    Err(error) => eprintln!("skipped: {}: {error}", summary.name),
                }
            }
        }
    }
}
