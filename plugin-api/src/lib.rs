#![doc = include_str!("../README.md")]

pub mod abi;
mod adapter;
pub mod clip;
pub mod columns;
mod error;
mod export;
mod frame;
pub mod gpu;
mod guard;
mod host;
pub mod lines;
pub mod loading;
pub mod manifest;
mod manifest_parse;
pub mod nearest;
pub mod pieces;
mod renderer;
mod scan;
mod scene;
mod setting_value;
mod settings;
mod settings_parse;
pub mod settings_schema;
pub mod statistics;
mod structure;
pub mod targets;
pub mod twin;
pub mod wgsl;

#[doc(hidden)]
pub use crate::export::parts as __export;
pub use abi::{
    ChangeKind, ColumnRole, DrawFlags, DrawUniform, ErrorCode, FrameChanges, FrameUniform,
    Interaction, LogLevel, MaterialRecord, Purpose, ScalarType,
};
pub use error::{Error, Result};
pub use frame::{Draw, Frame, Outcome, Plane, Target};
pub use glam;
pub use host::{Host, Progress};
pub use renderer::{Renderer, View};
pub use scene::{Block, Changes, Column, Object, Scene};
pub use settings::Settings;
pub use structure::{OwnBlock, Query, Selection, Selector, Source, Structure};

/// What nearly every plugin imports.
pub mod prelude {
    pub use crate::gpu::{Gpu, Recorder};
    pub use crate::{
        Changes, Error, Frame, Host, Outcome, Progress, Query, Renderer, Result, Scene, Selection,
        Selector, Settings, Structure, View, export,
    };
}
