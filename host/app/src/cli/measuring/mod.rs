//! What the commands that measure (`compare`, `bench`, `sweep`) have in common.
//!
//! [`entries`] are the renderers with their settings, [`who`] what reports say of them, [`look`] what is the same for all of them. [`times`] draws and keeps time;
//! [`limits`] says whether what was found is too much; [`made_by`] tells program, device and command, so that what was
//! measured can be measured again.

pub(super) mod entries;
pub(super) mod limits;
pub(super) mod look;
pub(super) mod made_by;
pub(super) mod times;
pub(super) mod who;
