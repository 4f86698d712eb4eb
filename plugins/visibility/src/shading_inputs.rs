//! What shading reads besides the scene: the blocks' ranges of ids, and where what is visible is kept.

use crate::draws::DrawList;
use crate::pipelines::{Prepared, Source};
use pointstage_plugin_api::Result;
use pointstage_plugin_api::abi::{self, BufferUsage, Handle};
use pointstage_plugin_api::gpu::{AsHandle as _, BindGroup, Buffer, Gpu};

/// `BlockUniform` of the shading pass (first id, number of ids, whether it is the first block), padded to an offset that every
/// device accepts.
type BlockUniform = [u32; 64];

/// Bytes from one block's uniform to the next.
pub const BLOCK_STRIDE: u32 = size_of::<BlockUniform>() as u32;

/// What a viewport keeps of them from frame to frame.
#[derive(Default)]
pub(crate) struct ShadingInputs {
    blocks: Option<BlockUniforms>,
    group: Option<ShadingGroup>,
}

struct BlockUniforms {
    capacity: usize,
    buffer: Buffer,
}

/// Group 2 of shading, for what it was made of.
struct ShadingGroup {
    visible: Handle,
    blocks: Handle,
    group: BindGroup,
}

impl ShadingInputs {
    /// Writes the blocks' id ranges; the buffer with them.
    ///
    /// # Errors
    /// If the device refuses the buffer.
    pub(crate) fn write_blocks(&mut self, gpu: &Gpu, list: &DrawList) -> Result<Buffer> {
        let blocks = list.blocks.iter().enumerate();
        let uniforms: Vec<_> = blocks
            .map(|(number, block)| {
                let mut uniform: BlockUniform = [0; 64];
                uniform[0] = block.id_base;
                uniform[1] = block.id_count;
                uniform[2] = u32::from(number == 0);
                uniform
            })
            .collect();
        let buffer = match &self.blocks {
            Some(blocks) if blocks.capacity >= uniforms.len() => blocks.buffer.clone(),
            _ => {
                let capacity = uniforms.len().next_power_of_two();
                let bytes = capacity as u64 * u64::from(BLOCK_STRIDE);
                let usage = BufferUsage::UNIFORM | BufferUsage::COPY_DST;
                let buffer = gpu.buffer("blocks", bytes, usage)?;
                self.blocks = Some(BlockUniforms {
                    capacity,
                    buffer: buffer.clone(),
                });
                buffer
            }
        };
        gpu.write(&buffer, 0, &uniforms)?;
        Ok(buffer)
    }

    /// Group 2 of shading. It is kept, since the host replays commands after `render`.
    ///
    /// # Errors
    /// If the device refuses it.
    pub(crate) fn group(
        &mut self,
        prepared: &Prepared,
        source: Source,
        visible: Handle,
        blocks: &Buffer,
    ) -> Result<BindGroup> {
        let blocks = blocks.as_handle();
        if let Some(kept) = &self.group
            && kept.visible == visible
            && kept.blocks == blocks
        {
            return Ok(kept.group.clone());
        }
        let layout = match source {
            Source::Ids => &prepared.ids_layout,
            Source::Pixels => &prepared.visible_layout,
        };
        let entries = [
            abi::BindingRecord {
                binding: 0,
                resource: visible,
                ..Default::default()
            },
            abi::BindingRecord {
                binding: 1,
                resource: blocks,
                offset: 0,
                size: u64::from(BLOCK_STRIDE),
            },
        ];
        let group = prepared.gpu.bind_group_from(&abi::BindGroupDescriptor {
            label: "visible".into(),
            layout: layout.handle(),
            entries: entries.as_slice().into(),
        })?;
        self.group = Some(ShadingGroup {
            visible,
            blocks,
            group: group.clone(),
        });
        Ok(group)
    }
}
