//! From a scene to trees on the device.

use crate::Pop;
use crate::part::{Origin, Part, mesh_of};
use crate::passes::Passes;
use crate::tree_cache;
use pointstage_plugin_api::prelude::*;
use pointstage_plugin_api::{ChangeKind, Object};
use pointstage_pop_tree::{BuildError, Mesh, Surface, Tree, build};
use std::sync::Arc;
use std::time::Instant;

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
        let same = previous.and_then(|pop| pop.parts.iter().find(|part| part.origin == origin));
        let part = match same {
            Some(part) if !is_new_device => Arc::clone(part),
            Some(part) => Arc::new(Part::new(
                &passes,
                object,
                Arc::clone(&part.tree),
                part.surface,
                part.build_time,
            )?),
            None => match new_part(host, &passes, object, keeps_files, progress)? {
                Some(part) => Arc::new(part),
                None => continue,
            },
        };
        parts.push(part);
    }
    Ok(Pop { passes, parts })
}

/// Tree and buffers of an object; none if it is no mesh.
fn new_part(
    host: &Host,
    passes: &Passes,
    object: Object<'_>,
    keeps_files: bool,
    progress: &Progress<'_>,
) -> Result<Option<Part>> {
    let mut store = Vec::new();
    let Some(mesh) = mesh_of(object, &mut store) else {
        return Ok(None);
    };
    let start = Instant::now();
    let make = || tree_of(host, object.name(), &mesh, progress);
    let tree = if keeps_files {
        tree_cache::tree_of(host, object.name(), &mesh, make)?
    } else {
        make()?
    };
    let build_time = start.elapsed();
    Part::new(
        passes,
        object,
        Arc::new(tree),
        Surface::of(&mesh),
        build_time,
    )
    .map(Some)
}

/// A new tree.
fn tree_of(host: &Host, name: &str, mesh: &Mesh<'_>, progress: &Progress<'_>) -> Result<Tree> {
    let mut report = |fraction, stage: &str| {
        progress.set(fraction, stage);
        !progress.is_cancelled()
    };
    build(mesh, host.thread_count(), &mut report).map_err(|error| match error {
        BuildError::Cancelled => Error::cancelled(),
        other => Error::failed(format!("no tree of '{name}': {other}")),
    })
}
