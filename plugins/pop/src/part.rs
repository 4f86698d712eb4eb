//! One mesh, or a piece of one, with its tree, on the device.

use crate::passes::Passes;
use crate::split::Piece;
use pointstage_plugin_api::abi::{self, BufferUsage, Handle};
use pointstage_plugin_api::gpu::{AsHandle as _, BindGroup, Buffer, Gpu};
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

/// One mesh, or a piece of one, with its tree, on the device.
pub(crate) struct Part {
    pub(crate) origin: Origin,
    pub(crate) tree: Arc<Tree>,
    /// Of the whole mesh.
    pub(crate) surface: Surface,
    pub(crate) triangle_count: u32,
    pub(crate) vertex_count: u32,
    /// Whether the vertices are copies of the scene's: a piece's.
    pub(crate) owns_vertices: bool,
    /// How long the tree took, or reading it from its file.
    pub(crate) build_time: Duration,
    /// Nodes, and what else is the part's own.
    _buffers: Vec<Buffer>,
    /// Group 1.
    pub(crate) group: BindGroup,
}

/// A mesh on the device: triangles, positions, normals, colours.
pub(crate) struct DeviceMesh {
    resources: [Handle; 4],
    triangle_count: u32,
    vertex_count: u32,
    /// The buffers that are the mesh's own; none if they are the scene's.
    own: Vec<Buffer>,
}

impl DeviceMesh {
    /// The scene's own buffers of an object with one block.
    ///
    /// # Errors
    /// If one is missing.
    pub(crate) fn shared(object: Object<'_>) -> Result<Self> {
        let name = object.name();
        let missing = |what: &str| Error::failed(format!("the device has no {what} of '{name}'"));
        let block = object.blocks().next().ok_or_else(|| missing("vertices"))?;
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
        Ok(Self {
            resources: [
                buffer(object.column(columns::TRIANGLES), "triangles")?,
                positions,
                optional(columns::NORMAL),
                optional(columns::COLOUR),
            ],
            triangle_count: object.triangles().map_or(0, <[_]>::len) as u32,
            vertex_count: block.surfel_count(),
            own: Vec::new(),
        })
    }

    /// Buffers of a piece's own.
    ///
    /// # Errors
    /// If the device refuses one.
    pub(crate) fn uploaded(gpu: &Gpu, piece: &Piece) -> Result<Self> {
        let usage = BufferUsage::STORAGE;
        let triangles = gpu.buffer_with("triangles", usage, &piece.triangles)?;
        let positions = gpu.buffer_with("positions", usage, &piece.positions)?;
        let optional = |label, column: &[u32]| match column {
            [] => Ok(None),
            column => gpu.buffer_with(label, usage, column).map(Some),
        };
        let normals = optional("normals", &piece.normals)?;
        let colours = optional("colours", &piece.colours)?;
        let or_positions =
            |buffer: &Option<Buffer>| buffer.as_ref().unwrap_or(&positions).as_handle();
        Ok(Self {
            resources: [
                triangles.as_handle(),
                positions.as_handle(),
                or_positions(&normals),
                or_positions(&colours),
            ],
            triangle_count: piece.triangles.len() as u32,
            vertex_count: piece.positions.len() as u32,
            own: [Some(triangles), Some(positions), normals, colours]
                .into_iter()
                .flatten()
                .collect(),
        })
    }
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
    /// If the device refuses a resource.
    pub(crate) fn new(
        passes: &Passes,
        origin: Origin,
        mesh: DeviceMesh,
        (tree, surface): (Arc<Tree>, Surface),
        build_time: Duration,
    ) -> Result<Self> {
        let gpu = &passes.gpu;
        let usage = BufferUsage::STORAGE;
        let nodes = if tree.nodes.is_empty() {
            gpu.buffer_with("nodes", usage, &[0_u32; 5])?
        } else {
            gpu.buffer_with("nodes", usage, &tree.nodes)?
        };
        let resources = [nodes.as_handle()].into_iter().chain(mesh.resources);
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
            origin,
            triangle_count: mesh.triangle_count,
            vertex_count: mesh.vertex_count,
            owns_vertices: !mesh.own.is_empty(),
            tree,
            surface,
            build_time,
            _buffers: mesh.own.into_iter().chain([nodes]).collect(),
            group,
        })
    }
}
