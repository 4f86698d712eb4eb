//! What is done to whole objects: copies, unions, where they stand; and to surfels: finding them, and taking them out.
//!
//! [`marks_on_screen`] and [`marks_in_box`] find surfels; what they give goes into [`Object::marks`]. [`extract`] makes a geometry
//! of some of an object's surfels: what is kept when others are deleted, and what is copied. These change no object and may
//! take a while, so they run on a worker.

mod in_box;
mod merge;
mod named;
mod on_screen;
mod pieces;
mod placement;
mod region;

pub use in_box::marks_in_box;
pub use merge::{MergeError, merge};
pub use on_screen::{Occluder, ScreenView, marks_on_screen};
pub use pieces::{extract, piece_of, without_marked};
pub use placement::Placement;
pub use region::ScreenRegion;

use crate::scene::{Object, ObjectId, Revision};

/// A second object in the same place with the same looks. It shares the first one's columns, and its file.
pub fn duplicate(object: &Object, name: impl Into<String>) -> Object {
    Object {
        id: ObjectId::next(),
        name: name.into(),
        revision: Revision::next(),
        ..object.clone()
    }
}
