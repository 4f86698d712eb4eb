//! The plugin interface.
pub mod abi;
