//! One mesh with its tree, on the device.

use crate::passes::Passes;
use pointstage_plugin_api::abi::{self, BufferUsage, Handle};
use pointstage_plugin_api::gpu::{AsHandle as _, BindGroup, Buffer};
use pointstage_plugin_api::{Column, Error, Object, Result, columns};
use pointstage_pop_tree::{Mesh, Surface, Tree, VertexBlock};
use std::sync::Arc;
use std::time::Duration;

/// What a part was made of: as long as this stays, so does the part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Origin {
    object: u64,
    /// Revisions of the columns that the tree depends on.
    revisions: Vec<u64>,
}

/// One mesh with its tree, on the device.
pub(crate) struct Part {
    pub(crate) origin: Origin,
    pub(crate) tree: Arc<Tree>,
    pub(crate) surface: Surface,
    pub(crate) triangle_count: u32,
    pub(crate) vertex_count: u32,
    /// How long the tree took; zero if it was read from a file.
    pub(crate) build_time: Duration,
    _nodes: Buffer,
    /// Group 1.
    pub(crate) group: BindGroup,
}

impl Origin {
    /// Of an object.
    pub(crate) fn of(object: Object<'_>) -> Self {
        let triangles = object
            .column(columns::TRIANGLES)
            .map(|column| column.revision());
        let blocks = object.blocks().flat_map(|block| {
            block
                .columns()
                .map(|column| column.revision())
                .collect::<Vec<_>>()
        });
        Self {
            object: object.id(),
            revisions: triangles.into_iter().chain(blocks).collect(),
        }
    }

    /// Whether the part belongs to an object.
    pub(crate) fn is_of(&self, object: Object<'_>) -> bool {
        self.object == object.id()
    }
}

/// The object's mesh; none if it has no triangles.
pub(crate) fn mesh_of<'a>(
    object: Object<'a>,
    store: &'a mut Vec<VertexBlock<'a>>,
) -> Option<Mesh<'a>> {
    let triangles = object.triangles()?;
    store.extend(object.blocks().map(|block| VertexBlock {
        position_radius: block.position_radius(),
        normals: block.normals(),
        colours: block.colours(),
    }));
    Some(Mesh {
        block_size: columns::MAX_BLOCK_SURFELS as u32,
        blocks: store,
        triangles,
    })
}

impl Part {
    /// Uploads a tree.
    ///
    /// # Errors
    /// If the device refuses a resource, or the mesh does not fit.
    pub(crate) fn new(
        passes: &Passes,
        object: Object<'_>,
        tree: Arc<Tree>,
        surface: Surface,
        build_time: Duration,
    ) -> Result<Self> {
        let gpu = &passes.gpu;
        let name = object.name();
        let mut blocks = object.blocks();
        let (Some(block), None) = (blocks.next(), blocks.next()) else {
            return Err(Error::failed(format!(
                "the mesh of '{name}' has {} vertices; pop draws meshes of up to {} yet: draw it with another renderer, or reduce it",
                object.surfel_count(),
                columns::MAX_BLOCK_SURFELS
            )));
        };
        let missing = |what: &str| Error::failed(format!("the device has no {what} of '{name}'"));
        let buffer = |column: Option<Column<'_>>, what| {
            let buffer = column.and_then(|column| column.buffer());
            buffer
                .map(|buffer| buffer.as_handle())
                .ok_or_else(|| missing(what))
        };
        let positions = buffer(block.column(columns::POSITION_RADIUS), "positions")?;
        let optional = |name| {
            let buffer = block.column(name).and_then(|column| column.buffer());
            // Something must be bound; the draw's flags say that it is not to be read.
            buffer.map_or(positions, |buffer| buffer.as_handle())
        };
        let usage = BufferUsage::STORAGE;
        let nodes = if tree.nodes.is_empty() {
            gpu.buffer_with("nodes", usage, &[0_u32; 5])?
        } else {
            gpu.buffer_with("nodes", usage, &tree.nodes)?
        };
        let resources: [Handle; 5] = [
            nodes.as_handle(),
            buffer(object.column(columns::TRIANGLES), "triangles")?,
            positions,
            optional(columns::NORMAL),
            optional(columns::COLOUR),
        ];
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| abi::BindingRecord {
                binding,
                resource,
                ..Default::default()
            })
            .collect();
        let group = gpu.bind_group_from(&abi::BindGroupDescriptor {
            label: "tree and mesh".into(),
            layout: passes.tree_layout.handle(),
            entries: entries.as_slice().into(),
        })?;
        Ok(Self {
            origin: Origin::of(object),
            triangle_count: object.triangles().map_or(0, <[_]>::len) as u32,
            vertex_count: block.surfel_count(),
            tree,
            surface,
            build_time,
            _nodes: nodes,
            group,
        })
    }
}
