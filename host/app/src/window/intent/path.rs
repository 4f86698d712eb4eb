//! Intents about the camera path.

use std::path::PathBuf;

use pointstage_scene::{Easing, ViewRecord};

use super::Replace;
use crate::camera_path::Turntable;
use crate::window::views::ListWay;

/// What to do with the camera path. Places in lists count from 0.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum PathIntent {
    /// Put the present view behind the last one.
    Append,
    /// Put a stored view, with its name, behind the last one.
    AppendStored(String, ViewRecord),
    /// Put the present view at the shown time.
    SetHere,
    /// Put the present view in the place of this one.
    Overwrite(usize),
    /// Show the time of this view.
    GoTo(usize),
    /// Reach this view at this time, seconds.
    SetTime(usize, f64),
    /// Go on from this view like this.
    SetEasing(usize, Easing),
    /// Let this view and its neighbour change places; their times stay.
    Shift(usize, ListWay),
    /// Take this view out.
    Delete(usize),
    /// Turn around the scene like this, or not at all.
    Turntable(Option<Turntable>),
    /// Let it take so long, seconds; as long as its parts if none is given.
    Duration(Option<f64>),
    /// So many pictures a second in a film of it.
    Rate(f64),
    /// Begin again at the end.
    Loop(bool),
    /// Give a setting its present value at the shown time.
    SetValue {
        /// The renderer's or structure's id.
        owner: String,
        /// The setting's id.
        setting: String,
    },
    /// Reach a value of a track at this time, seconds.
    SetValueTime(usize, usize, f64),
    /// Take a value out of a track, and the track with its last one.
    DeleteValue(usize, usize),
    /// Take a track out.
    DeleteTrack(usize),
    /// Take everything out.
    Clear,
    /// Play it, or stop where it is.
    TogglePlay,
    /// Show this time, seconds.
    Scrub(f64),
    /// Show the dialog that renders its pictures.
    ShowDialog,
    /// Render its pictures.
    Render(FilmFiles),
}

/// The pictures of a film, as the dialog describes them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FilmFiles {
    /// Where they go: `%04d` stands for their number.
    pub(crate) path: PathBuf,
    /// px.
    pub(crate) size_px: [u32; 2],
    /// Pictures a second.
    pub(crate) fps: f64,
    /// Whether files that are there may go.
    pub(crate) replace: Replace,
}
