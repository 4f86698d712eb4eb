//! Do files of other formats than PLY open, through loaders that are plugins, with what is in them?
//!
//! Small files are made up here; the shared test data folder has real ones, with facts that other programs found.

mod border;
mod choice;
mod commands;
mod convert;
mod damage;
mod found;
mod kept_textures;
mod long;
mod meshes;
mod points;
mod saved_textures;
mod scans;
mod shared_points;
mod small;
mod textures;
