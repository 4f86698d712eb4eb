//! Reversed depth and distance from the eye.
//!
//! Both projections keep clip z and w free of x and y, so depth depends on the distance d = −z_view alone:
//!
//! ```text
//! depth = (m22·z + m32) / (m23·z + m33)        with m the columns of clip_from_view
//! z     = (depth·m33 − m32) / (m22 − depth·m23)
//! ```

use glam::{Mat4, Vec4};

/// Distance from the eye along the line of sight, scene units, of a value of the `depth` target.
///
/// * `depth`: reversed z, unshifted; 1 at the near plane.
/// * `clip_from_view`: the frame's projection.
///
/// Infinite where `depth` is 0 in a perspective view, the distance of the far plane in an orthographic one. It is a
/// distance between planes (−z of view space), not along the pixel's ray.
pub fn eye_distance(depth: f32, clip_from_view: &Mat4) -> f32 {
    distance_with(depth, distance_terms(clip_from_view))
}

/// The terms (a, b, c, d) of `distance = (a + b·depth) / (c + d·depth)`.
pub(crate) fn distance_terms(clip_from_view: &Mat4) -> Vec4 {
    let [z, w] = [clip_from_view.z_axis, clip_from_view.w_axis];
    Vec4::new(w.z, -w.w, z.z, -z.w)
}

/// Distance from the terms of [`distance_terms`]; the twin of the shader's function of the same name.
pub(crate) fn distance_with(depth: f32, terms: Vec4) -> f32 {
    (terms.x + terms.y * depth) / (terms.z + terms.w * depth)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use pointstage_scene::{Camera, Projection};

    #[test]
    fn depth_and_distance_are_inverse_in_both_projections() {
        let projections = [
            Projection::Perspective { fov_y_rad: 0.8 },
            Projection::Orthographic { height: 3.0 },
        ];
        for projection in projections {
            let camera = Camera {
                projection,
                near: 0.5,
                far: 20.0,
                ..Camera::default()
            };
            let clip_from_view = camera.clip_from_view(1.5).as_mat4();
            for distance in [0.5_f32, 0.7, 3.0, 19.0] {
                let depth = clip_from_view
                    .project_point3(Vec3::new(0.3, -0.2, -distance))
                    .z;
                let back = eye_distance(depth, &clip_from_view);
                // Some roundings of f32 apart.
                assert!(
                    (back / distance - 1.0).abs() < 1e-5,
                    "{distance} gave {back}"
                );
            }
        }
    }

    #[test]
    fn depth_zero_is_infinitely_far_in_perspective() {
        let clip_from_view = Camera::default().clip_from_view(1.0).as_mat4();
        assert_eq!(eye_distance(0.0, &clip_from_view), f32::INFINITY);
    }
}
