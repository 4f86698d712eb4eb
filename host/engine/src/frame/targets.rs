//! The target catalogue: which targets a frame may have, in which formats, cleared to what, meaning what.
//!
//! | key | GPU | CPU plane | clear | meaning |
//! |---|---|---|---|---|
//! | `colour` | rgba16float | f32×4 | 0 | linear light, premultiplied by coverage |
//! | `depth` | depth32float | f32 | 0 | reversed z, unshifted: 1 at the near plane, 0 where nothing is |
//! | `normal` | rgba16float | f32×4 | 0 | unit normal in view space, and 1 where there is one |
//! | `id` | r32uint | u32 | 0 | surfel id of the frame's id table, 0 where nothing is |
//! | `weight` | r16float | f32 | 0 | sum of the weights that were blended |
//! | `lod` | r8uint | u32 | 255 | level in the structure's tree, 0 the root, 255 where nothing is |
//! | `kind` | r8uint | u32 | 0 | 1 surfel, 2 triangle, 3 line, 0 where nothing is |
//! | `overdraw` | r16uint | u32 | 0 | how many splats or triangles touched the pixel |
//!
//! A plugin may declare more in its manifest; [`TargetSpec::declared`] checks them.

use std::borrow::Cow;

use pointstage_plugin_api::abi::Format;
use pointstage_plugin_api::manifest::TargetEntry;
pub use pointstage_plugin_api::targets::{
    COLOUR, DEPTH, ID, KIND, LOD, NO_LEVEL, NORMAL, OVERDRAW, WEIGHT, kind,
};

/// Everything that is the same for all frames about one target.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetSpec {
    /// The name that requests, plugins and files use.
    pub key: Cow<'static, str>,
    /// Format of the texture.
    pub format: Format,
    /// What every pixel holds before the frame; for formats of fewer components the first ones count.
    pub clear: [f64; 4],
    /// What a value means, one line for people.
    pub meaning: Cow<'static, str>,
    /// How the target is shown on the screen.
    pub appearance: Appearance,
}

/// How a target's values become colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Appearance {
    /// Premultiplied linear colours over the background.
    Colours,
    /// View-space directions: x, y, z from −1..1 to red, green, blue.
    Normals,
    /// Eye distance on a ramp between the nearest and the farthest point in view, the nearest brightest.
    Depth,
    /// A distinct colour for each number.
    Identities,
    /// Surfels, triangles, lines, each with its fixed colour.
    Kinds,
    /// A ramp from 0 to the greatest value in view.
    RampFromZero,
    /// A ramp from the least to the greatest value in view.
    Ramp,
}

/// What the values of a target are, once read by a shader or kept in a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PlaneFormat {
    /// Four floats a pixel.
    Float4,
    /// One float a pixel.
    Float,
    /// One unsigned number a pixel.
    Uint,
}

/// Why a declared target cannot be had.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TargetSpecError {
    /// An empty key, or one with characters that file names and command lines cannot take.
    #[error(
        "target '{0}': a key is 1 to 64 of the characters a-z, 0-9, '_', '-' and '.'; rename it in the manifest"
    )]
    BadKey(String),
    /// The host has a target of this name.
    #[error(
        "target '{0}' is one of the host's own; request it instead, or choose another key in the manifest"
    )]
    Reserved(String),
    /// The format is not one for targets.
    #[error(
        "target '{key}': {format:?} is no format for a declared target; use r8unorm, rgba8unorm, r16float, rg16float, \
         rgba16float, r32float, rgba32float, r8uint, r16uint or r32uint"
    )]
    UnsupportedFormat {
        /// The declared key.
        key: String,
        /// The declared format.
        format: Format,
    },
    /// A target of the plugin's own without a format, or with a name that means none.
    #[error(
        "target '{key}': '{written}' is no format for a declared target; write r8unorm, rgba8unorm, r16float, \
         rg16float, rgba16float, r32float, rgba32float, r8uint, r16uint or r32uint"
    )]
    UnknownFormat {
        /// The declared key.
        key: String,
        /// What the manifest says; empty if nothing.
        written: String,
    },
    /// The clear value does not fit the format.
    #[error(
        "target '{key}': the clear value {value} does not fit {format:?}; give a value that the format holds"
    )]
    BadClear {
        /// The declared key.
        key: String,
        /// The declared format.
        format: Format,
        /// The first component that does not fit.
        value: f64,
    },
}

const fn host_target(
    key: &'static str,
    format: Format,
    clear: f64,
    appearance: Appearance,
    meaning: &'static str,
) -> TargetSpec {
    TargetSpec {
        key: Cow::Borrowed(key),
        format,
        clear: [clear; 4],
        meaning: Cow::Borrowed(meaning),
        appearance,
    }
}

