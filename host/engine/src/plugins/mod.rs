//! Plugins: from files to factories that make renderers, structures and loaders.
//!
//! [`Registry::discover`] goes through the candidates ([`discover`]). A file is first looked at without running it:
//! whole ([`elf`]), with a good manifest ([`manifest`]) for this border. A new or changed one is then loaded in a child
//! process with a time limit ([`probe`]); the verdict is kept ([`cache`]) for as long as file and program stay the same.
//! [`Registry::load`] loads a good one into this process ([`library`], the only unsafe code of the engine) and returns
//! its [`Factory`]. What loaders there are, [`loaders`] offers to the scene. Before first use, [`Registry::try_out`] draws a frame with it in another child. The [`journal`]
//! names the plugin that is about to do something for the first time, so that the next start knows who ended the session.
//!
//! A plugin is native code: what is here contains mistakes, not malice, and nothing can stop a crash or an endless loop
//! in a frame of a plugin that passed.

pub mod cache;
mod call;
mod child;
pub mod discover;
pub mod elf;
mod examine;
mod found_in;
mod instance;
pub mod journal;
pub mod library;
mod linked;
mod load_error;
mod loader;
mod loader_sink;
mod log_book;
pub mod manifest;
mod names;
pub mod probe;
mod registry;
mod suitability;
mod verdict;

pub use call::CallState;
pub use child::TrialRequest;
pub use discover::{DiscoverOptions, standard_folders, standard_state_folder};
pub use examine::PluginFile;
pub use found_in::FoundIn;
pub use instance::HostInstance;
pub use journal::{Act, Culprit, Watch};
pub use library::Factory;
pub use linked::{LinkedLoaderError, linked_loader};
pub use load_error::LoadPluginError;
pub use loader::loaders;
pub use log_book::{LogBook, LogLine};
pub use names::UnknownPlugin;
pub use probe::{ChildProgram, Examination};
pub use registry::{PluginFolderError, PluginInfo, Registry};
pub use suitability::{Remedy, Suitability, suitability};
pub use verdict::{Verdict, VerdictClass};
