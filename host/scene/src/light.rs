//! Lights: an ambient colour and up to four sources.

use glam::{DMat4, DVec3, Vec3};
use serde::{Deserialize, Serialize};

/// The most sources that a frame carries.
pub const MAX_LIGHTS: usize = 4;

/// The lighting of a view. Colours are linear light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lights {
    /// Light from everywhere, linear RGB.
    pub ambient: Vec3,
    /// At most [`MAX_LIGHTS`]; [`enabled`](Self::enabled) ignores the rest.
    pub lights: Vec<Light>,
}

/// One source.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Light {
    /// Where it stands.
    pub kind: LightKind,
    /// The space of its direction or position.
    pub space: LightSpace,
    /// Linear RGB, may exceed 1.
    pub colour: Vec3,
}

/// Shape of a source.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LightKind {
    /// Infinitely far; `towards` points from the surface to the light, any length but zero.
    Directional {
        /// From the surface to the light.
        towards: DVec3,
    },
    /// At a point, without fall-off.
    Point {
        /// Where it stands, scene units.
        position: DVec3,
    },
}

/// Space in which a source is fixed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LightSpace {
    /// It moves with the eye (x right, y up, looks down −z): a headlight.
    #[default]
    View,
    /// It stands in the scene.
    World,
}

impl Lights {
    /// The sources that count: the first [`MAX_LIGHTS`].
    pub fn enabled(&self) -> &[Light] {
        &self.lights[..self.lights.len().min(MAX_LIGHTS)]
    }
}

impl Light {
    /// The source in view space, whatever space it is fixed in.
    pub fn kind_view(&self, view_from_world: &DMat4) -> LightKind {
        match (self.space, self.kind) {
            (LightSpace::View, kind) => kind,
            (LightSpace::World, LightKind::Directional { towards }) => LightKind::Directional {
                towards: view_from_world.transform_vector3(towards),
            },
            (LightSpace::World, LightKind::Point { position }) => LightKind::Point {
                position: view_from_world.transform_point3(position),
            },
        }
    }
}

impl Default for Lights {
    /// A key light over the left shoulder that shows relief, a weak cool fill from the right below, and a little ambient.
    ///
    /// Facing both, a white surface of the default material stays just under 1.
    fn default() -> Self {
        let directional = |towards: DVec3, colour: Vec3| Light {
            kind: LightKind::Directional {
                towards: towards.normalize(),
            },
            space: LightSpace::View,
            colour,
        };
        Self {
            ambient: Vec3::splat(0.12),
            lights: vec![
                directional(DVec3::new(-0.45, 0.6, 1.0), Vec3::new(0.95, 0.94, 0.92)),
                directional(DVec3::new(0.8, -0.3, 0.5), Vec3::new(0.10, 0.11, 0.13)),
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_more_than_four_count() {
        let mut lights = Lights::default();
        while lights.lights.len() < 9 {
            lights.lights.push(lights.lights[0].clone());
        }
        assert_eq!(lights.enabled().len(), MAX_LIGHTS);
    }

    #[test]
    fn a_world_light_turns_with_the_view() {
        let light = Light {
            kind: LightKind::Directional { towards: DVec3::X },
            space: LightSpace::World,
            colour: Vec3::ONE,
        };
        let quarter_turn = DMat4::from_rotation_y(std::f64::consts::FRAC_PI_2);
        let LightKind::Directional { towards } = light.kind_view(&quarter_turn) else {
            panic!("kind changed")
        };
        assert!((towards - DVec3::NEG_Z).length() < 1e-12, "{towards}");
    }
}
