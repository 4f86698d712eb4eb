//! Values of options, parsed: each error says what was expected.

use std::path::PathBuf;

use pointstage_engine::stage::{Background, LARGEST_IMAGE_PX};

use crate::output::export::Format;

/// `WxH` in pixels.
pub(crate) fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(['x', 'X', '×']);
    let parsed = sides.and_then(|(width, height)| {
        Some([width.trim().parse().ok()?, height.trim().parse().ok()?])
    });
    match parsed {
        Some(sides)
            if sides
                .iter()
                .all(|side| (1..=LARGEST_IMAGE_PX).contains(side)) =>
        {
            Ok(sides)
        }
        Some(_) => Err(format!(
            "each side must be from 1 to {LARGEST_IMAGE_PX} pixels"
        )),
        None => Err("expected WIDTHxHEIGHT in pixels, such as 1280x720".to_owned()),
    }
}

/// `id=value`.
pub(crate) fn assignment(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((id, value)) if !id.trim().is_empty() => Ok((id.trim().to_owned(), value.to_owned())),
        _ => Err("expected id=value, such as splat_scale=1.5".to_owned()),
    }
}

/// A target and the file that it goes to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct AovFile {
    /// The target's key.
    pub(crate) key: String,
    /// Where it goes.
    pub(crate) path: PathBuf,
    /// In which form.
    pub(crate) format: AovFormat,
}

/// Form of a target's file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AovFormat {
    /// The values.
    Exr,
    /// Colours as the legend shows them.
    Png,
}

/// `key=file.exr` or `key=file.png`.
pub(crate) fn aov(text: &str) -> Result<AovFile, String> {
    let (key, path) = assignment(text)
        .map_err(|_| "expected key=file.exr or key=file.png, such as depth=depth.exr".to_owned())?;
    let path = PathBuf::from(path);
    let extension = path
        .extension()
        .map(|extension| extension.to_string_lossy().to_lowercase());
    let format = match extension.as_deref() {
        Some("exr") => AovFormat::Exr,
        Some("png") => AovFormat::Png,
        _ => {
            return Err(
                "the file must end in .exr (the values) or .png (as the legend shows them)"
                    .to_owned(),
            );
        }
    };
    Ok(AovFile { key, path, format })
}

/// An image's file.
pub(crate) fn image_path(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match Format::of(&path) {
        Some(_) => Ok(path),
        None => Err(
            "the name must end in .png (the picture) or .exr (the values of all targets)"
                .to_owned(),
        ),
    }
}

/// A factor above 0.
pub(crate) fn factor(text: &str) -> Result<f32, String> {
    match text.trim().parse::<f32>() {
        Ok(factor) if factor > 0.0 && factor.is_finite() => Ok(factor),
        _ => Err("expected a number above 0".to_owned()),
    }
}

/// `transparent`, `#rrggbb`, or `#rrggbb,#rrggbb` from top to bottom.
pub(crate) fn background(text: &str) -> Result<Background, String> {
    let form = || {
        "expected 'transparent', a colour '#rrggbb', or two from top to bottom '#rrggbb,#rrggbb'"
            .to_owned()
    };
    if text.eq_ignore_ascii_case("transparent") {
        return Ok(Background::Transparent);
    }
    let colours: Option<Vec<[f32; 3]>> = text.split(',').map(hex_colour).collect();
    match colours.as_deref() {
        Some([colour]) => Ok(Background::Solid(*colour)),
        Some([top, bottom]) => Ok(Background::Gradient(*top, *bottom)),
        _ => Err(form()),
    }
}

/// A background that hides what is behind: `#rrggbb`, or `#rrggbb,#rrggbb` from top to bottom.
pub(crate) fn opaque_background(text: &str) -> Result<Background, String> {
    let form = "expected a colour '#rrggbb', or two from top to bottom '#rrggbb,#rrggbb'";
    match background(text) {
        Ok(Background::Transparent) => Err(format!(
            "pictures are compared over one opaque background; {form}"
        )),
        Ok(background) => Ok(background),
        Err(_) => Err(form.to_owned()),
    }
}

/// `#rrggbb` as sRGB, 0..1.
fn hex_colour(text: &str) -> Option<[f32; 3]> {
    let digits = text.trim().trim_start_matches('#');
    if digits.len() != 6 || !digits.bytes().all(|byte| byte.is_ascii_hexdigit()) {
        return None;
    }
    let channel = |start: usize| {
        let byte = u8::from_str_radix(&digits[start..start + 2], 16).ok()?;
        Some(f32::from(byte) / 255.0)
    };
    Some([channel(0)?, channel(2)?, channel(4)?])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::record::background_text;

    #[test]
    fn sizes_are_two_sides_in_range() {
        assert_eq!(size("800x600"), Ok([800, 600]));
        for bad in [
            "800",
            "0x600",
            "800x",
            "-1x5",
            "800x600x3",
            "99999x1",
            "axb",
        ] {
            assert!(size(bad).is_err(), "{bad} was taken");
        }
    }

    #[test]
    fn assignments_split_at_the_first_equals_sign() {
        assert_eq!(assignment("a=b=c"), Ok(("a".into(), "b=c".into())));
        assert_eq!(assignment("a="), Ok(("a".into(), String::new())));
        assert!(assignment("=b").is_err() && assignment("ab").is_err());
    }

    #[test]
    fn targets_go_to_exr_or_png() {
        assert_eq!(aov("depth=a.EXR").map(|aov| aov.format), Ok(AovFormat::Exr));
        assert_eq!(aov("lod=a.png").map(|aov| aov.format), Ok(AovFormat::Png));
        assert!(aov("depth=a.tif").is_err() && aov("depth").is_err());
    }

    #[test]
    fn backgrounds_round_trip() {
        for text in ["transparent", "#102030", "#ffffff,#000000"] {
            assert_eq!(background(text).map(background_text).as_deref(), Ok(text));
        }
        for bad in ["red", "#12345", "#1,#2", "#ééé", "#000000,#000000,#000000"] {
            assert!(background(bad).is_err(), "{bad} was taken");
        }
    }

    #[test]
    fn an_opaque_background_is_a_colour_or_two() {
        assert_eq!(
            opaque_background("#ffffff").map(background_text).as_deref(),
            Ok("#ffffff")
        );
        let error = opaque_background("transparent").expect_err("not opaque");
        assert!(
            error.contains("opaque") && error.contains("#rrggbb"),
            "{error}"
        );
        assert!(opaque_background("red").is_err());
    }

    #[test]
    fn factors_are_above_zero() {
        assert_eq!(factor("0.5"), Ok(0.5));
        for bad in ["0", "-1", "NaN", "inf", "x"] {
            assert!(factor(bad).is_err(), "{bad} was taken");
        }
    }
}
