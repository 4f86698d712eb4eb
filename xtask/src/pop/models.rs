//! What is measured: the thesis's models as far as they can be had, one of ours, and squares of many sizes.

use std::path::PathBuf;

use super::surface::Surface;
use crate::out::OutFolder;
use crate::{Outcome, paths, process};

/// What is drawn.
#[derive(Debug)]
pub(super) struct Model {
    pub(super) name: &'static str,
    source: Source,
    /// Its faces are wound inward.
    pub(super) flip: bool,
}

/// Where a model comes from.
#[derive(Debug)]
enum Source {
    /// A file of the shared test data folder.
    Shared(&'static str),
    /// Made on the spot.
    Surface(Surface),
}

/// In the thesis's order, which has a hand in second place and no brain.
pub(super) const MODELS: [Model; 5] = [
    Model {
        name: "horse",
        source: Source::Shared("mesh/horse_rgb_be.ply"),
        flip: false,
    },
    Model {
        name: "dragon",
        source: Source::Shared("mesh/dragon_vrip_437k_le.ply"),
        flip: false,
    },
    Model {
        name: "sphere",
        source: Source::Surface(Surface::SPHERE),
        flip: false,
    },
    Model {
        name: "torus",
        source: Source::Surface(Surface::TORUS),
        flip: false,
    },
    BRAIN,
];

/// The one on which our goals are set.
pub(super) const BRAIN: Model = Model {
    name: "brain",
    source: Source::Shared("mesh/brain_ch2better_1092k_le.ply"),
    flip: true,
};

/// Triangles of each square: the thesis's ten, and two beyond.
pub(super) const SQUARES: [usize; 12] = [
    100_000, 200_000, 300_000, 400_000, 500_000, 600_000, 700_000, 800_000, 900_000, 1_000_000,
    2_000_000, 4_000_000,
];

impl Model {
    /// Its file, made in `folder` if it is a made one; `None`, with a word, where it is not here.
    pub(super) fn file(&self, folder: &OutFolder) -> Outcome<Option<PathBuf>> {
        match self.source {
            Source::Surface(surface) => made(folder, self.name, surface).map(Some),
            Source::Shared(path) => Ok(paths::shared_data_or_say(path)),
        }
    }
}

/// The file of a surface, written unless it is there.
pub(super) fn made(folder: &OutFolder, name: &str, surface: Surface) -> Outcome<PathBuf> {
    let file = format!("{name}.ply");
    let path = folder.path().join(&file);
    // One that was broken off is shorter.
    let whole = std::fs::metadata(&path)
        .is_ok_and(|metadata| metadata.len() == surface.byte_count() as u64);
    if whole {
        return Ok(path);
    }
    process::say(&format!(
        "making {file}: {} triangles",
        surface.triangle_count()
    ));
    folder.write(&file, surface.ply())
}
