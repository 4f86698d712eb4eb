//! The scene on the device: each column once, shared by every renderer; and the bind groups of group 1.

use super::request::ViewportId;
use crate::device::{GpuDevice, GpuError};
use crate::gpu::GpuService;
use pointstage_plugin_api::abi::{Handle, standard_bindings as bindings};
use pointstage_plugin_api::manifest::Needs;
use pointstage_scene::{Block, NamedColumn, Scene};
use std::any::Any;
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::sync::{Arc, Mutex, PoisonError};

/// A column on the device. The content on the CPU is kept alive, so that its address stays its name.
struct Uploaded {
    _content: Box<dyn Any + Send + Sync>,
    buffer: wgpu::Buffer,
    handle: Handle,
}

/// Columns and bind groups on one device. Any thread.
pub(super) struct SceneOnDevice {
    device: Arc<GpuDevice>,
    service: Arc<GpuService>,
    /// Stands in for absent columns: shaders check the flags before they read it.
    dummy: wgpu::Buffer,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    columns: HashMap<usize, Uploaded>,
    kept: HashMap<ViewportId, Kept>,
    groups: HashMap<[wgpu::Buffer; 6], Handle>,
}

/// What stays on the device for a viewport, by the address of the content.
#[derive(Default)]
struct Kept {
    /// The scene that is or was prepared for its next frames.
    prepared: HashSet<usize>,
    /// What its last frame drew.
    drawn: HashSet<usize>,
}

/// What a renderer needs on the device beside the standard columns.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Extra {
    /// Named columns, as f32.
    pub columns: Vec<String>,
    /// The triangles.
    pub mesh: bool,
}

impl Extra {
    /// What the manifest asks for.
    pub(super) fn of(needs: &Needs) -> Self {
        Self {
            columns: needs.columns.clone(),
            mesh: needs.mesh,
        }
    }
}

impl SceneOnDevice {
    pub(super) fn new(
        device: &Arc<GpuDevice>,
        service: &Arc<GpuService>,
    ) -> Result<Self, GpuError> {
        let dummy = device.scoped(|| {
            device.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("absent column"),
                size: 64,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        })?;
        let (device, service) = (Arc::clone(device), Arc::clone(service));
        Ok(Self {
            device,
            service,
            dummy,
            state: Mutex::default(),
        })
    }

