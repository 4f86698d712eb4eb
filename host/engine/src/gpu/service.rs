//! The service itself: one table of resources for one device, its owners, and the host's own resources.

use super::bytes::OwnerState;
use super::convert;
use super::features;
use super::handles::{BufferEntry, GroupEntry, LayoutEntry, Owner, Resource, Table, TextureEntry};
use super::object::OwnerGpu;
use super::timing::Pool;
use crate::device::{GpuDevice, GpuError};
use abi_stable::sabi_trait::TD_Opaque;
use abi_stable::std_types::RArc;
use pointstage_plugin_api::abi::{
    BindingKind, BindingLayoutRecord, DrawUniform, FrameUniform, GpuObject_TO, GpuRef, Handle,
    ShaderStages, standard_bindings,
};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};
use std::time::Duration;
use wgpu::Features;

/// The GPU service of one device. Thread: any.
#[derive(Debug)]
pub struct GpuService {
    pub(super) gpu: Arc<GpuDevice>,
    pub(super) timings: Arc<Pool>,
    table: RwLock<Table>,
    next_owner: AtomicU32,
    standard_layouts: [wgpu::BindGroupLayout; 2],
    standard_handles: [Handle; 2],
}

/// Who calls: an owner that was there when the call began.
#[derive(Clone, Debug)]
pub(super) struct Caller {
    pub(super) owner: Owner,
    pub(super) state: Arc<OwnerState>,
}

