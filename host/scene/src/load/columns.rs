//! Columns of formats that are read surfel by surfel.

use pointstage_plugin_api::columns::MAX_BLOCK_SURFELS;

use crate::geometry::Block;

/// Columns in the making; a column without values is one that the file lacks.
#[derive(Debug, Default)]
pub(super) struct Columns {
    /// Centres, relative to the object's origin, and radii.
    pub(super) position_radius: Vec<[f32; 4]>,
    /// Packed.
    pub(super) normal: Vec<u32>,
    /// Packed.
    pub(super) colour: Vec<u32>,
}

impl Columns {
    /// Cuts the columns into blocks.
    pub(super) fn into_blocks(self) -> Vec<Block> {
        let column = |values: &[u32], block: usize| {
            let values = values.chunks(MAX_BLOCK_SURFELS).nth(block);
            values.map(Into::into)
        };
        let blocks = self.position_radius.chunks(MAX_BLOCK_SURFELS).enumerate();
        blocks
            .map(|(block, position_radius)| Block {
                position_radius: position_radius.into(),
                normal: column(&self.normal, block),
                colour: column(&self.colour, block),
                ..Block::default()
            })
            .collect()
    }
}
