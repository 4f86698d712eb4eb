#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod beside;
mod divide;
mod footprint;
mod light;
mod picture;
pub mod polygon;
mod surface;

pub use beside::{BesideError, read_beside};
pub use divide::{Divided, FINE_ENOUGH, MOST_VERTICES, divide};
pub use footprint::Wrap;
pub use light::{LightSum, linear, linear_of, srgb, srgb_byte};
pub use picture::{Alpha, MOST_TEXELS, Picture, PictureError, PictureFile};
pub use surface::{Material, NO_MATERIAL, Surface, colours, face_colours, picture_files};
