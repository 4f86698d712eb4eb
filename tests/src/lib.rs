//! The test harness of Pointstage: what the tests under `tests/tests/` share.
//!
//! * [`program`] finds the built program and its plugins and runs the command line with a time limit.
//! * [`scenes`] makes small scenes as PLY files; [`data`] finds the shared test data folder, or says that it skips.
//! * [`render`] draws such scenes with one fixed view; [`stages`] is the engine without the program around it.
//! * [`models`] makes scenes in memory; [`shots`] draws them with `points` and `surfel`, target by target.
//! * [`compare`] measures how far two pictures are apart; [`golden`] holds a picture against the one that was blessed.
//! * [`sharp`] makes shapes with sharp edges.
//! * [`loaders`] loads files through the first-party libraries of loaders; [`mesh_files`] writes files of every format.
//! * [`browser`] opens a page in a browser without a window.
//! * [`plugins`] builds the misbehaving plugins of `tests/plugins/`.
//! * [`window`] drives the program's window on a virtual display: pointer, keys, drops, screenshots.
//!
//! A test that cannot run on this machine prints one line that begins with `skipped: ` and returns; `cargo xtask test`
//! counts those lines.

pub mod browser;
pub mod compare;
pub mod data;
pub mod golden;
pub mod loaders;
pub mod mesh_files;
pub mod models;
pub mod plugins;
pub mod program;
pub mod render;
pub mod scenes;
pub mod sharp;
pub mod shots;
pub mod stages;
pub mod window;
