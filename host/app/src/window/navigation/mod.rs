//! How the camera moves.
//!
//! [`mod@gestures`] turns what the pointer and the keyboard do over the picture into [`CameraMove`]s; [`moves`] carries one out on
//! a camera; the [`Navigator`] remembers what goes on by itself: a [flight](super::flight) to another view, and the [`glide`]
//! after a drag that was let go of in motion, as fast as the [`trail`] of the pointer was. [`options`] are the user's habits.

mod axes;
mod fly;
mod gestures;
mod glide;
mod moves;
mod navigator;
mod options;
mod trail;

pub(crate) use axes::{Axis, UpAxis};
pub(crate) use fly::take_flying_keys;
pub(crate) use gestures::{Gestures, Hands, gestures};
pub(crate) use glide::{Glide, GlideKind};
pub(crate) use moves::{CameraMove, Surroundings, fov_degrees};
pub(crate) use navigator::Navigator;
pub(crate) use options::{FLY_SPEEDS, NavigationOptions, ScrollAction};
