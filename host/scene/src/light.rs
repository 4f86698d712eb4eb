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
    /// A light at the eye that, while it is on, shines instead of all of `lights`.
    #[serde(default)]
    pub headlight: Headlight,
}

/// One white light that shines where the eye looks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Headlight {
    /// Whether it shines, and the others do not.
    pub enabled: bool,
    /// Linear intensity, kept while it is off.
    pub strength: f32,
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
    /// Whether it shines.
    #[serde(default = "shining")]
    pub enabled: bool,
}

/// A source shines unless a file says otherwise.
fn shining() -> bool {
    true
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
    /// The sources that shine: the headlight alone, or those of the first [`MAX_LIGHTS`] that are enabled.
    pub fn enabled(&self) -> Vec<Light> {
        if self.headlight.enabled {
            return vec![self.headlight.as_light()];
        }
        let listed = self.lights.iter().take(MAX_LIGHTS);
        listed.filter(|light| light.enabled).cloned().collect()
    }
}

impl Headlight {
    /// It as a source: from the eye, straight ahead.
    pub fn as_light(self) -> Light {
        Light {
            kind: LightKind::Directional { towards: DVec3::Z },
            space: LightSpace::View,
            colour: Vec3::splat(self.strength),
            enabled: true,
        }
    }
}

impl Default for Headlight {
    /// Off; a white surface of the default material that faces the eye would stay just under 1.
    fn default() -> Self {
        Self {
            enabled: false,
            strength: 0.9,
        }
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
            enabled: true,
        };
        Self {
            ambient: Vec3::splat(0.12),
            lights: vec![
                directional(DVec3::new(-0.45, 0.6, 1.0), Vec3::new(0.95, 0.94, 0.92)),
                directional(DVec3::new(0.8, -0.3, 0.5), Vec3::new(0.10, 0.11, 0.13)),
            ],
            headlight: Headlight::default(),
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
    fn lights_that_are_off_do_not_count() {
        let mut lights = Lights::default();
        lights.lights[0].enabled = false;
        assert_eq!(lights.enabled(), [lights.lights[1].clone()]);
    }

    #[test]
    fn the_headlight_shines_alone_and_leaves_the_others_as_they_are() {
        let mut lights = Lights {
            headlight: Headlight {
                enabled: true,
                strength: 0.5,
            },
            ..Lights::default()
        };
        let shining = lights.enabled();
        assert_eq!(shining.len(), 1);
        assert_eq!(shining[0].colour, Vec3::splat(0.5));
        lights.headlight.enabled = false;
        assert_eq!(lights.enabled(), Lights::default().enabled());
    }

    #[test]
    fn a_world_light_turns_with_the_view() {
        let light = Light {
            kind: LightKind::Directional { towards: DVec3::X },
            space: LightSpace::World,
            colour: Vec3::ONE,
            enabled: true,
        };
        let quarter_turn = DMat4::from_rotation_y(std::f64::consts::FRAC_PI_2);
        let LightKind::Directional { towards } = light.kind_view(&quarter_turn) else {
            panic!("kind changed")
        };
        assert!((towards - DVec3::NEG_Z).length() < 1e-12, "{towards}");
    }
}
