//! Phong lighting in view space: the Rust twin of the shader library's.
//!
//! ```text
//! colour = ka·ambient·c + Σ over lights ( kd·c·max(n·l, 0) + ks·max(r·v, 0)^shininess ) · light
//! r = 2 (n·l) n − l
//! ```
//!
//! n the unit normal, l towards the light, v towards the eye, c the surface's linear colour. A light behind the surface
//! adds nothing, its highlight included. Phong, *Illumination for Computer Generated Pictures*, CACM 1975.

use glam::{Vec3, Vec4};
use pointstage_plugin_api::abi::FrameUniform;

/// Phong coefficients of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phong {
    /// ka.
    pub ambient: f32,
    /// kd.
    pub diffuse: f32,
    /// ks.
    pub specular: f32,
    /// Exponent of the highlight.
    pub shininess: f32,
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
pub fn towards_eye(position_view: Vec3, frame: &FrameUniform) -> Vec3 {
    if frame.is_orthographic == 0 {
        (-position_view).normalize_or(Vec3::Z)
    } else {
        Vec3::Z
    }
}

/// The normal, turned so that it faces the eye.
pub fn facing(normal_view: Vec3, towards_eye: Vec3) -> Vec3 {
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
pub fn phong(
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

    const SURFACE: Phong = Phong {
        ambient: 0.5,
        diffuse: 0.75,
        specular: 0.25,
        shininess: 8.0,
    };

    fn frame(position_view: [f32; 4]) -> FrameUniform {
        let mut frame = FrameUniform {
            ambient: [0.2, 0.2, 0.2, 0.0],
            light_count: 1,
            ..FrameUniform::default()
        };
        frame.lights[0] = LightUniform {
            position_view,
            colour: [1.0, 0.5, 0.0, 0.0],
        };
        frame
    }

    fn lit(frame: &FrameUniform, normal_view: Vec3) -> Vec3 {
        let position_view = Vec3::new(0.0, 0.0, -2.0);
        let eye = towards_eye(position_view, frame);
        phong(
            position_view,
            normal_view,
            eye,
            Vec3::new(1.0, 0.5, 0.25),
            SURFACE,
            frame,
        )
    }

    #[test]
    fn a_surface_that_faces_eye_and_light_gets_all_terms() {
        let light = lit(&frame([0.0, 0.0, 1.0, 0.0]), Vec3::Z);
        // Ambient 0.5·0.2·c, diffuse 0.75·c, highlight 0.25; times the light's colour.
        let expected = Vec3::new(0.1 + 1.0, 0.05 + (0.375 + 0.25) * 0.5, 0.025);
        assert!((light - expected).abs().max_element() < 1e-6, "{light}");
    }

    #[test]
    fn a_point_light_at_the_eye_is_a_headlight() {
        let point = lit(&frame([0.0, 0.0, 0.0, 1.0]), Vec3::Z);
        assert_eq!(point, lit(&frame([0.0, 0.0, 1.0, 0.0]), Vec3::Z));
    }

    #[test]
    fn a_light_behind_the_surface_leaves_the_ambient_light() {
        let light = lit(&frame([0.0, 0.0, -1.0, 0.0]), Vec3::Z);
        assert!((light - Vec3::new(0.1, 0.05, 0.025)).abs().max_element() < 1e-6);
    }

    #[test]
    fn a_light_at_the_surface_itself_is_finite() {
        let light = lit(&frame([0.0, 0.0, -2.0, 1.0]), Vec3::Z);
        assert!(light.is_finite(), "{light}");
    }

    #[test]
    fn facing_turns_only_what_looks_away() {
        let eye = Vec3::Z;
        assert_eq!(facing(Vec3::NEG_Z, eye), Vec3::Z);
        assert_eq!(facing(Vec3::Z, eye), Vec3::Z);
    }
}
