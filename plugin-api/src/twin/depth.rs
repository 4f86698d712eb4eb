//! Twin of `lib::depth`: reversed depth and distances from the eye.

use super::matrix;
use crate::abi::FrameUniform;

/// Distance from the eye's plane, scene units along the view direction. Infinite for depth 0 and an infinite far plane.
pub fn eye_distance_from_depth(frame: &FrameUniform, depth: f64) -> f64 {
    let view_from_clip = matrix(&frame.view_from_clip);
    let z_and_w = view_from_clip.z_axis * depth + view_from_clip.w_axis;
    -z_and_w.z / z_and_w.w
}

/// Depth from the distance from the eye's plane, scene units along the view direction.
pub fn depth_from_eye_distance(frame: &FrameUniform, distance: f64) -> f64 {
    let clip_from_view = matrix(&frame.clip_from_view);
    let z_and_w = clip_from_view.w_axis - clip_from_view.z_axis * distance;
    z_and_w.z / z_and_w.w
}

/// A number that sorts as depth does: greater is nearer. Depth must not be negative.
pub fn bits_from_depth(depth: f32) -> u32 {
    depth.to_bits()
}

/// Inverse of [`bits_from_depth`].
pub fn depth_from_bits(bits: u32) -> f32 {
    f32::from_bits(bits)
}
