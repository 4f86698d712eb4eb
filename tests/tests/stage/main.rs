//! The engine without the program around it: frames of the first-party renderers, structures, several viewports, and plugins that
//! come and go.
//!
//! One program for all of them: each program more costs every build its linking.

mod agreement;
mod blending;
mod manage;
mod near_plane;
mod radius_scale;
mod raycast;
mod selections;
mod sharp_edges;
mod structure;
mod tiles;
mod viewports;
