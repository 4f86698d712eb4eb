//! Files that the program writes: pictures, targets, statistics.
//!
//! Everything goes through [`whole_file`], so a file appears whole or not at all. [`file_values`] turns targets into what
//! files hold; [`names`] numbers the files of several views; [`png_file`] and [`exr_file`] make the bytes; [`record`] says
//! what an image was made from. [`export`] saves images of any size, for the window and the command line.

pub(crate) mod export;
pub(crate) mod exr_file;
pub(crate) mod file_values;
pub(crate) mod names;
pub(crate) mod png_file;
pub(crate) mod record;
pub(crate) mod whole_file;
