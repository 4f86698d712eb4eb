//! The window.
//!
//! Data goes round once a pass: [`app`] collects what workers finished, lets the UI functions read the [`session`] and
//! return [`intent`]s, applies those to the session ([`apply`]), and asks the stage for a picture if something that the
//! picture depends on has changed. UI functions never load, render or block: files are read by a worker ([`tasks`]),
//! pictures are drawn by the stage's own thread, and the last one is shown until the next is there.

mod actions;
mod app;
#[cfg(test)]
mod app_export_tests;
#[cfg(test)]
mod app_path_tests;
#[cfg(test)]
mod app_tests;
mod apply;
mod asking;
mod bug_report;
#[cfg(test)]
mod camera_tests;
mod canvas;
mod choices;
mod comparison;
mod dialogs;
mod errands;
mod facts;
mod flight;
mod folder_dialog;
mod frame_times;
mod gizmo;
mod help;
mod history;
mod host_times;
mod inspector;
mod intent;
mod layout;
mod legend;
mod light_presets;
mod loading;
mod log;
mod memory;
mod menu;
mod navigation;
mod object_choices;
mod open;
mod pacing;
mod palette;
mod path;
mod picture;
mod presets;
mod progress;
mod recommend;
mod remembered;
#[cfg(test)]
mod remembered_tests;
mod roles;
mod rows;
mod save_image;
mod screen;
mod selecting;
mod session;
mod session_link;
#[cfg(test)]
mod session_objects_tests;
mod settings;
mod several;
mod stage_link;
mod status;
mod tasks;
#[cfg(test)]
mod test_frames;
#[cfg(test)]
mod test_schema;
mod theme;
mod thumbnail;
mod toasts;
mod ui_state;
mod viewport;
mod views;
mod views_panels;
mod views_ui;
mod welcome;

pub(crate) use navigation::{FLY_SPEEDS, NavigationOptions};
pub(crate) use open::open;
