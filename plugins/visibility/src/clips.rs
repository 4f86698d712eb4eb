//! Surfels that end at sharp edges: the scene's clip lines, on the CPU and on the device.
//!
//! Only blocks with clip columns have any. Their draws have pipelines and groups of their own (the feature `clipped` of shaders),
//! so that the rest costs what it would without them.

use crate::draws::{DrawItem, DrawList};
use crate::pipelines::Prepared;
use pointstage_plugin_api::abi::BufferUsage;
use pointstage_plugin_api::clip::{ClipColumns, ClipLines};
use pointstage_plugin_api::gpu::{BindGroup, BindGroupLayout, Buffer, Gpu};
use pointstage_plugin_api::{Block, Result, Scene};
use std::sync::Arc;

/// The feature of shaders that clip.
pub const CLIPPED: &str = "clipped";

/// Clip lines of all blocks of a scene.
#[derive(Default)]
pub struct Clips {
    blocks: Vec<ClippedBlock>,
}

struct ClippedBlock {
    /// Of the block's centres, and the columns' revision: no other block has both.
    key: (usize, u64),
    lines: Arc<[ClipLines]>,
    buffer: Buffer,
}

/// Which of [`Clips`] a draw's block is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClipPlace(usize);

/// Something for draws without clip lines, and something else for those with.
pub struct Variants<T> {
    plain: T,
    clipped: Option<T>,
}

/// Group 2 of every draw.
pub struct FootprintGroups {
    plain: BindGroup,
    /// In the order of [`Clips`].
    clipped: Vec<BindGroup>,
}

impl Clips {
    /// Brings the scene's lines to the device.
    ///
    /// # Errors
    /// If the device refuses a buffer.
    pub(crate) fn of(gpu: &Gpu, scene: Scene<'_>) -> Result<Self> {
        let blocks = scene.objects().flat_map(|object| object.blocks());
        let blocks = blocks.map(|block| ClippedBlock::of(gpu, block));
        let blocks: Result<Vec<_>> = blocks.filter_map(Result::transpose).collect();
        Ok(Self { blocks: blocks? })
    }

    /// Where the block's lines are, if it has any.
    pub(crate) fn place_of(&self, block: Block<'_>) -> Option<ClipPlace> {
        if self.blocks.is_empty() {
            return None;
        }
        let key = key_of(block, &ClipColumns::of(block)?);
        let place = self.blocks.iter().position(|found| found.key == key)?;
        Some(ClipPlace(place))
    }

    /// The lines of a block.
    pub(crate) fn lines_of(&self, block: Block<'_>) -> Option<Arc<[ClipLines]>> {
        let ClipPlace(place) = self.place_of(block)?;
        Some(self.blocks.get(place)?.lines.clone())
    }

    /// The buffers, in order.
    pub(crate) fn buffers(&self) -> impl Iterator<Item = &Buffer> {
        self.blocks.iter().map(|block| &block.buffer)
    }
}

impl ClippedBlock {
    /// None if nothing of the block is cut off.
    fn of(gpu: &Gpu, block: Block<'_>) -> Result<Option<Self>> {
        let Some(columns) = ClipColumns::of(block) else {
            return Ok(None);
        };
        let lines: Arc<[_]> = (0..block.surfel_count())
            .map(|number| columns.lines(number))
            .collect();
        if lines.iter().all(|lines| *lines == ClipLines::NONE) {
            return Ok(None);
        }
        Ok(Some(Self {
            key: key_of(block, &columns),
            buffer: gpu.buffer_with("clip lines", BufferUsage::STORAGE, &lines)?,
            lines,
        }))
    }
}

fn key_of(block: Block<'_>, columns: &ClipColumns<'_>) -> (usize, u64) {
    let address = block.position_radius().as_ptr().addr();
    (address, columns.revision())
}

impl Prepared {
    /// The renderer with the scene's clip lines, for a footprint that knows the feature [`CLIPPED`].
    ///
    /// # Errors
    /// If the device refuses a buffer.
    pub fn clipped_by(mut self, scene: Scene<'_>) -> Result<Self> {
        self.clips = Clips::of(&self.gpu, scene)?;
        Ok(self)
    }

    /// The layout of group 2 of visibility for shaders with these features.
    pub fn footprint_layout_for(&self, features: &[&'static str]) -> &BindGroupLayout {
        if features.contains(&CLIPPED) {
            &self.clipped_layout
        } else {
            &self.footprint_layout
        }
    }
}

impl<T> Variants<T> {
    /// What `make` gives for draws without clip lines and, if the list has such, for those with.
    ///
    /// # Errors
    /// What `make` says.
    pub fn of(list: &DrawList, make: impl Fn(bool) -> Result<T>) -> Result<Self> {
        Ok(Self {
            plain: make(false)?,
            clipped: list.has_clips().then(|| make(true)).transpose()?,
        })
    }

    /// What the draw takes.
    pub fn of_draw(&self, draw: &DrawItem) -> &T {
        let clipped = draw.clip.and(self.clipped.as_ref());
        clipped.unwrap_or(&self.plain)
    }
}

impl FootprintGroups {
    pub(crate) fn new(plain: BindGroup, clipped: Vec<BindGroup>) -> Self {
        Self { plain, clipped }
    }

    /// The group without clip lines.
    pub fn plain(&self) -> &BindGroup {
        &self.plain
    }

    /// The draw's group.
    pub fn of_draw(&self, draw: &DrawItem) -> &BindGroup {
        let clipped = draw
            .clip
            .and_then(|ClipPlace(place)| self.clipped.get(place));
        clipped.unwrap_or(&self.plain)
    }
}
