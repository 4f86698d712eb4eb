//! A triangle mesh, borrowed from wherever it lies.

use pointstage_plugin_api::columns;
use pointstage_plugin_api::glam::Vec3;

/// Vertices that lie together.
#[derive(Clone, Copy, Debug)]
pub struct VertexBlock<'a> {
    /// Position (xyz); object space. The fourth is not read.
    pub position_radius: &'a [[f32; 4]],
    /// Octahedral normals, see [`columns::decode_normal`]; as many as positions.
    pub normals: Option<&'a [u32]>,
    /// Packed sRGB colours, see [`columns::decode_colour`]; as many as positions.
    pub colours: Option<&'a [u32]>,
}

/// A triangle mesh: blocks of vertices, all but the last of `block_size`, and triangles over their numbers.
#[derive(Clone, Copy, Debug)]
pub struct Mesh<'a> {
    /// Vertices of each block but the last; not 0.
    pub block_size: u32,
    /// The vertices.
    pub blocks: &'a [VertexBlock<'a>],
    /// Three vertices a triangle.
    pub triangles: &'a [[u32; 3]],
}

impl<'a> Mesh<'a> {
    /// Vertices of all blocks.
    pub fn vertex_count(&self) -> usize {
        self.blocks
            .iter()
            .map(|block| block.position_radius.len())
            .sum()
    }

    /// Position of a vertex; none if there is no such vertex.
    #[inline]
    pub fn position(&self, vertex: u32) -> Option<Vec3> {
        let (block, place) = self.find(vertex)?;
        let [x, y, z, _] = *block.position_radius.get(place)?;
        Some(Vec3::new(x, y, z))
    }

    /// Packed normal of a vertex, perhaps [`columns::NO_NORMAL`]; none if the mesh has none.
    #[inline]
    pub fn packed_normal(&self, vertex: u32) -> Option<u32> {
        let (block, place) = self.find(vertex)?;
        block.normals?.get(place).copied()
    }

    /// Packed colour of a vertex; none if the mesh has none.
    #[inline]
    pub fn packed_colour(&self, vertex: u32) -> Option<u32> {
        let (block, place) = self.find(vertex)?;
        block.colours?.get(place).copied()
    }

    /// Unit normal of a vertex; none if it is not known.
    #[inline]
    pub fn normal(&self, vertex: u32) -> Option<Vec3> {
        let bits = self.packed_normal(vertex)?;
        (bits != columns::NO_NORMAL).then(|| columns::decode_normal(bits))
    }

    fn find(&self, vertex: u32) -> Option<(&VertexBlock<'a>, usize)> {
        match self.blocks {
            [block] => Some((block, vertex as usize)),
            blocks => {
                let block = blocks.get((vertex / self.block_size) as usize)?;
                Some((block, (vertex % self.block_size) as usize))
            }
        }
    }
}
