//! What readers make of files: made up here, of the shared test data folder, and written by the writers.
//!
//! One program for all of them: each program more costs every build its linking.

#[path = "../support/data.rs"]
mod data;
mod data_facts;
mod data_files;
mod encodings;
mod made_up_files;
mod oriented_scans;
mod qs_facts;
mod round_trips;
mod round_trips_of_any;
#[path = "../support/sfl.rs"]
mod sfl;
mod sfl_facts;
mod sfl_made_up;
#[path = "../support/mod.rs"]
mod support;
mod text_files;
#[path = "../support/texts.rs"]
mod texts;
mod tri_files;
