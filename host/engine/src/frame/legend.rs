//! The legend of a shown target, as plain data for the window and for files.

use super::palette::{KIND_NAMES, KINDS, RAMP};
use super::targets::{Appearance, TargetSpec};

/// What the colours of a shown target mean.
#[derive(Clone, Debug, PartialEq)]
pub struct Legend {
    /// One line: key and meaning.
    pub title: String,
    /// The colours.
    pub scale: Scale,
}

/// The colours of a legend.
#[derive(Clone, Debug, PartialEq)]
pub enum Scale {
    /// A continuous ramp; positions rise from 0 to 1, and colours between stops are interpolated in sRGB.
    Ramp(Vec<Stop>),
    /// Fixed colours with names.
    Categories(Vec<Category>),
    /// Nothing to explain: the colours are the scene's own, or arbitrary.
    None,
}

/// A place on a ramp.
#[derive(Clone, Debug, PartialEq)]
pub struct Stop {
    /// 0 at the ramp's dark end, 1 at its bright end.
    pub position: f32,
    /// 8-bit sRGB.
    pub colour: [u8; 3],
    /// The value here, or empty where the ramp only needs the colour.
    pub label: String,
}

/// A fixed colour.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Category {
    /// 8-bit sRGB.
    pub colour: [u8; 3],
    /// What it stands for.
    pub label: String,
}

/// The legend of a target.
///
/// `range` is what the composition found in view: the values at the ramp's dark and bright end. `None` (nothing in view)
/// leaves the ramp without labels.
pub fn legend(spec: &TargetSpec, range: Option<[f32; 2]>) -> Legend {
    let TargetSpec { key, meaning, .. } = spec;
    let unit = match spec.appearance {
        Appearance::Depth => " (scene units)",
        _ => "",
    };
    let scale = match spec.appearance {
        Appearance::Colours | Appearance::Identities => Scale::None,
        Appearance::Normals => Scale::Categories(directions()),
        Appearance::Kinds => Scale::Categories(kinds()),
        Appearance::Depth | Appearance::RampFromZero | Appearance::Ramp => ramp(range),
    };
    let title = if meaning.is_empty() {
        format!("{key}{unit}")
    } else {
        format!("{key}: {meaning}{unit}")
    };
    Legend { title, scale }
}

/// The three kinds that exist; what nobody writes is not explained.
fn kinds() -> Vec<Category> {
    let known = KINDS.iter().zip(KIND_NAMES).skip(1).take(3);
    known
        .map(|(colour, name)| Category {
            colour: *colour,
            label: name.to_owned(),
        })
        .collect()
}

/// Colours of the axes: x, y, z from −1..1 to red, green, blue.
fn directions() -> Vec<Category> {
    let entries = [
        ([255, 128, 128], "right"),
        ([0, 128, 128], "left"),
        ([128, 255, 128], "up"),
        ([128, 0, 128], "down"),
        ([128, 128, 255], "towards the eye"),
    ];
    entries
        .map(|(colour, label)| Category {
            colour,
            label: label.to_owned(),
        })
        .into()
}

/// All stops of the palette, labelled at the ends and in the middle.
fn ramp(range: Option<[f32; 2]>) -> Scale {
    let last = RAMP.len() - 1;
    let stops = RAMP.iter().enumerate().map(|(index, colour)| {
        let position = index as f32 / last as f32;
        let label = match range {
            Some([dark, bright]) if index == 0 || index == last || index == last / 2 => {
                number_label(dark + (bright - dark) * position)
            }
            _ => String::new(),
        };
        Stop {
            position,
            colour: *colour,
            label,
        }
    });
    Scale::Ramp(stops.collect())
}

/// Four significant digits, without trailing zeros.
fn number_label(value: f32) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let magnitude = value.abs().log10().floor();
    if !(-4.0..7.0).contains(&magnitude) {
        return format!("{value:.3e}");
    }
    let decimals = (3.0 - magnitude).max(0.0) as usize;
    without_trailing_zeros(&format!("{value:.decimals$}")).to_owned()
}

/// A decimal number without zeros at the end of its fraction.
pub fn without_trailing_zeros(number: &str) -> &str {
    if number.contains('.') {
        number.trim_end_matches('0').trim_end_matches('.')
    } else {
        number
    }
}

#[cfg(test)]
mod tests {
    use super::super::targets::{DEPTH, HOST_TARGETS, KIND, host_target_spec};
    use super::*;

    #[test]
    fn the_depth_legend_names_nearest_and_farthest_at_the_ends() {
        // The ramp's bright end is the nearest.
        let legend = legend(host_target_spec(DEPTH).unwrap(), Some([12.5, 0.25]));
        let Scale::Ramp(stops) = legend.scale else {
            panic!("no ramp")
        };
        assert_eq!(stops[0].label, "12.5");
        assert_eq!(stops.last().unwrap().label, "0.25");
        assert!(legend.title.contains("scene units"), "{}", legend.title);
    }

    #[test]
    fn kinds_are_told_apart_by_name_and_colour() {
        let legend = legend(host_target_spec(KIND).unwrap(), None);
        let Scale::Categories(entries) = legend.scale else {
            panic!("no categories")
        };
        let labels: Vec<&str> = entries.iter().map(|entry| entry.label.as_str()).collect();
        assert_eq!(labels, ["surfels", "triangles", "lines"]);
    }

    #[test]
    fn every_host_target_has_a_titled_legend_without_a_range() {
        for spec in &HOST_TARGETS {
            let legend = legend(spec, None);
            assert!(legend.title.starts_with(&*spec.key), "{}", legend.title);
        }
    }

    #[test]
    fn labels_are_short_at_every_magnitude() {
        for (value, text) in [
            (0.0, "0"),
            (1.0, "1"),
            (-0.125, "-0.125"),
            (1234.5, "1234"),
            (123_456.0, "123456"),
            (3.0e9, "3.000e9"),
            (0.000_012_3, "1.230e-5"),
        ] {
            assert_eq!(number_label(value), text);
        }
    }
}
