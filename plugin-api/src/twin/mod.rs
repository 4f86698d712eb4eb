//! CPU twins of the shader library, in f64: the same functions by the same names, as oracle for tests and as building
//! blocks of CPU renderers.
//!
//! The twins of `lib::octahedral` and `lib::colour` are in [`columns`](crate::columns), since loaders pack with them.

pub mod camera;
pub mod clip;
pub mod depth;
pub mod ellipse;
pub mod lighting;

use glam::{DMat4, Mat4};

/// A uniform's matrix, widened.
fn matrix(columns: &[[f32; 4]; 4]) -> DMat4 {
    Mat4::from_cols_array_2d(columns).as_dmat4()
}
