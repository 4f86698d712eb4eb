//! The selection, as the passes walk it: draws for visibility, blocks for shading.

use crate::clips::{ClipPlace, Clips};
use crate::rectangle::{PixelRectangle, rectangle_of};
use pointstage_plugin_api::gpu::GroupRef;
use pointstage_plugin_api::{DrawFlags, Frame};

/// One draw of the selection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawItem {
    /// Of its uniform, for group 0.
    pub uniform_offset: u32,
    /// Group 1.
    pub columns: GroupRef,
    /// Surfels, at most.
    pub count: u32,
    /// First id of its block.
    pub id_base: u32,
    /// Where its clip lines are, if it has any.
    pub clip: Option<ClipPlace>,
}

/// Surfels that lie together and have their own range of ids; several draws may share them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockItem {
    /// Of a draw of the block: object, material and flags are the same for all of them.
    pub uniform_offset: u32,
    /// Of that draw, with the columns that all of the block's draws share.
    pub columns: GroupRef,
    /// First id.
    pub id_base: u32,
    /// Surfels of the block.
    pub id_count: u32,
    /// Where its splats can be.
    pub pixels: PixelRectangle,
    level: f32,
}

/// What a frame draws.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrawList {
    /// By rising id, so that of two surfels at one depth both paths keep the same.
    pub draws: Vec<DrawItem>,
    /// In the order of their first draws.
    pub blocks: Vec<BlockItem>,
    /// Whether draws of one block have different levels: then only the raster path can tell a pixel's level.
    pub mixes_levels: bool,
    /// Whether no draw is indexed or indirect.
    pub is_direct: bool,
    /// Surfels selected, at most.
    pub surfel_count: u64,
}

impl DrawList {
    /// * `reach_px`: how far splats reach from their projected centres, if it is known; px.
    /// * `clips`: of the scene.
    pub fn of(frame: &Frame<'_>, reach_px: Option<f32>, clips: &Clips) -> Self {
        let mut list = Self {
            is_direct: true,
            ..Self::default()
        };
        for draw in frame.selection().filter(|draw| draw.count() > 0) {
            let uniform = draw.uniform();
            let indirections = DrawFlags::INDEXED | DrawFlags::INDIRECT;
            list.is_direct &= !draw.flags().intersects(indirections);
            list.surfel_count += u64::from(draw.count());
            list.draws.push(DrawItem {
                uniform_offset: draw.uniform_offset(),
                columns: draw.columns(),
                count: draw.count(),
                id_base: uniform.id_base,
                clip: clips.place_of(draw.block()),
            });
            match list
                .blocks
                .iter()
                .find(|block| block.id_base == uniform.id_base)
            {
                Some(block) => list.mixes_levels |= block.level != uniform.level,
                None => list.blocks.push(BlockItem {
                    uniform_offset: draw.uniform_offset(),
                    columns: draw.columns(),
                    id_base: uniform.id_base,
                    id_count: draw.block().surfel_count(),
                    pixels: rectangle_of(frame, &draw, reach_px),
                    level: uniform.level,
                }),
            }
        }
        list.draws.sort_by_key(|draw| draw.id_base);
        list
    }

    /// Whether any draw has clip lines.
    pub fn has_clips(&self) -> bool {
        self.draws.iter().any(|draw| draw.clip.is_some())
    }

    /// Leaves to the blocks only what lies within some pixels.
    pub fn narrow(&mut self, pixels: PixelRectangle) {
        for block in &mut self.blocks {
            block.pixels = block.pixels.common(pixels);
        }
    }
}
