//! What is drawn this frame: all of the scene, or what a structure selects; each draw with its uniform, ids and groups.

use super::ids::{IdSource, IdTable};
use super::upload::SceneOnDevice;
use crate::device::{GpuDevice, GpuError};
use crate::gpu::{GpuService, Owner};
use abi_stable::std_types::RSlice;
use pointstage_plugin_api::abi::{
    BlockRecord, BlockSource, DrawFlags, DrawRecord, DrawUniform, Handle, SelectedDrawRecord,
    StructureBlockRecord, StructureBox,
};
use pointstage_plugin_api::{Error, columns};
use pointstage_scene::{Block, Scene};
use std::sync::Arc;

/// A structure's own block, copied: its columns belong to the host.
#[derive(Clone)]
pub(super) struct OwnBlock {
    /// Number of the object in the scene.
    pub object: u32,
    /// The columns.
    pub block: Block,
}

/// Copies a structure's own blocks.
pub(super) fn own_blocks(structure: &StructureBox) -> Result<Vec<OwnBlock>, Error> {
    let records = structure.blocks().into_result().map_err(Error::from)?;
    records
        .iter()
        .enumerate()
        .map(|(number, record)| own_block(number, record))
        .collect()
}

fn own_block(number: usize, record: &StructureBlockRecord<'_>) -> Result<OwnBlock, Error> {
    fn column<T: bytemuck::AnyBitPattern>(
        number: usize,
        record: &StructureBlockRecord<'_>,
        name: &str,
    ) -> Result<Option<Arc<[T]>>, Error> {
        let Some(column) = record
            .columns
            .iter()
            .find(|column| column.name.as_str() == name)
        else {
            return Ok(None);
        };
        let bytes = column.bytes.as_slice();
        let expected = record.surfel_count as usize * size_of::<T>();
        if bytes.len() != expected {
            let found = bytes.len();
            return Err(Error::failed(format!(
                "own block {number}: column '{name}' has {found} bytes, not {expected}"
            )));
        }
        Ok(Some(
            bytes
                .chunks_exact(size_of::<T>())
                .map(bytemuck::pod_read_unaligned)
                .collect(),
        ))
    }
    let position_radius = column(number, record, columns::POSITION_RADIUS)?;
    let missing = || {
        Error::failed(format!(
            "own block {number} has no column 'position_radius'"
        ))
    };
    let block = Block {
        position_radius: position_radius.ok_or_else(missing)?,
        normal: column(number, record, columns::NORMAL)?,
        colour: column(number, record, columns::COLOUR)?,
        axes: column(number, record, columns::AXES)?,
        named: Vec::new(),
    };
    Ok(OwnBlock {
        object: record.object,
        block,
    })
}

/// One draw, before it has a place in the frame's buffers.
pub(super) struct PlannedDraw<'a> {
    pub object: u32,
    pub block: &'a Block,
    pub uniform: DrawUniform,
    pub indices: Vec<u32>,
    /// A structure's buffers with numbers and counter.
    pub index_buffer: Handle,
    pub indirect_buffer: Handle,
}

/// Why a structure's selection was refused.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[error("draw {draw} of the selection: {what}")]
pub struct SelectionError {
    draw: usize,
    what: String,
}

/// Every block of every visible object.
pub(super) fn whole_scene<'a>(
    scene: &'a Scene,
    objects: &[DrawUniform],
    ids: &mut IdTable,
) -> Vec<PlannedDraw<'a>> {
    let mut draws = Vec::new();
    for (index, (object, uniform)) in scene.objects().iter().zip(objects).enumerate() {
        let mut first_surfel = 0;
        for (number, block) in object.geometry.blocks.iter().enumerate() {
            let count = block.len() as u32;
            if object.visible && count > 0 {
                let id_base = ids.base(
                    object.id,
                    IdSource::Scene,
                    number as u32,
                    first_surfel,
                    count,
                );
                let uniform = DrawUniform {
                    first: 0,
                    count,
                    id_base,
                    ..with_columns(*uniform, block)
                };
                let (indices, index_buffer, indirect_buffer) =
                    (Vec::new(), Handle::NONE, Handle::NONE);
                draws.push(PlannedDraw {
                    object: index as u32,
                    block,
                    uniform,
                    indices,
                    index_buffer,
                    indirect_buffer,
                });
            }
            first_surfel += u64::from(count);
        }
    }
    draws
}

