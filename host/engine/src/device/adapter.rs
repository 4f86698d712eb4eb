//! Adapters: listing them, and choosing one.

use super::DeviceOptions;
use super::errors::OpenDeviceError;
use std::fmt;
use std::path::Path;
use std::str::FromStr;
use wgpu::{Adapter, AdapterInfo, Backends, DeviceType, DownlevelFlags, Instance};

/// Storage buffers that a shader stage must be able to see: six columns of group 1, and two of the pass.
const STORAGE_BUFFERS_PER_STAGE: u32 = 8;

/// A graphics interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Backend {
    /// Linux, Windows, Android.
    Vulkan,
    /// OpenGL and OpenGL ES.
    Gl,
    /// macOS.
    Metal,
    /// Windows.
    Dx12,
}

impl Backend {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Vulkan, Self::Gl, Self::Metal, Self::Dx12];

    /// As on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Vulkan => "vulkan",
            Self::Gl => "gl",
            Self::Metal => "metal",
            Self::Dx12 => "dx12",
        }
    }

    fn from_wgpu(backend: wgpu::Backend) -> Option<Self> {
        match backend {
            wgpu::Backend::Vulkan => Some(Self::Vulkan),
            wgpu::Backend::Gl => Some(Self::Gl),
            wgpu::Backend::Metal => Some(Self::Metal),
            wgpu::Backend::Dx12 => Some(Self::Dx12),
            _ => None,
        }
    }

    fn to_wgpu(self) -> Backends {
        match self {
            Self::Vulkan => Backends::VULKAN,
            Self::Gl => Backends::GL,
            Self::Metal => Backends::METAL,
            Self::Dx12 => Backends::DX12,
        }
    }
}

impl fmt::Display for Backend {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// No interface is called so.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown graphics interface '{0}'; choose vulkan, gl, metal or dx12")]
pub struct UnknownBackend(pub String);

impl FromStr for Backend {
    type Err = UnknownBackend;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::ALL
            .into_iter()
            .find(|backend| backend.name().eq_ignore_ascii_case(text))
            .ok_or_else(|| UnknownBackend(text.into()))
    }
}

/// One adapter, for people.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterSummary {
    /// Chooses it, on the command line.
    pub number: usize,
    /// As the driver says.
    pub name: String,
    /// Its interface. The same hardware may be there once per interface.
    pub backend: Backend,
    /// Name and version; may be empty.
    pub driver: String,
    /// Whether it runs on the CPU.
    pub is_software: bool,
    /// What Pointstage needs and it lacks, or nothing.
    pub lacks: Option<String>,
}