/// The host's own targets, in the order of the menu.
pub static HOST_TARGETS: [TargetSpec; 8] = [
    host_target(
        COLOUR,
        Format::RGBA16_FLOAT,
        0.0,
        Appearance::Colours,
        "linear light, premultiplied by coverage",
    ),
    host_target(
        DEPTH,
        Format::DEPTH32_FLOAT,
        0.0,
        Appearance::Depth,
        "distance from the eye",
    ),
    host_target(
        NORMAL,
        Format::RGBA16_FLOAT,
        0.0,
        Appearance::Normals,
        "unit normal in view space",
    ),
    host_target(
        ID,
        Format::R32_UINT,
        0.0,
        Appearance::Identities,
        "number of the surfel",
    ),
    host_target(
        WEIGHT,
        Format::R16_FLOAT,
        0.0,
        Appearance::RampFromZero,
        "sum of the blended weights",
    ),
    host_target(
        LOD,
        Format::R8_UINT,
        NO_LEVEL as f64,
        Appearance::RampFromZero,
        "level of detail, 0 the coarsest",
    ),
    host_target(
        KIND,
        Format::R8_UINT,
        0.0,
        Appearance::Kinds,
        "points against polygons",
    ),
    host_target(
        OVERDRAW,
        Format::R16_UINT,
        0.0,
        Appearance::RampFromZero,
        "splats or triangles that touched the pixel",
    ),
];

/// The host's target of this key.
pub fn host_target_spec(key: &str) -> Option<&'static TargetSpec> {
    HOST_TARGETS.iter().find(|spec| spec.key == key)
}

impl TargetSpec {
    /// A target of a plugin's own, from its manifest.
    ///
    /// Formats of several components are shown as colours, formats of one on a ramp.
    ///
    /// # Errors
    /// The key is not usable or the host's own; the format is not for targets; the clear value is not finite or does
    /// not fit the format.
    pub fn declared(
        key: &str,
        format: Format,
        clear: [f64; 4],
        meaning: &str,
    ) -> Result<Self, TargetSpecError> {
        let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "_-.".contains(c);
        if key.is_empty() || key.len() > 64 || !key.chars().all(plain) {
            return Err(TargetSpecError::BadKey(key.to_owned()));
        }
        if host_target_spec(key).is_some() {
            return Err(TargetSpecError::Reserved(key.to_owned()));
        }
        let Some((.., greatest)) = DECLARABLE.iter().find(|(_, known, _)| *known == format) else {
            return Err(TargetSpecError::UnsupportedFormat {
                key: key.to_owned(),
                format,
            });
        };
        let spec = Self {
            key: Cow::Owned(key.to_owned()),
            format,
            clear,
            meaning: Cow::Owned(meaning.to_owned()),
            appearance: Appearance::Ramp,
        };
        let plane = spec.plane_format();
        let components = if plane == PlaneFormat::Float4 { 4 } else { 1 };
        let fits = |value: &f64| {
            value.is_finite()
                && value.abs() <= *greatest
                && (plane != PlaneFormat::Uint || (*value >= 0.0 && value.fract() == 0.0))
        };
        if let Some(&value) = clear[..components].iter().find(|value| !fits(value)) {
            return Err(TargetSpecError::BadClear {
                key: key.to_owned(),
                format,
                value,
            });
        }
        Ok(match plane {
            PlaneFormat::Float4 => Self {
                appearance: Appearance::Colours,
                ..spec
            },
            _ => spec,
        })
    }

    /// The target that a renderer's manifest names: one of the host's, or one of the plugin's own.
    ///
    /// # Errors
    /// As [`declared`](Self::declared); and a format that is missing or unknown.
    pub fn from_manifest(entry: &TargetEntry) -> Result<Self, TargetSpecError> {
        let TargetEntry {
            key,
            format,
            clear,
            meaning,
        } = entry;
        if let (Some(spec), None) = (host_target_spec(key), format) {
            return Ok(spec.clone());
        }
        let written = format.as_deref().unwrap_or_default();
        let Some((_, format, _)) = DECLARABLE.iter().find(|(name, ..)| *name == written) else {
            return Err(TargetSpecError::UnknownFormat {
                key: key.clone(),
                written: written.to_owned(),
            });
        };
        Self::declared(key, *format, clear.unwrap_or_default(), meaning)
    }

    /// What the target's values are on the CPU.
    pub fn plane_format(&self) -> PlaneFormat {
        match self.format {
            Format::R8_UINT | Format::R16_UINT | Format::R32_UINT => PlaneFormat::Uint,
            Format::R8_UNORM | Format::R16_FLOAT | Format::R32_FLOAT | Format::DEPTH32_FLOAT => {
                PlaneFormat::Float
            }
            _ => PlaneFormat::Float4,
        }
    }

