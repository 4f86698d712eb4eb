//! What is done to whole objects: copies, unions, and where they stand.

mod merge;
mod named;
mod placement;

pub use merge::{MergeError, merge};
pub use placement::Placement;

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
