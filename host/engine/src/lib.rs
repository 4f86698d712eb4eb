//! How Pointstage draws: device, GPU service, plugin loading, frames, targets and measurements. No window, no user
//! interface, and no scene files: those belong to the program and to the scene.

pub mod device;
pub mod frame;
pub mod gpu;
pub mod metrics;
pub mod plugins;
pub mod stage;