    /// The clear value of a target of numbers.
    pub(crate) fn clear_number(&self) -> u32 {
        self.clear[0] as u32
    }
}

impl PlaneFormat {
    /// Values a pixel.
    pub const fn channels(self) -> u32 {
        match self {
            Self::Float4 => 4,
            Self::Float | Self::Uint => 1,
        }
    }

    /// The format's name at the border.
    pub const fn abi(self) -> Format {
        match self {
            Self::Float4 => Format::RGBA32_FLOAT,
            Self::Float => Format::R32_FLOAT,
            Self::Uint => Format::R32_UINT,
        }
    }
}

/// Formats of declared targets: name in a manifest, number at the border, greatest clear value.
const DECLARABLE: [(&str, Format, f64); 10] = [
    ("r8unorm", Format::R8_UNORM, 1.0),
    ("rgba8unorm", Format::RGBA8_UNORM, 1.0),
    ("r16float", Format::R16_FLOAT, 65504.0),
    ("rg16float", Format::RG16_FLOAT, 65504.0),
    ("rgba16float", Format::RGBA16_FLOAT, 65504.0),
    ("r32float", Format::R32_FLOAT, f32::MAX as f64),
    ("rgba32float", Format::RGBA32_FLOAT, f32::MAX as f64),
    ("r8uint", Format::R8_UINT, 255.0),
    ("r16uint", Format::R16_UINT, 65535.0),
    ("r32uint", Format::R32_UINT, u32::MAX as f64),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_declared_target_gets_a_plane_and_an_appearance() {
        let spec = TargetSpec::declared("curvature", Format::R16_FLOAT, [-1.0; 4], "1/unit");
        let spec = spec.unwrap();
        assert_eq!(spec.plane_format(), PlaneFormat::Float);
        assert_eq!(spec.appearance, Appearance::Ramp);
        let colours = TargetSpec::declared("albedo", Format::RGBA8_UNORM, [0.0; 4], "").unwrap();
        assert_eq!(colours.appearance, Appearance::Colours);
    }

    #[test]
    fn what_a_declared_target_may_not_be_is_refused_by_name() {
        let declare = |key: &str, format, clear| TargetSpec::declared(key, format, [clear; 4], "");
        use TargetSpecError as E;
        assert!(matches!(
            declare("depth", Format::R32_FLOAT, 0.0),
            Err(E::Reserved(key)) if key == "depth"
        ));
        for key in ["", "a b", "../x", "Ä", &"k".repeat(65)] {
            let refused = declare(key, Format::R32_FLOAT, 0.0);
            assert!(matches!(refused, Err(E::BadKey(_))), "{key}");
        }
        for format in [Format::DEPTH32_FLOAT, Format::BGRA8_UNORM, Format(999)] {
            let refused = declare("x", format, 0.0);
            assert!(matches!(refused, Err(E::UnsupportedFormat { .. })));
        }
        for (format, clear) in [
            (Format::R8_UINT, 256.0),
            (Format::R8_UINT, -1.0),
            (Format::R8_UINT, 0.5),
            (Format::R16_FLOAT, 1e9),
            (Format::R32_FLOAT, f64::NAN),
        ] {
            let refused = declare("x", format, clear);
            assert!(matches!(refused, Err(E::BadClear { .. })), "{format:?}");
        }
    }

    #[test]
    fn a_manifest_names_host_targets_by_key_and_its_own_with_a_format() {
        let entry = |key: &str, format: Option<&str>| TargetEntry {
            key: key.to_owned(),
            format: format.map(str::to_owned),
            clear: None,
            meaning: String::new(),
        };
        let depth = TargetSpec::from_manifest(&entry(DEPTH, None)).unwrap();
        assert_eq!(Some(&depth), host_target_spec(DEPTH));
        let own = TargetSpec::from_manifest(&entry("curvature", Some("r32float"))).unwrap();
        assert_eq!((own.format, own.clear), (Format::R32_FLOAT, [0.0; 4]));
        let error = |key, format| TargetSpec::from_manifest(&entry(key, format)).unwrap_err();
        use TargetSpecError as E;
        assert!(matches!(error("curvature", None), E::UnknownFormat { .. }));
        assert!(matches!(
            error("curvature", Some("float")),
            E::UnknownFormat { .. }
        ));
        assert!(matches!(error(DEPTH, Some("r32float")), E::Reserved(_)));
    }

    #[test]
    fn every_host_target_has_a_key_of_its_own() {
        for (index, spec) in HOST_TARGETS.iter().enumerate() {
            let same = HOST_TARGETS.iter().position(|other| other.key == spec.key);
            assert_eq!(same, Some(index), "{}", spec.key);
            assert_eq!(host_target_spec(&spec.key), Some(spec));
        }
    }
}
