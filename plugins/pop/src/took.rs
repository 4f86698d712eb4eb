//! What a frame took, and the report of it.

use crate::Pop;
use pointstage_plugin_api::{Frame, statistics};
use std::time::Duration;

/// What a frame took, for the report.
#[derive(Default)]
pub(crate) struct Took {
    pub(crate) splats: u64,
    pub(crate) triangles: u64,
    pub(crate) evaluated: u64,
    pub(crate) culled: u64,
    pub(crate) selection: Duration,
}

/// Reports what a frame took.
pub(crate) fn report(frame: &mut Frame<'_>, prepared: &Pop, took: &Took) {
    let milliseconds = |time: Duration| 1e3 * time.as_secs_f64();
    let nodes: usize = prepared
        .parts
        .iter()
        .map(|part| part.tree.nodes.len())
        .sum();
    let build: Duration = prepared.parts.iter().map(|part| part.build_time).sum();
    frame.report(statistics::SPLATS_DRAWN, took.splats as f64);
    frame.report(statistics::TRIANGLES_DRAWN, took.triangles as f64);
    frame.report(statistics::NODES_VISITED, took.evaluated as f64);
    frame.report("front_length", (took.splats + took.triangles) as f64);
    frame.report("nodes_culled", took.culled as f64);
    frame.report("selection_ms", milliseconds(took.selection));
    frame.report("tree_nodes", nodes as f64);
    let levels = prepared
        .parts
        .iter()
        .map(|part| part.tree.level_starts.len())
        .max();
    frame.report("tree_levels", levels.unwrap_or_default() as f64);
    frame.report("tree_ms", milliseconds(build));
}