fn instance(backends: Backends) -> Instance {
    Instance::new(wgpu::InstanceDescriptor {
        backends,
        // Without this check an indirect dispatch of too many groups may end the device.
        flags: wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL.with_env(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    })
}

/// Adapters of these interfaces with the interface of each, in a fixed order.
fn enumerate(backends: Backends) -> Vec<(Adapter, AdapterInfo, Backend)> {
    pollster::block_on(instance(backends).enumerate_adapters(backends))
        .into_iter()
        .filter_map(|adapter| {
            let info = adapter.get_info();
            let backend = Backend::from_wgpu(info.backend)?;
            Some((adapter, info, backend))
        })
        .collect()
}

pub(super) fn is_software(info: &AdapterInfo) -> bool {
    let name = info.name.to_lowercase();
    info.device_type == DeviceType::Cpu
        || ["llvmpipe", "softpipe", "swiftshader"]
            .iter()
            .any(|software| name.contains(software))
}

pub(super) fn list() -> Vec<AdapterSummary> {
    enumerate(Backends::all())
        .into_iter()
        .enumerate()
        .map(|(number, (adapter, info, backend))| AdapterSummary {
            number,
            backend,
            driver: format!("{} {}", info.driver, info.driver_info)
                .trim()
                .to_owned(),
            is_software: is_software(&info),
            lacks: lacks(&adapter),
            name: info.name,
        })
        .collect()
}

/// How good a choice: real before software, discrete before integrated, GL last.
fn rank(info: &AdapterInfo) -> (bool, u32, bool) {
    let kind = match info.device_type {
        DeviceType::DiscreteGpu => 0,
        DeviceType::IntegratedGpu => 1,
        DeviceType::VirtualGpu => 2,
        DeviceType::Other => 3,
        DeviceType::Cpu => 4,
    };
    (is_software(info), kind, info.backend == wgpu::Backend::Gl)
}

pub(super) fn choose(options: &DeviceOptions) -> Result<Adapter, OpenDeviceError> {
    let mut found = match (&options.adapter, options.backend) {
        // Numbers count all adapters, whatever the interface.
        (Some(_), _) => enumerate(Backends::all()),
        (None, Some(backend)) => enumerate(backend.to_wgpu()),
        (None, None) => {
            let found = enumerate(Backends::all() - Backends::GL);
            let has_hardware = found.iter().any(|(_, info, _)| !is_software(info));
            // GL is asked only where it may bring more, as its drivers write to the terminal.
            if has_hardware || (!found.is_empty() && !may_have_gpu()) {
                found
            } else {
                enumerate(Backends::all())
            }
        }
    };
    if let Some(wanted) = &options.adapter {
        found = named(found, wanted)?;
    }
    if let Some(wanted) = options.backend {
        found.retain(|(_, _, backend)| *backend == wanted);
    }
    found.sort_by_key(|(adapter, info, _)| (lacks(adapter).is_some(), rank(info)));
    match found.into_iter().next() {
        Some((adapter, _, _)) => Ok(adapter),
        None => Err(OpenDeviceError::NoAdapter {
            of_backend: options
                .backend
                .map(|backend| format!(" for {backend}"))
                .unwrap_or_default(),
        }),
    }
}

/// Whether this machine may have a GPU that GL knows. Linux has a device file for each.
fn may_have_gpu() -> bool {
    let files = ["/dev/dri", "/dev/nvidiactl"];
    !cfg!(target_os = "linux") || files.iter().any(|file| Path::new(file).exists())
}

type Found = Vec<(Adapter, AdapterInfo, Backend)>;

/// Those that a number or part of a name means.
fn named(mut found: Found, wanted: &str) -> Result<Found, OpenDeviceError> {
    let existing = found
        .iter()
        .enumerate()
        .map(|(number, (_, info, backend))| format!("{number}: {} ({backend})", info.name))
        .collect::<Vec<_>>()
        .join(", ");
    let chosen = match wanted.parse::<usize>() {
        Ok(number) if number < found.len() => vec![found.swap_remove(number)],
        _ => {
            let wanted = wanted.to_lowercase();
            found.retain(|(_, info, _)| info.name.to_lowercase().contains(&wanted));
            found
        }
    };
    if !chosen.is_empty() {
        return Ok(chosen);
    }
    if existing.is_empty() {
        return Err(OpenDeviceError::NoAdapter {
            of_backend: String::new(),
        });
    }
    Err(OpenDeviceError::UnknownAdapter {
        wanted: wanted.into(),
        existing,
    })
}

/// What Pointstage needs and the adapter lacks.
fn lacks(adapter: &Adapter) -> Option<String> {
    let flags = adapter.get_downlevel_capabilities().flags;
    let needed = [
        (DownlevelFlags::COMPUTE_SHADERS, "compute shaders"),
        (
            DownlevelFlags::VERTEX_STORAGE,
            "storage buffers in vertex shaders",
        ),
        (
            DownlevelFlags::FRAGMENT_WRITABLE_STORAGE,
            "storage buffers in fragment shaders",
        ),
    ];
    if let Some((_, what)) = needed.iter().find(|(flag, _)| !flags.contains(*flag)) {
        return Some((*what).into());
    }
    let count = adapter.limits().max_storage_buffers_per_shader_stage;
    (count < STORAGE_BUFFERS_PER_STAGE).then(|| {
        format!("storage buffers ({count} of {STORAGE_BUFFERS_PER_STAGE} per shader stage)")
    })
}

pub(super) fn check_suitable(adapter: &Adapter, info: &AdapterInfo) -> Result<(), OpenDeviceError> {
    match lacks(adapter) {
        Some(lacks) => Err(OpenDeviceError::Unsuitable {
            adapter: info.name.clone(),
            lacks,
        }),
        None => Ok(()),
    }
}
