//! Twin of `lib::lighting`: Phong, as in PointShop3D.

use super::camera::Camera;
use crate::abi::FrameUniform;
use glam::DVec3;

/// Unit direction from `position_view` towards the light `index`; view space.
pub fn towards_light(frame: &FrameUniform, index: usize, position_view: DVec3) -> DVec3 {
    let [x, y, z, w] = frame.lights[index].position_view.map(f64::from);
    let light = DVec3::new(x, y, z);
    if w == 0.0 {
        light
    } else {
        (light - position_view).normalize()
    }
}

/// Light that leaves a point towards the eye; linear RGB.
///
/// ```text
/// ka·ambient·c + Σ L·(kd·c·max(n·l, 0) + ks·max(r·v, 0)^shininess)      (ks only where n·l > 0)
/// ```
///
/// * `material`: ka, kd, ks, shininess.
/// * `colour`: c, linear RGB.
/// * `normal_view`: n, unit, on the lit side; r is l mirrored at n, v the direction to the eye.
pub fn phong(
    frame: &FrameUniform,
    material: [f32; 4],
    colour: DVec3,
    position_view: DVec3,
    normal_view: DVec3,
) -> DVec3 {
    let [ka, kd, ks, shininess] = material.map(f64::from);
    let rgb = |[r, g, b, _]: [f32; 4]| DVec3::new(f64::from(r), f64::from(g), f64::from(b));
    let to_eye = Camera::from(frame).towards_eye(position_view);
    let mut sum = ka * rgb(frame.ambient) * colour;
    for index in 0..frame.lights.len().min(frame.light_count as usize) {
        let to_light = towards_light(frame, index, position_view);
        let incidence = normal_view.dot(to_light);
        if incidence <= 0.0 || incidence.is_nan() {
            continue;
        }
        let mirrored = 2.0 * incidence * normal_view - to_light;
        let alignment = mirrored.dot(to_eye);
        let highlight = if alignment > 0.0 {
            alignment.powf(shininess)
        } else {
            0.0
        };
        sum += rgb(frame.lights[index].colour)
            * (kd * incidence * colour + DVec3::splat(ks * highlight));
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::abi::LightUniform;

    const MATERIAL: [f32; 4] = [0.25, 0.5, 0.75, 10.0];

    /// One white light from `direction` and an ambient of 1.
    fn lit_from(direction: [f32; 3]) -> FrameUniform {
        let [x, y, z] = direction;
        let mut frame = FrameUniform {
            light_count: 1,
            ambient: [1.0; 4],
            ..FrameUniform::default()
        };
        frame.lights[0] = LightUniform {
            position_view: [x, y, z, 0.0],
            colour: [1.0; 4],
        };
        frame
    }

    #[test]
    fn a_light_at_the_eye_gives_all_three_terms() {
        let colour = DVec3::new(0.4, 0.2, 0.0);
        let light = phong(
            &lit_from([0.0, 0.0, 1.0]),
            MATERIAL,
            colour,
            DVec3::new(0.0, 0.0, -3.0),
            DVec3::Z,
        );
        assert!(
            light.abs_diff_eq(0.25 * colour + 0.5 * colour + 0.75, 1e-12),
            "{light}"
        );
    }

    #[test]
    fn a_light_behind_the_surface_leaves_the_ambient_term() {
        let light = phong(
            &lit_from([0.0, 0.0, -1.0]),
            MATERIAL,
            DVec3::ONE,
            DVec3::new(0.0, 0.0, -3.0),
            DVec3::Z,
        );
        assert!(light.abs_diff_eq(DVec3::splat(0.25), 1e-12), "{light}");
    }
}