/// What a structure selected, checked against the blocks that there are.
pub(super) fn of_structure<'a>(
    scene: &'a Scene,
    own: &'a [OwnBlock],
    selected: &[SelectedDrawRecord],
    objects: &[DrawUniform],
    ids: &mut IdTable,
) -> Result<Vec<PlannedDraw<'a>>, SelectionError> {
    let mut draws = Vec::with_capacity(selected.len());
    for (draw, record) in selected.iter().enumerate() {
        let refuse = |what: String| SelectionError { draw, what };
        let object = scene.objects().get(record.object as usize);
        let (Some(object), Some(uniform)) = (object, objects.get(record.object as usize)) else {
            return Err(refuse(format!(
                "object {} of {}",
                record.object,
                scene.objects().len()
            )));
        };
        let (block, source) = match record.source {
            BlockSource::SCENE => (
                object.geometry.blocks.get(record.block as usize),
                IdSource::Scene,
            ),
            BlockSource::STRUCTURE => {
                let own = own
                    .get(record.block as usize)
                    .filter(|own| own.object == record.object);
                (own.map(|own| &own.block), IdSource::Structure)
            }
            other => {
                return Err(refuse(format!(
                    "block source {other:?} is not known to this host"
                )));
            }
        };
        let block = block
            .ok_or_else(|| refuse(format!("{source:?} block {} does not exist", record.block)))?;
        if !object.visible || record.count == 0 {
            continue;
        }
        check_range(record, block).map_err(refuse)?;
        let blocks_before = object.geometry.blocks.iter().take(record.block as usize);
        let first_surfel = if source == IdSource::Scene {
            blocks_before.map(|b| b.len() as u64).sum()
        } else {
            0
        };
        let id_base = ids.base(
            object.id,
            source,
            record.block,
            first_surfel,
            block.len() as u32,
        );
        let mut uniform = DrawUniform {
            first: record.first,
            count: record.count,
            id_base,
            indirect_index: (record.indirect_offset / 4) as u32,
            level: record.level,
            error: record.error,
            ..with_columns(*uniform, block)
        };
        let indexed = !record.indices.is_empty() || record.index_buffer.is_some();
        for (on, flag) in [
            (indexed, DrawFlags::INDEXED),
            (record.indirect_buffer.is_some(), DrawFlags::INDIRECT),
            (source == IdSource::Structure, DrawFlags::NODES),
        ] {
            uniform.flags |= if on { flag.0 } else { 0 };
        }
        draws.push(PlannedDraw {
            object: record.object,
            block,
            uniform,
            indices: record.indices.to_vec(),
            index_buffer: record.index_buffer,
            indirect_buffer: record.indirect_buffer,
        });
    }
    Ok(draws)
}

fn check_range(record: &SelectedDrawRecord, block: &Block) -> Result<(), String> {
    let end = u64::from(record.first) + u64::from(record.count);
    let (what, length) = match (record.indices.is_empty(), record.index_buffer.is_some()) {
        (false, _) => ("its numbers", record.indices.len()),
        (true, true) => return Ok(()), // a buffer of the structure: shaders check their numbers
        (true, false) => ("the block", block.len()),
    };
    if end > length as u64 {
        return Err(format!(
            "entries {}..{end} of {what}, which has {length}",
            record.first
        ));
    }
    match record
        .indices
        .iter()
        .find(|&&surfel| surfel as usize >= block.len())
    {
        Some(surfel) => Err(format!("surfel {surfel} of a block of {}", block.len())),
        None => Ok(()),
    }
}

fn with_columns(mut uniform: DrawUniform, block: &Block) -> DrawUniform {
    for (has, flag) in [
        (block.normal.is_some(), DrawFlags::HAS_NORMAL),
        (block.colour.is_some(), DrawFlags::HAS_COLOUR),
        (block.axes.is_some(), DrawFlags::HAS_AXES),
    ] {
        uniform.flags |= if has { flag.0 } else { 0 };
    }
    uniform
}

/// The frame's buffers of one viewport: frame uniform, draw uniforms, and their bind group.
pub(super) struct FrameBuffers {
    device: Arc<GpuDevice>,
    service: Arc<GpuService>,
    frame: wgpu::Buffer,
    draws: wgpu::Buffer,
    group: Handle,
    stride: u32,
}

