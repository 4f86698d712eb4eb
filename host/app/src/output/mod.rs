//! Files that the commands write: pictures, targets, statistics.
//!
//! Everything goes through [`whole_file::write`], so a file appears whole or not at all. [`file_values`] turns targets into what files hold; [`names`] numbers the files of
//! several views; [`png_file`] and [`exr_file`] make the bytes.

pub(crate) mod exr_file;
pub(crate) mod file_values;
pub(crate) mod names;
pub(crate) mod png_file;
pub(crate) mod whole_file;
