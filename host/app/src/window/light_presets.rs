//! Lights under names: what the *Lighting* tab offers at a click.

use glam::{DVec3, Vec3};
use pointstage_scene::{Headlight, Light, LightKind, LightSpace, Lights};

/// A set of lights with a name.
pub(crate) struct LightPreset {
    /// For people.
    pub(crate) name: &'static str,
    /// One sentence for the tooltip.
    pub(crate) help: &'static str,
    /// Makes them.
    pub(crate) lights: fn() -> Lights,
}

/// All presets, in the tab's order.
pub(crate) const LIGHT_PRESETS: [LightPreset; 4] = [
    LightPreset {
        name: "Default",
        help: "A key light over the left shoulder that shows relief, and a weak fill",
        lights: Lights::default,
    },
    LightPreset {
        name: "Headlight",
        help: "One white light at the eye: no part that is seen lies in the dark",
        lights: headlight,
    },
    LightPreset {
        name: "Three-point",
        help: "Key, fill and rim light: the rim sets the silhouette off from the background",
        lights: three_point,
    },
    LightPreset {
        name: "Flat",
        help: "Ambient light alone: the scan's own colours, without shading",
        lights: flat,
    },
];

/// The preset that these lights are, if any.
pub(crate) fn preset_of(lights: &Lights) -> Option<&'static str> {
    let mut presets = LIGHT_PRESETS.iter();
    let found = presets.find(|preset| (preset.lights)() == *lights);
    found.map(|preset| preset.name)
}

fn headlight() -> Lights {
    Lights {
        headlight: Headlight {
            enabled: true,
            ..Headlight::default()
        },
        ..Lights::default()
    }
}

/// Key from the upper left, fill from the right at a third of it, rim from behind and above.
fn three_point() -> Lights {
    let light = |towards: DVec3, strength: f32| Light {
        kind: LightKind::Directional {
            towards: towards.normalize(),
        },
        space: LightSpace::View,
        colour: Vec3::splat(strength),
        enabled: true,
    };
    Lights {
        ambient: Vec3::splat(0.08),
        lights: vec![
            light(DVec3::new(-0.7, 0.6, 0.8), 0.75),
            light(DVec3::new(0.9, 0.1, 0.7), 0.25),
            light(DVec3::new(0.3, 0.8, -0.9), 0.5),
        ],
        headlight: Headlight::default(),
    }
}

fn flat() -> Lights {
    Lights {
        ambient: Vec3::ONE,
        lights: Vec::new(),
        headlight: Headlight::default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_is_known_again() {
        for preset in &LIGHT_PRESETS {
            assert_eq!(preset_of(&(preset.lights)()), Some(preset.name));
        }
        let mut changed = Lights::default();
        changed.ambient.x += 0.1;
        assert_eq!(preset_of(&changed), None);
    }

    #[test]
    fn a_white_surface_that_faces_the_eye_is_not_burnt_out() {
        let material = pointstage_scene::Material::default();
        for preset in &LIGHT_PRESETS {
            let lights = (preset.lights)();
            let diffuse: f32 = lights
                .enabled()
                .iter()
                .map(|light| match light.kind {
                    LightKind::Directional { towards } => {
                        light.colour.max_element() * towards.normalize().z.max(0.0) as f32
                    }
                    LightKind::Point { .. } => light.colour.max_element(),
                })
                .sum();
            let seen = material.ka * lights.ambient.max_element() + material.kd * diffuse;
            assert!(seen <= 1.0, "{}: {seen}", preset.name);
            assert!(seen >= 0.4, "{}: {seen}", preset.name);
        }
    }
}
