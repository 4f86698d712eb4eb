//! Readers of fields that check what they read: for serde's `deserialize_with`.

use pointstage_scene::{Light, LightKind, Lights, MAX_LIGHTS, Material, ViewRecord};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

/// A factor above 0.
pub(crate) fn positive<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f32, D::Error> {
    let factor = f32::deserialize(deserializer)?;
    if factor.is_finite() && factor > 0.0 {
        Ok(factor)
    } else {
        Err(D::Error::custom(format!(
            "expected a number above 0, found {factor}"
        )))
    }
}

/// A view that shows something.
pub(crate) fn view<'de, D: Deserializer<'de>>(deserializer: D) -> Result<ViewRecord, D::Error> {
    let record = ViewRecord::deserialize(deserializer)?;
    record.checked().map_err(D::Error::custom)
}

/// A map of an object into the world.
pub(crate) fn transform<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<glam::DAffine3, D::Error> {
    let transform = glam::DAffine3::deserialize(deserializer)?;
    if transform.is_finite() {
        Ok(transform)
    } else {
        Err(D::Error::custom(
            "transform: expected twelve finite numbers, column by column, found an infinite one or NaN",
        ))
    }
}

/// A material of finite coefficients that are not negative.
pub(crate) fn material<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Material, D::Error> {
    let material = Material::deserialize(deserializer)?;
    let Material {
        ka,
        kd,
        ks,
        shininess,
    } = material;
    for (name, value) in [("ka", ka), ("kd", kd), ("ks", ks), ("shininess", shininess)] {
        if !(value.is_finite() && value >= 0.0) {
            return Err(D::Error::custom(format!(
                "{name}: expected a number from 0, found {value}"
            )));
        }
    }
    Ok(material)
}

/// Lights that light something.
pub(crate) fn lights<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Lights, D::Error> {
    let lights = Lights::deserialize(deserializer)?;
    match flaw_of_lights(&lights) {
        None => Ok(lights),
        Some(flaw) => Err(D::Error::custom(flaw)),
    }
}

fn flaw_of_lights(lights: &Lights) -> Option<String> {
    let is_colour = |colour: glam::Vec3| colour.is_finite() && colour.min_element() >= 0.0;
    if lights.lights.len() > MAX_LIGHTS {
        let count = lights.lights.len();
        return Some(format!(
            "lights: expected at most {MAX_LIGHTS}, found {count}"
        ));
    }
    if !is_colour(lights.ambient) {
        let found = lights.ambient;
        return Some(format!(
            "ambient: expected three numbers from 0, found {found}"
        ));
    }
    let strength = lights.headlight.strength;
    if !(strength.is_finite() && strength >= 0.0) {
        return Some(format!(
            "strength: expected a number from 0, found {strength}"
        ));
    }
    lights.lights.iter().find_map(|light: &Light| {
        if !is_colour(light.colour) {
            let found = light.colour;
            return Some(format!(
                "colour: expected three numbers from 0, found {found}"
            ));
        }
        match light.kind {
            LightKind::Directional { towards } if !(towards.length() > 0.0 && towards.is_finite()) => {
                Some(format!("towards: expected a direction of three finite numbers, not all 0, found {towards}"))
            }
            LightKind::Point { position } if !position.is_finite() => Some(format!(
                "position: expected three finite numbers, found {position}"
            )),
            _ => None,
        }
    })
}