impl FrameBuffers {
    pub(super) fn new(
        device: &Arc<GpuDevice>,
        service: &Arc<GpuService>,
        draw_count: usize,
    ) -> Result<Self, GpuError> {
        let alignment = device.limits.min_uniform_buffer_offset_alignment;
        let stride = (size_of::<DrawUniform>() as u32).next_multiple_of(alignment.max(1));
        let buffer = |label, size: u64| {
            device.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let (frame, draws, group) = device.scoped(|| {
            let frame = buffer(
                "frame",
                size_of::<pointstage_plugin_api::abi::FrameUniform>() as u64,
            );
            let draws = buffer(
                "draws",
                u64::from(stride) * draw_count.max(1).next_power_of_two() as u64,
            );
            let one_draw = wgpu::BufferBinding {
                buffer: &draws,
                offset: 0,
                size: std::num::NonZeroU64::new(size_of::<DrawUniform>() as u64),
            };
            let group = device.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("frame"),
                layout: service.frame_layout(),
                entries: &[
                    wgpu::BindGroupEntry {
                        binding: 0,
                        resource: frame.as_entire_binding(),
                    },
                    wgpu::BindGroupEntry {
                        binding: 1,
                        resource: wgpu::BindingResource::Buffer(one_draw),
                    },
                ],
            });
            (frame, draws, group)
        })?;
        let group = service.import_bind_group(group, 0);
        Ok(Self {
            device: Arc::clone(device),
            service: Arc::clone(service),
            frame,
            draws,
            group,
            stride,
        })
    }

    /// Whether so many draws fit.
    pub(super) fn fits(&self, draw_count: usize) -> bool {
        draw_count as u64 * u64::from(self.stride) <= self.draws.size()
    }

    /// Group 0.
    pub(super) fn group(&self) -> Handle {
        self.group
    }

    /// Dynamic offset of a draw.
    pub(super) fn offset(&self, draw: usize) -> u32 {
        draw as u32 * self.stride
    }

    pub(super) fn write(
        &self,
        frame: &pointstage_plugin_api::abi::FrameUniform,
        draws: &[PlannedDraw<'_>],
    ) {
        self.device
            .queue
            .write_buffer(&self.frame, 0, bytemuck::bytes_of(frame));
        let mut bytes = vec![0; draws.len() * self.stride as usize];
        for (draw, place) in draws
            .iter()
            .zip(bytes.chunks_exact_mut(self.stride as usize))
        {
            place[..size_of::<DrawUniform>()].copy_from_slice(bytemuck::bytes_of(&draw.uniform));
        }
        self.device.queue.write_buffer(&self.draws, 0, &bytes);
    }
}

impl Drop for FrameBuffers {
    fn drop(&mut self) {
        self.service.release(self.group);
    }
}

/// Group 1 of each draw, with the structure's buffers or uploaded numbers where it has them.
pub(super) fn draw_groups(
    draws: &[PlannedDraw<'_>],
    on_device: &SceneOnDevice,
    device: &GpuDevice,
    service: &GpuService,
    structure: Option<Owner>,
) -> Result<Vec<Handle>, GpuError> {
    let lent = |handle: Handle| match (handle.is_some(), structure) {
        (true, Some(owner)) => service.buffer(owner, handle).map(Some),
        _ => Ok(None),
    };
    draws
        .iter()
        .map(|draw| {
            let indices = match lent(draw.index_buffer)? {
                Some(buffer) => Some(buffer),
                None if draw.indices.is_empty() => None,
                None => Some(device.scoped(|| {
                    let buffer = device.device.create_buffer(&wgpu::BufferDescriptor {
                        label: Some("selected surfels"),
                        size: draw.indices.len() as u64 * 4,
                        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
                        mapped_at_creation: false,
                    });
                    device
                        .queue
                        .write_buffer(&buffer, 0, bytemuck::cast_slice(&draw.indices));
                    buffer
                })?),
            };
            let indirect = lent(draw.indirect_buffer)?;
            on_device.columns_group(draw.block, indices.as_ref(), indirect.as_ref())
        })
        .collect()
}

/// The draws as border records. `blocks` are the records of the draws' blocks, in the same order.
pub(super) fn draw_records<'a>(
    draws: &'a [PlannedDraw<'a>],
    blocks: &[BlockRecord<'a>],
    place: impl Fn(usize) -> (u32, Handle),
) -> Vec<DrawRecord<'a>> {
    let records = draws
        .iter()
        .zip(blocks)
        .enumerate()
        .map(|(number, (draw, block))| {
            let (uniform_offset, columns_group) = place(number);
            DrawRecord {
                object: draw.object,
                block: *block,
                uniform: draw.uniform,
                uniform_offset,
                columns_group,
                indices: RSlice::from_slice(&draw.indices),
                indirect_buffer: draw.indirect_buffer,
            }
        });
    records.collect()
}
