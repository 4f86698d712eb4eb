//! Phong lighting in view space, f32 for speed; `pointstage_plugin_api::twin::lighting` has the formula, the tests compare.
//!
//! A light behind the surface adds nothing, its highlight included.

use glam::{Vec3, Vec4};
use pointstage_plugin_api::abi::FrameUniform;

/// Phong coefficients of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Phong {
    /// ka.
    ambient: f32,
    /// kd.
    diffuse: f32,
    /// ks.
    specular: f32,
    /// Exponent of the highlight.
    shininess: f32,
}

impl From<[f32; 4]> for Phong {
    /// From ka, kd, ks, shininess, as in a draw's uniform.
    fn from([ambient, diffuse, specular, shininess]: [f32; 4]) -> Self {
        Self {
            ambient,
            diffuse,
            specular,
            shininess,
        }
    }
}

/// Unit direction from a point towards the eye; view space.
pub(super) fn towards_eye(position_view: Vec3, frame: &FrameUniform) -> Vec3 {
    if frame.is_orthographic == 0 {
        (-position_view).normalize_or(Vec3::Z)
    } else {
        Vec3::Z
    }
}

/// The normal, turned so that it faces the eye.
pub(super) fn facing(normal_view: Vec3, towards_eye: Vec3) -> Vec3 {
    if normal_view.dot(towards_eye) < 0.0 {
        -normal_view
    } else {
        normal_view
    }
}

/// Light that a surface sends to the eye, linear RGB.
///
/// * `normal_view`: unit; for two-sided surfaces already turned by [`facing`].
/// * `towards_eye`: unit, see [`towards_eye`].
/// * `colour`: linear RGB of the surface.
pub(super) fn phong(
    position_view: Vec3,
    normal_view: Vec3,
    towards_eye: Vec3,
    colour: Vec3,
    surface: Phong,
    frame: &FrameUniform,
) -> Vec3 {
    let Phong {
        ambient,
        diffuse,
        specular,
        shininess,
    } = surface;
    let mut light = ambient * Vec4::from_array(frame.ambient).truncate() * colour;
    let count = (frame.light_count as usize).min(frame.lights.len());
    for source in &frame.lights[..count] {
        let place = Vec4::from_array(source.position_view);
        let towards_light = if place.w == 0.0 {
            place.truncate()
        } else {
            (place.truncate() - position_view).normalize_or_zero()
        };
        let cosine = normal_view.dot(towards_light);
        let lit = cosine > 0.0;
        if !lit {
            continue;
        }
        let mut reflected = diffuse * cosine * colour;
        if specular > 0.0 {
            let mirrored = 2.0 * cosine * normal_view - towards_light;
            // A base of 0 would make pow(0, 0) = 1: a highlight at grazing angles.
            let alignment = mirrored.dot(towards_eye);
            if alignment > 0.0 {
                reflected += specular * alignment.powf(shininess);
            }
        }
        light += reflected * Vec4::from_array(source.colour).truncate();
    }
    light
}

#[cfg(test)]
mod tests {
    use super::*;
    use pointstage_plugin_api::abi::LightUniform;
    use pointstage_plugin_api::twin;
    use proptest::prelude::*;

    fn direction() -> impl Strategy<Value = Vec3> {
        let part = || -1.0_f32..1.0;
        (part(), part(), part())
            .prop_map(|(x, y, z)| Vec3::new(x, y, z))
            .prop_filter("no direction", |vector| vector.length() > 0.1)
    }

    proptest! {
        #[test]
        fn a_surface_is_as_bright_as_the_library_says(
            position_view in direction(),
            normal_view in direction(),
            lights in proptest::collection::vec((direction(), any::<bool>()), 0..=4),
            orthographic in any::<bool>(),
        ) {
            let mut frame = FrameUniform {
                ambient: [0.1, 0.2, 0.3, 0.0],
                light_count: lights.len() as u32,
                is_orthographic: u32::from(orthographic),
                ..FrameUniform::default()
            };
            for (uniform, (light, is_point)) in frame.lights.iter_mut().zip(&lights) {
                *uniform = LightUniform {
                    position_view: if *is_point {
                        (3.0 * light).extend(1.0).to_array()
                    } else {
                        light.normalize().extend(0.0).to_array()
                    },
                    colour: [0.5, 0.4, 0.3, 0.0],
                };
            }
            let position_view = position_view - 3.0 * Vec3::Z;
            let normal_view = normal_view.normalize();
            let material = [0.25, 0.5, 0.75, 12.0];
            let colour = Vec3::new(0.9, 0.5, 0.1);
            let eye = towards_eye(position_view, &frame);
            let light = phong(position_view, normal_view, eye, colour, material.into(), &frame);
            let expected = twin::lighting::phong(
                &frame,
                material,
                colour.as_dvec3(),
                position_view.as_dvec3(),
                normal_view.as_dvec3(),
            );
            // Four lights' roundings of f32; the exponent multiplies that of the cosine by 12.
            prop_assert!(light.as_dvec3().abs_diff_eq(expected, 2e-5), "{light} {expected}");
        }
    }

    #[test]
    fn a_light_at_the_surface_itself_is_finite() {
        let mut frame = FrameUniform {
            light_count: 1,
            ..FrameUniform::default()
        };
        frame.lights[0].position_view = [0.0, 0.0, -2.0, 1.0];
        frame.lights[0].colour = [1.0; 4];
        let material = [0.5, 0.5, 0.5, 8.0].into();
        let position_view = Vec3::new(0.0, 0.0, -2.0);
        let light = phong(position_view, Vec3::Z, Vec3::Z, Vec3::ONE, material, &frame);
        assert!(light.is_finite(), "{light}");
    }

    #[test]
    fn facing_turns_only_what_looks_away() {
        assert_eq!(facing(Vec3::NEG_Z, Vec3::Z), Vec3::Z);
        assert_eq!(facing(Vec3::Z, Vec3::Z), Vec3::Z);
    }
}
