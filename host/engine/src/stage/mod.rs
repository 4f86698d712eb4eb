//! One frame from end to end: a [`FrameRequest`] goes in, a [`FrameResult`] with the composed picture comes out.
//!
//! A [`Stage`] holds what outlives frames: the device and the scene's columns on it, the plugins found, what they
//! prepared, and each viewport's views and targets. [`Stage::frame`] then
//!
//! 1. finds the renderer and prepares it if the scene, a costly setting or the device is new (`prepare`: on a worker;
//!    the last good renderer draws meanwhile, or the built-in fallback),
//! 2. uploads what is new of the scene (`upload`) and makes the selection, of all surfels or by a structure (`selection`),
//! 3. calls the view with the frame's record (`draw`), replays its commands or takes its planes,
//! 4. composes and reads back.
//!
//! Whatever a plugin does wrong ends as a [`Notice`], and the next candidate draws. When the device is lost, the next
//! frame opens a new one and prepares again. [`StageThread`] does all this on a thread of its own, for windows.

mod choose;
mod draw;
mod first_use;
mod ids;
mod instances;
mod manage;
mod options;
mod prepare;
mod records;
mod recover;
mod request;
mod selection;
mod session;
mod thread;
mod tile;
mod try_out;
mod uniforms;
mod upload;
mod viewport;

pub use ids::{IdSource, IdTable, Identified};
pub use options::{FrameError, StageError, StageOptions};
pub(crate) use prepare::setting_records;
pub use request::*;
pub use selection::SelectionError;
pub use session::{Adapter, FALLBACK_ID, Stage};
pub use thread::{PluginHoldings, RegistryHandle, StageStatus, StageThread};
pub use tile::{LARGEST_IMAGE_PX, Tile};
pub use try_out::{TryOut, try_out};
