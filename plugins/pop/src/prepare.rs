//! From a scene to trees on the device.

use crate::Pop;
use crate::part::{DeviceMesh, Origin, Part, mesh_of};
use crate::passes::Passes;
use crate::split::pieces;
use crate::tree_cache;
use pointstage_plugin_api::prelude::*;
use pointstage_plugin_api::{ChangeKind, Object};
use pointstage_pop_tree::{BuildError, Mesh, Node, Surface, Tree, VertexBlock, build, node_count};
use std::sync::Arc;
use std::time::Instant;

/// Triangles of a piece, at most: their nodes take up to 75 MB, their vertices, three a triangle at worst, 100 MB. Every device binds as
/// much at once.
const MOST_IN_A_PIECE: usize = 2 << 20;

/// A tree for each mesh of the scene: the one of before where nothing of the mesh has changed, else one from the cache, else
/// a new one.
pub(crate) fn prepare(
    host: &Host,
    scene: Scene<'_>,
    previous: Option<(&Pop, Changes<'_>)>,
    settings: Settings<'_>,
    progress: &Progress<'_>,
) -> Result<Pop> {
    let is_new_device = previous
        .as_ref()
        .is_some_and(|(_, changes)| changes.any(ChangeKind::DEVICE));
    let previous = previous.map(|(pop, _)| pop);
    let passes = match previous {
        Some(pop) if !is_new_device => Arc::clone(&pop.passes),
        _ => Arc::new(Passes::new(host.gpu()?)?),
    };
    let keeps_files = settings.bool("cache")?;
    let mut parts = Vec::new();
    for object in scene.objects() {
        let origin = Origin::of(object);
        let before = previous.iter().flat_map(|pop| &pop.parts);
        let same: Vec<_> = before.filter(|part| part.origin == origin).collect();
        let [first, ..] = same[..] else {
            parts.extend(new_parts(host, &passes, object, keeps_files, progress)?);
            continue;
        };
        if !is_new_device {
            parts.extend(same.into_iter().cloned());
        } else if first.owns_vertices {
            parts.extend(new_parts(host, &passes, object, keeps_files, progress)?);
        } else {
            let mesh = DeviceMesh::shared(object)?;
            let tree = (Arc::clone(&first.tree), first.surface);
            parts.push(Arc::new(Part::new(
                &passes,
                origin,
                mesh,
                tree,
                first.build_time,
            )?));
        }
    }
    Ok(Pop { passes, parts })
}

/// Trees and buffers of an object: one part, or more if a buffer of the device does not hold all of it; none if it is no
/// mesh.
fn new_parts(
    host: &Host,
    passes: &Passes,
    object: Object<'_>,
    keeps_files: bool,
    progress: &Progress<'_>,
) -> Result<Vec<Arc<Part>>> {
    let mut store = Vec::new();
    let Some(mesh) = mesh_of(object, &mut store) else {
        return Ok(Vec::new());
    };
    let tree_of = |mesh: &Mesh<'_>, share: [f32; 2]| {
        let make = || new_tree(host, object.name(), mesh, (progress, share));
        if keeps_files {
            tree_cache::tree_of(host, object.name(), mesh, make)
        } else {
            make()
        }
    };
    let goes_on = || !progress.is_cancelled();
    let surface = Surface::of(&mesh, &goes_on).ok_or_else(Error::cancelled)?;
    let part = |mesh, tree, start: Instant| {
        let tree = (Arc::new(tree), surface);
        Part::new(passes, Origin::of(object), mesh, tree, start.elapsed()).map(Arc::new)
    };
    if object.blocks().len() == 1 && fits(&passes.gpu, mesh.triangles.len()) {
        let start = Instant::now();
        let tree = tree_of(&mesh, [0.0, 1.0])?;
        return Ok(vec![part(DeviceMesh::shared(object)?, tree, start)?]);
    }
    progress.set(0.0, "splitting");
    let mut parts = Vec::new();
    let pieces = pieces(&mesh, MOST_IN_A_PIECE, &|| progress.check())?;
    let a_piece = 1.0 / pieces.len().max(1) as f32;
    for (number, piece) in pieces.into_iter().enumerate() {
        let start = Instant::now();
        let some = |column| (!<[u32]>::is_empty(column)).then_some(column);
        let block = VertexBlock {
            position_radius: &piece.positions,
            normals: some(&piece.normals),
            colours: some(&piece.colours),
        };
        let mesh = Mesh {
            block_size: u32::MAX,
            blocks: &[block],
            triangles: &piece.triangles,
        };
        let tree = tree_of(&mesh, [number as f32 * a_piece, a_piece])?;
        parts.push(part(
            DeviceMesh::uploaded(&passes.gpu, &piece)?,
            tree,
            start,
        )?);
    }
    Ok(parts)
}

/// Whether the nodes and the triangles of a mesh each fit a storage buffer of the device.
fn fits(gpu: &Gpu, triangle_count: usize) -> bool {
    let limit = gpu
        .limit("max_storage_buffer_binding_size")
        .unwrap_or(128 << 20);
    let bytes = [
        node_count(triangle_count) * size_of::<Node>(),
        triangle_count * size_of::<[u32; 3]>(),
    ];
    bytes.into_iter().all(|bytes| bytes as u64 <= limit)
}

/// A new tree.
///
/// * `start`, `share`: where its part of the whole progress begins, and how much of it that is.
fn new_tree(
    host: &Host,
    name: &str,
    mesh: &Mesh<'_>,
    (progress, [start, share]): (&Progress<'_>, [f32; 2]),
) -> Result<Tree> {
    let mut report = |fraction: f32, stage: &str| {
        progress.set(start + share * fraction, stage);
        !progress.is_cancelled()
    };
    build(mesh, host.thread_count(), &mut report).map_err(|error| match error {
        BuildError::Cancelled => Error::cancelled(),
        other => Error::failed(format!("no tree of '{name}': {other}")),
    })
}