    /// Uploads what of the scene and of `others` is not on the device yet, for a frame of `viewport`, and forgets what no
    /// viewport's last frame drew. Viewports that draw the same scene share its columns.
    pub(super) fn update<'a>(
        &self,
        viewport: ViewportId,
        scene: &Scene,
        others: impl Iterator<Item = &'a Block>,
        extra: &Extra,
    ) -> Result<(), GpuError> {
        let mut wanted = self.upload_columns(scene, extra)?;
        for block in others {
            self.upload_block(block, &mut wanted)?;
        }
        self.lock().kept.entry(viewport).or_default().drawn = wanted;
        self.forget_unkept();
        Ok(())
    }

    /// Uploads what of the scene is not on the device yet: something is prepared from it for `viewport`, whose last frame
    /// may have drawn another one.
    pub(super) fn prepare(
        &self,
        viewport: ViewportId,
        scene: &Scene,
        extra: &Extra,
    ) -> Result<(), GpuError> {
        let wanted = self.upload_columns(scene, extra)?;
        self.lock().kept.entry(viewport).or_default().prepared = wanted;
        Ok(())
    }

    /// A viewport was closed: what it alone drew is forgotten.
    pub(super) fn forget_viewport(&self, viewport: ViewportId) {
        self.lock().kept.remove(&viewport);
        self.forget_unkept();
    }

    /// Uploads what of the scene is not on the device yet; the addresses of all that it has.
    fn upload_columns(&self, scene: &Scene, extra: &Extra) -> Result<HashSet<usize>, GpuError> {
        let mut wanted = HashSet::new();
        for object in scene.objects() {
            for block in &object.geometry.blocks {
                self.upload_block(block, &mut wanted)?;
                for column in block
                    .named
                    .iter()
                    .filter(|column| extra.columns.iter().any(|name| **name == *column.name))
                {
                    wanted.insert(column.bytes.as_ptr().addr());
                    let values = Arc::new(column.bytes.clone());
                    self.upload(&values, "named column", || as_f32(column).into())?;
                }
                // What another renderer asked for stays while the scene has it.
                wanted.extend(
                    block
                        .named
                        .iter()
                        .map(|column| column.bytes.as_ptr().addr()),
                );
            }
            if let Some(triangles) = &object.geometry.triangles {
                wanted.insert(triangles.as_ptr().addr());
                if extra.mesh {
                    self.upload(triangles, "triangles", || {
                        bytemuck::cast_slice(triangles).into()
                    })?;
                }
            }
        }
        Ok(wanted)
    }

    fn upload_block(&self, block: &Block, wanted: &mut HashSet<usize>) -> Result<(), GpuError> {
        wanted.insert(block.position_radius.as_ptr().addr());
        self.upload(&block.position_radius, "position_radius", || {
            bytemuck::cast_slice(&block.position_radius).into()
        })?;
        if let Some(column) = &block.normal {
            wanted.insert(column.as_ptr().addr());
            self.upload(column, "normal", || bytemuck::cast_slice(column).into())?;
        }
        if let Some(column) = &block.colour {
            wanted.insert(column.as_ptr().addr());
            self.upload(column, "colour", || bytemuck::cast_slice(column).into())?;
        }
        if let Some(column) = &block.axes {
            wanted.insert(column.as_ptr().addr());
            self.upload(column, "axes", || bytemuck::cast_slice(column).into())?;
        }
        Ok(())
    }

    /// Uploads a column, a slice or a vector, and keeps it as long as its buffer.
    fn upload<'a, T, C: AsRef<[T]> + ?Sized + Send + Sync + 'static>(
        &self,
        content: &Arc<C>,
        label: &str,
        bytes: impl FnOnce() -> Cow<'a, [u8]>,
    ) -> Result<(), GpuError> {
        let values: &[T] = (**content).as_ref();
        let address = values.as_ptr().addr();
        if values.is_empty() || self.lock().columns.contains_key(&address) {
            return Ok(());
        }
        let buffer = self.device.scoped(|| {
            let mut bytes = bytes();
            if !bytes.len().is_multiple_of(4) {
                let whole = bytes.len().next_multiple_of(4);
                bytes.to_mut().resize(whole, 0);
            }
            let buffer = self.device.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: bytes.len() as u64,
                usage: wgpu::BufferUsages::STORAGE
                    | wgpu::BufferUsages::VERTEX
                    | wgpu::BufferUsages::INDEX
                    | wgpu::BufferUsages::COPY_SRC
                    | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            self.device.queue.write_buffer(&buffer, 0, &bytes);
            buffer
        })?;
        let handle = self.service.import_buffer(buffer.clone());
        let uploaded = Uploaded {
            _content: Box::new(Arc::clone(content)),
            buffer,
            handle,
        };
        self.lock().columns.insert(address, uploaded);
        Ok(())
    }

    fn forget_unkept(&self) {
        let mut state = self.lock();
        let State {
            columns,
            kept,
            groups,
        } = &mut *state;
        let is_kept = |address: &usize| {
            let holds =
                |kept: &Kept| kept.drawn.contains(address) || kept.prepared.contains(address);
            kept.values().any(holds)
        };
        let gone: Vec<Uploaded> = columns
            .extract_if(|address, _| !is_kept(address))
            .map(|(_, uploaded)| uploaded)
            .collect();
        for uploaded in &gone {
            self.service.release(uploaded.handle);
            for (_, group) in groups.extract_if(|buffers, _| buffers.contains(&uploaded.buffer)) {
                self.service.release(group);
            }
        }
    }

    /// The handle of a column by the address of its content.
    pub(super) fn handle(&self, content: *const u8) -> Handle {
        self.lock()
            .columns
            .get(&content.addr())
            .map_or(Handle::NONE, |uploaded| uploaded.handle)
    }

    /// Bytes of the scene on the device.
    pub(super) fn bytes(&self) -> u64 {
        self.lock()
            .columns
            .values()
            .map(|uploaded| uploaded.buffer.size())
            .sum()
    }

    /// Group 1 for a block, with a draw's numbers and counter, if it has them.
    pub(super) fn columns_group(
        &self,
        block: &Block,
        indices: Option<&wgpu::Buffer>,
        indirect: Option<&wgpu::Buffer>,
    ) -> Result<Handle, GpuError> {
        let mut state = self.lock();
        let buffer = |address: Option<usize>| {
            let uploaded = address.and_then(|address| state.columns.get(&address));
            uploaded.map_or_else(|| self.dummy.clone(), |uploaded| uploaded.buffer.clone())
        };
        let buffers = [
            buffer(Some(block.position_radius.as_ptr().addr())),
            buffer(block.normal.as_ref().map(|column| column.as_ptr().addr())),
            buffer(block.colour.as_ref().map(|column| column.as_ptr().addr())),
            buffer(block.axes.as_ref().map(|column| column.as_ptr().addr())),
            indices.unwrap_or(&self.dummy).clone(),
            indirect.unwrap_or(&self.dummy).clone(),
        ];
        if let Some(&handle) = state.groups.get(&buffers) {
            return Ok(handle);
        }
        const BINDINGS: [u32; 6] = [
            bindings::POSITION_RADIUS,
            bindings::NORMAL,
            bindings::COLOUR,
            bindings::AXES,
            bindings::INDICES,
            bindings::INDIRECT,
        ];
        let entries: Vec<_> = BINDINGS
            .iter()
            .zip(&buffers)
            .map(|(&binding, buffer)| wgpu::BindGroupEntry {
                binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        let group = self.device.scoped(|| {
            self.device
                .device
                .create_bind_group(&wgpu::BindGroupDescriptor {
                    label: Some("columns"),
                    layout: self.service.columns_layout(),
                    entries: &entries,
                })
        })?;
        let handle = self.service.import_bind_group(group, 1);
        // Groups with a draw's own buffers would pile up: they live for one frame (see `drop_draw_groups`).
        state.groups.insert(buffers, handle);
        Ok(handle)
    }

    /// Frees the groups that were made for draws with numbers or counters of their own.
    pub(super) fn drop_draw_groups(&self) {
        let mut state = self.lock();
        let own =
            |buffers: &[wgpu::Buffer; 6]| buffers[4] != self.dummy || buffers[5] != self.dummy;
        for (_, handle) in state.groups.extract_if(|buffers, _| own(buffers)) {
            self.service.release(handle);
        }
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for SceneOnDevice {
    fn drop(&mut self) {
        let state = self.lock();
        let handles = state
            .columns
            .values()
            .map(|uploaded| uploaded.handle)
            .chain(state.groups.values().copied());
        handles.for_each(|handle| self.service.release(handle));
    }
}

/// A named column's values as f32.
fn as_f32(column: &NamedColumn) -> Vec<u8> {
    let count = column.bytes.len() / column.scalar.size();
    let values = (0..count).map(|index| {
        let value = column
            .scalar
            .read(&column.bytes[index * column.scalar.size()..]);
        value.unwrap_or(f64::NAN) as f32
    });
    values.flat_map(f32::to_ne_bytes).collect()
}
