//! The plugin interface.
pub mod abi;
pub mod columns;
