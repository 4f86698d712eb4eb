//! The wire form of the border: what host and plugin exchange, as plain data with a stated layout.
//!
//! Plugin authors never need this module; they write against the traits and types at the crate's top, and
//! [`export!`](crate::export) makes the adapters. The host speaks this form directly.
//!
//! # Growth rules
//!
//! Any plugin built against 1.x loads in any host 1.y, so what is here stays as it is:
//!
//! 1. A shipped `#[repr(C)]` record never changes: no field added, removed, renamed, reordered or retyped. A new need
//!    is a new record and a new method.
//! 2. Methods of objects and fields of the root are appended only, after `#[sabi(last_prefix_field)]`, each with a
//!    default body (objects) or read as an option (root).
//! 3. Formats, usages, kinds, codes and flags are open numbers (`#[repr(transparent)]`): new values change no layout, and
//!    a side that does not know a value answers with [`ErrorCode::UNSUPPORTED`]. Keys (targets, columns, statistics,
//!    settings, factory kinds) are strings; unknown ones are ignored or refused by name.
//! 4. A recorded command is an operation number and a payload ([`commands`]). A shipped payload never changes; a new
//!    need is a new number. An operation that the host does not know is an error that names its index.
//! 5. [`FrameUniform`] and [`DrawUniform`] are records too, and so are the bindings of groups 0 and 1
//!    ([`standard_bindings`]): the shaders of `shaders/lib` that a plugin was linked with read them.
//! 6. Nothing unwinds across the border: both sides catch panics and answer [`ErrorCode::PANICKED`].
//! 7. Borrowed data ends with the call. What is kept is an owning object or a handle.
//!
//! The only unsafe code of the crate is in this folder: what `#[sabi_trait]` and the root's export expand to.

#![allow(
    unsafe_code,
    missing_docs,
    non_local_definitions,
    unused_braces,
    clippy::undocumented_unsafe_blocks,
    clippy::pedantic,
    clippy::allow_attributes_without_reason,
    reason = "#[sabi_trait] and #[derive(StableAbi)] expand to undocumented unsafe code, inner items and braces"
)]

pub mod commands;
mod descriptors;
#[doc(hidden)]
pub mod export_parts;
mod frame;
mod loading;
mod objects;
mod root;
mod scene;
mod values;

pub use descriptors::*;
pub use frame::*;
pub use loading::*;
pub use objects::*;
pub use root::*;
pub use scene::*;
pub use values::*;
