//! What can be estimated, by name.

use clap::ValueEnum;
use pointstage_scene::{Origins, Provenance};

/// A column to estimate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Estimate {
    /// Across the faces or the plane through the neighbours; lit from both sides unless oriented
    Normals,
    /// Of disks that leave no holes
    Radii,
    /// Half-axes of ellipses that leave no holes
    Axes,
}

/// Names of what surfels lack to be drawn as disks.
pub(super) fn missing(origins: Origins) -> Vec<&'static str> {
    [("normals", origins.normals), ("radii", origins.radii)]
        .into_iter()
        .filter(|(_, provenance)| *provenance == Provenance::Missing)
        .map(|(name, _)| name)
        .collect()
}
