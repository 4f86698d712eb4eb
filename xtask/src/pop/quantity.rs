//! What tables 5.3 and 5.5 and graphs 5.2 to 5.7 tell of frames.

use super::measured::Frames;
use super::tables::{count, number};
use super::thesis::Drawn;

/// A number about frames, ours and the thesis's.
pub(super) struct Quantity {
    pub(super) name: &'static str,
    pub(super) ours: fn(&Frames) -> Option<f64>,
    pub(super) theirs: fn(&Drawn) -> f64,
    /// As a cell of a table.
    pub(super) written: fn(Option<f64>) -> String,
}

pub(super) const QUANTITIES: [Quantity; 3] = [
    Quantity {
        name: "frames a second",
        ours: Frames::fps,
        theirs: |drawn| drawn.fps,
        written: number,
    },
    Quantity {
        name: "triangles",
        ours: |frames| frames.reported("triangles_drawn"),
        theirs: |drawn| drawn.triangles.into(),
        written: count,
    },
    Quantity {
        name: "points",
        ours: |frames| frames.reported("splats_drawn"),
        theirs: |drawn| drawn.points.into(),
        written: count,
    },
];