impl GpuService {
    /// A service for this device, without owners.
    ///
    /// # Panics
    ///
    /// Never: the standard bindings are constants, which the tests convert.
    pub fn new(gpu: Arc<GpuDevice>) -> Arc<Self> {
        let mut table = Table::default();
        let made = [
            ("frame and draw", frame_bindings()),
            ("columns", columns_bindings()),
        ]
        .map(|(label, bindings)| {
            let entries: Vec<_> = bindings
                .iter()
                .map(|binding| {
                    super::bindings::layout_entry(binding).expect("the standard bindings are valid")
                })
                .collect();
            let layout = gpu
                .device
                .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                    label: Some(label),
                    entries: &entries,
                });
            let handle = table.insert(
                Owner::HOST,
                LayoutEntry {
                    layout: layout.clone(),
                    bindings,
                },
            );
            (layout, handle)
        });
        let [
            (frame_layout, frame_handle),
            (columns_layout, columns_handle),
        ] = made;
        Arc::new(Self {
            timings: Arc::new(Pool::new(&gpu)),
            gpu,
            table: RwLock::new(table),
            // 0 is the host.
            next_owner: AtomicU32::new(1),
            standard_layouts: [frame_layout, columns_layout],
            standard_handles: [frame_handle, columns_handle],
        })
    }

    /// The device.
    pub fn device(&self) -> &Arc<GpuDevice> {
        &self.gpu
    }

    /// Layout of group 0: frame and draw.
    pub fn frame_layout(&self) -> &wgpu::BindGroupLayout {
        &self.standard_layouts[0]
    }

    /// Layout of group 1: columns.
    pub fn columns_layout(&self) -> &wgpu::BindGroupLayout {
        &self.standard_layouts[1]
    }

    /// Adds an owner: one plugin instance.
    ///
    /// * `granted_features`: names that its manifest asks for; those that the device lacks or nobody knows are left out.
    /// * `quota_bytes`: the most that it may hold on the device.
    pub fn owner(&self, name: &str, granted_features: &[String], quota_bytes: u64) -> Owner {
        let granted = granted_features
            .iter()
            .filter_map(|name| features::by_name(name))
            .fold(Features::empty(), |all, feature| all | feature)
            & self.gpu.features;
        let owner = Owner(self.next_owner.fetch_add(1, Ordering::Relaxed));
        let state = OwnerState::new(name, granted, quota_bytes);
        self.write().add_owner(owner, Arc::new(state));
        owner
    }

    /// The service as the owner's plugin sees it. After [`free_owner`](Self::free_owner) all its calls are errors.
    pub fn object(self: &Arc<Self>, owner: Owner) -> GpuRef {
        let state = self.read().owner(owner).cloned().unwrap_or_else(|| {
            let state = OwnerState::new("freed plugin", Features::empty(), 0);
            state.freed.store(true, Ordering::Release);
            Arc::new(state)
        });
        let object = OwnerGpu {
            service: Arc::clone(self),
            caller: Caller { owner, state },
        };
        GpuObject_TO::from_ptr(RArc::new(object), TD_Opaque)
    }

    /// Makes a buffer of the host usable by every owner, for reading.
    pub fn import_buffer(&self, buffer: wgpu::Buffer) -> Handle {
        let usage = convert::buffer_usage_from_wgpu(buffer.usage());
        self.write().insert(
            Owner::HOST,
            BufferEntry {
                buffer,
                usage,
                charge: None,
            },
        )
    }

    /// Makes a texture of the host usable by every owner: as attachment, storage or sampled, as its usage allows.
    pub fn import_texture(&self, texture: wgpu::Texture) -> Handle {
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        self.write().insert(
            Owner::HOST,
            TextureEntry {
                texture,
                view,
                charge: None,
            },
        )
    }

    /// Makes a bind group of the host usable by every owner. `layout`: 0 for group 0, 1 for group 1.
    pub fn import_bind_group(&self, group: wgpu::BindGroup, layout: u32) -> Handle {
        self.write().insert(
            Owner::HOST,
            GroupEntry {
                group,
                dynamic_offsets: usize::from(layout == 0),
                charges: Vec::new(),
            },
        )
    }

    /// Takes back what was imported. Of no effect on what a plugin owns.
    pub fn release(&self, handle: Handle) {
        if self.standard_handles.contains(&handle) {
            return;
        }
        self.remove(Owner::HOST, handle);
    }

    /// A buffer that the owner made, for the host to use.
    ///
    /// # Errors
    ///
    /// The handle is none of that owner's buffers.
    pub fn buffer(&self, owner: Owner, handle: Handle) -> Result<wgpu::Buffer, GpuError> {
        self.gpu.check_not_lost()?;
        Ok(self.read().buffer(owner, handle)?.buffer.clone())
    }

    /// Bytes that the owner holds on the device.
    pub fn bytes(&self, owner: Owner) -> u64 {
        self.read().owner(owner).map_or(0, |state| state.held())
    }

    /// Number of live handles of the owner.
    pub fn handle_count(&self, owner: Owner) -> usize {
        self.read().count(owner)
    }

    /// Frees all that the owner made, and the owner.
    pub fn free_owner(&self, owner: Owner) {
        if owner != Owner::HOST {
            let removed = self.write().remove_owner(owner);
            // After the lock: freeing may take the driver a while.
            drop(removed);
        }
    }

    /// Waits until the device has done everything submitted so far.
    ///
    /// # Errors
    ///
    /// The device is lost, or `timeout` has passed.
    pub fn wait_idle(&self, timeout: Duration) -> Result<(), GpuError> {
        self.gpu.wait_idle(timeout)
    }

    pub(super) fn caller(&self, owner: Owner) -> Result<Caller, GpuError> {
        match self.read().owner(owner) {
            Some(state) => Ok(Caller {
                owner,
                state: Arc::clone(state),
            }),
            None => Err(freed()),
        }
    }

    pub(super) fn standard_layout(&self, index: u32) -> Result<Handle, GpuError> {
        self.standard_handles
            .get(index as usize)
            .copied()
            .ok_or_else(|| {
                GpuError::Unsupported(format!(
                    "standard layout {index} is not known to this host; it has 0 (frame and draw) and 1 (columns)"
                ))
            })
    }

    pub(super) fn read(&self) -> RwLockReadGuard<'_, Table> {
        self.table.read().unwrap_or_else(PoisonError::into_inner)
    }

    fn write(&self) -> RwLockWriteGuard<'_, Table> {
        self.table.write().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a resource, unless its owner was freed meanwhile.
    pub(super) fn insert(
        &self,
        caller: &Caller,
        resource: impl Into<Resource>,
    ) -> Result<Handle, GpuError> {
        let mut table = self.write();
        if caller.state.freed.load(Ordering::Acquire) {
            return Err(freed());
        }
        Ok(table.insert(caller.owner, resource))
    }

    pub(super) fn remove(&self, owner: Owner, handle: Handle) {
        let removed = self.write().remove(owner, handle);
        drop(removed);
    }
}

fn freed() -> GpuError {
    GpuError::BadHandle(
        "everything of this plugin instance was freed; make no calls after it was dropped".into(),
    )
}

const ALL_STAGES: ShaderStages = ShaderStages(7);

fn frame_bindings() -> Vec<BindingLayoutRecord> {
    let uniform = |binding, size: usize, dynamic_offset| BindingLayoutRecord {
        binding,
        visibility: ALL_STAGES,
        kind: BindingKind::UNIFORM_BUFFER,
        dynamic_offset,
        min_size: size as u64,
        ..Default::default()
    };
    vec![
        uniform(standard_bindings::FRAME, size_of::<FrameUniform>(), 0),
        uniform(standard_bindings::DRAW, size_of::<DrawUniform>(), 1),
    ]
}

fn columns_bindings() -> Vec<BindingLayoutRecord> {
    [
        standard_bindings::POSITION_RADIUS,
        standard_bindings::NORMAL,
        standard_bindings::COLOUR,
        standard_bindings::AXES,
        standard_bindings::INDICES,
        standard_bindings::INDIRECT,
    ]
    .into_iter()
    .map(|binding| BindingLayoutRecord {
        binding,
        visibility: ALL_STAGES,
        kind: BindingKind::STORAGE_BUFFER_READ,
        ..Default::default()
    })
    .collect()
}
