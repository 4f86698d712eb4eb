//! Composition on the CPU: the twin of `shaders/compose`, function by function, for sessions without a device and as the
//! shaders' oracle.

use std::sync::Arc;

use glam::{Vec3, Vec4};
use pointstage_plugin_api::columns::linear_from_srgb;
use rayon::prelude::*;

use super::composition::{Composed, Composition, positive};
use super::cpu_targets::{CpuTargets, PlaneValues, pixel_count};
use super::depth::distance_with;
use super::palette::{KINDS, identity_colour, ramp_colour};
use super::picture::Picture;
use super::srgb::{srgb8_from_linear, unorm8};
use super::targets::Appearance;

/// Bytes of a pixel: red, green, blue, alpha.
type Rgba = [u8; 4];

/// Composes a picture from planes.
///
/// `None` if the shown target is not among the planes.
pub fn compose(targets: &CpuTargets, composition: &Composition) -> Option<Composed> {
    let [width, height] = targets.size_px();
    let plane = targets.get(&composition.shown.key)?;
    let channels = composition.shown.plane_format().channels() as usize;
    let range = match &plane.values {
        PlaneValues::Float(values) => range_of_floats(values, composition),
        PlaneValues::Uint(values) => range_of_numbers(values, composition),
    };
    let range = range.map(|[least, greatest]| composition.ramp_ends(least, greatest));
    let range = composition.given_ends().or(range);

    let mut rgba = vec![0; pixel_count([width, height]) * 4];
    let row_length = (width as usize).max(1);
    let rows = rgba.par_chunks_mut(row_length * 4).enumerate();
    match &plane.values {
        PlaneValues::Float(values) => rows.for_each(|(y, row)| {
            let behind = Behind::of_row(composition, y);
            let values = &values[y * row_length * channels..][..row_length * channels];
            let pixels = row.as_chunks_mut::<4>().0.iter_mut();
            for (pixel, value) in pixels.zip(values.chunks_exact(channels)) {
                *pixel = show_float(value, composition, range, &behind);
            }
        }),
        PlaneValues::Uint(values) => rows.for_each(|(y, row)| {
            let behind = Behind::of_row(composition, y);
            let values = &values[y * row_length..][..row_length];
            for (pixel, number) in row.as_chunks_mut::<4>().0.iter_mut().zip(values) {
                *pixel = show_number(*number, composition, range, &behind);
            }
        }),
    }
    Some(Composed {
        picture: Picture {
            size_px: [width, height],
            rgba: Arc::from(rgba),
        },
        range,
    })
}

/// The background in one row.
pub(super) struct Behind {
    opaque: bool,
    linear: Vec3,
    pub(super) bytes: Rgba,
}

impl Behind {
    pub(super) fn of_row(composition: &Composition, y: usize) -> Self {
        let (top, bottom, opaque) = composition.background_edges();
        let row_centre = composition.tile_origin_y_px + y as f32 + 0.5;
        let position = (row_centre / composition.image_height_px).clamp(0.0, 1.0);
        let [top, bottom] = [top, bottom].map(Vec3::from_array);
        // Interpolated as it looks, in sRGB, and not as light.
        let srgb = top + (bottom - top) * position;
        Self {
            opaque,
            linear: srgb.map(linear_from_srgb),
            bytes: if opaque { opaque_bytes(srgb) } else { [0; 4] },
        }
    }
}

fn opaque_bytes(srgb: Vec3) -> Rgba {
    [unorm8(srgb.x), unorm8(srgb.y), unorm8(srgb.z), 255]
}

/// Least and greatest of the values that are finite and not 'nothing'.
fn range_of_floats(values: &[f32], composition: &Composition) -> Option<[f32; 2]> {
    if !composition.needs_range() {
        return None;
    }
    let counted = |value: &&f32| value.is_finite() && is_drawn(**value, composition);
    values
        .par_iter()
        .filter(counted)
        .map(|value| [*value; 2])
        .reduce_with(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
}

fn range_of_numbers(values: &[u32], composition: &Composition) -> Option<[f32; 2]> {
    if !composition.needs_range() {
        return None;
    }
    let clear = composition.shown.clear_number();
    let range = values
        .par_iter()
        .filter(|number| **number != clear)
        .map(|number| [*number; 2])
        .reduce_with(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    range.map(|ends| ends.map(|number| number as f32))
}

/// Whether something was drawn where a float target has this value; NaN is nothing.
fn is_drawn(value: f32, composition: &Composition) -> bool {
    if composition.shown.appearance == Appearance::Depth {
        return value > 0.0;
    }
    let from_clear = (value - composition.shown.clear[0] as f32).abs();
    from_clear > composition.clear_tolerance()
}

/// The pixel of a target of floats.
fn show_float(
    value: &[f32],
    composition: &Composition,
    range: Option<[f32; 2]>,
    behind: &Behind,
) -> Rgba {
    let appearance = composition.shown.appearance;
    match *value {
        [x, y, z, _] if appearance == Appearance::Normals => {
            show_normal(Vec3::new(x, y, z), behind)
        }
        [r, g, b, a] => over_background(Vec4::new(r, g, b, a), composition.exposure, behind),
        [value, ..] if is_drawn(value, composition) => {
            let shown = match appearance {
                Appearance::Depth => distance_with(value, composition.distance_terms()),
                _ => value,
            };
            on_ramp(shown, range, behind)
        }
        _ => behind.bytes,
    }
}

/// The pixel of a target of numbers.
fn show_number(
    number: u32,
    composition: &Composition,
    range: Option<[f32; 2]>,
    behind: &Behind,
) -> Rgba {
    if number == composition.shown.clear_number() {
        return behind.bytes;
    }
    match composition.shown.appearance {
        Appearance::Identities => opaque_bytes(Vec3::from_array(identity_colour(number))),
        Appearance::Kinds => {
            let [r, g, b] = KINDS[(number as usize).min(KINDS.len() - 1)];
            [r, g, b, 255]
        }
        _ => on_ramp(number as f32, range, behind),
    }
}

/// Premultiplied linear light over the background, as sRGB.
pub(super) fn over_background(colour: Vec4, exposure: f32, behind: &Behind) -> Rgba {
    let alpha = positive(colour.w).min(1.0);
    let light = (colour.truncate() * exposure).map(positive);
    if alpha == 0.0 && light == Vec3::ZERO {
        return behind.bytes;
    }
    let (light, alpha_byte) = if behind.opaque {
        (light + behind.linear * (1.0 - alpha), 255)
    } else if alpha > 0.0 {
        (light / alpha, unorm8(alpha))
    } else {
        return [0; 4];
    };
    let [r, g, b] = light.to_array().map(srgb8_from_linear);
    [r, g, b, alpha_byte]
}

/// A direction as a colour: −1..1 to 0..1.
fn show_normal(normal: Vec3, behind: &Behind) -> Rgba {
    let length_squared = normal.length_squared();
    if !(length_squared > 0.0 && length_squared.is_finite()) {
        return behind.bytes;
    }
    opaque_bytes(normal / length_squared.sqrt() * 0.5 + 0.5)
}

/// The ramp's colour of a value.
fn on_ramp(value: f32, range: Option<[f32; 2]>, behind: &Behind) -> Rgba {
    match range {
        Some([dark, bright]) => {
            let position = if bright == dark {
                0.0
            } else {
                (value - dark) / (bright - dark)
            };
            opaque_bytes(Vec3::from_array(ramp_colour(position)))
        }
        None => behind.bytes,
    }
}

#[cfg(test)]
mod tests {
    use super::super::picture::Background;
    use super::super::targets::{COLOUR, DEPTH, HOST_TARGETS, KIND, LOD, NORMAL, host_target_spec};
    use super::*;
    use glam::Mat4;
    use pointstage_scene::Camera;

    fn show(key: &str, background: Background) -> Composition {
        Composition {
            shown: host_target_spec(key).unwrap().clone(),
            background,
            exposure: 1.0,
            clip_from_view: Camera::default().clip_from_view(1.0).as_mat4(),
            tile_origin_y_px: 0.0,
            image_height_px: 2.0,
            ramp_range: None,
        }
    }

    /// One pixel of `key` with these values.
    fn pixel_of(values: &[f32], composition: &Composition) -> Rgba {
        let mut targets = CpuTargets::new([1, 1], &HOST_TARGETS);
        for plane in targets.planes_mut() {
            if plane.spec.key == composition.shown.key {
                match &mut plane.values {
                    PlaneValues::Float(plane) => plane.copy_from_slice(values),
                    PlaneValues::Uint(plane) => plane[0] = values[0] as u32,
                }
            }
        }
        let composed = compose(&targets, composition).unwrap();
        composed.picture.rgba[..].try_into().unwrap()
    }

    #[test]
    fn an_opaque_pixel_is_its_srgb_whatever_lies_behind() {
        for background in [
            Background::Transparent,
            Background::Solid([1.0, 0.0, 0.0]),
            Background::Gradient([0.0; 3], [1.0; 3]),
        ] {
            let pixel = pixel_of(&[0.0, 0.5, 1.0, 1.0], &show(COLOUR, background));
            assert_eq!(pixel, [0, 188, 255, 255], "{background:?}");
        }
    }

    #[test]
    fn a_transparent_background_keeps_straight_alpha() {
        let pixel = pixel_of(
            &[0.25, 0.0, 0.5, 0.5],
            &show(COLOUR, Background::Transparent),
        );
        assert_eq!(pixel, [188, 0, 255, 128]);
        let empty = pixel_of(&[0.0; 4], &show(COLOUR, Background::Transparent));
        assert_eq!(empty, [0; 4]);
    }

    #[test]
    fn half_coverage_mixes_light_and_not_codes() {
        let pixel = pixel_of(
            &[0.5, 0.5, 0.5, 0.5],
            &show(COLOUR, Background::Solid([0.0; 3])),
        );
        assert_eq!(pixel, [188, 188, 188, 255]);
    }

    #[test]
    fn an_untouched_pixel_is_the_background_to_the_byte() {
        for byte in 0..=255_u8 {
            let grey = Background::Solid([f32::from(byte) / 255.0; 3]);
            assert_eq!(
                pixel_of(&[0.0; 4], &show(COLOUR, grey)),
                [byte, byte, byte, 255]
            );
        }
    }

    #[test]
    fn exposure_scales_the_objects_and_not_the_background() {
        let composition = Composition {
            exposure: 2.0,
            ..show(COLOUR, Background::Solid([0.2; 3]))
        };
        assert_eq!(
            pixel_of(&[0.25, 0.25, 0.25, 1.0], &composition),
            [188, 188, 188, 255]
        );
        assert_eq!(pixel_of(&[0.0; 4], &composition), [51, 51, 51, 255]);
    }

    #[test]
    fn nan_and_infinity_end_in_some_colour() {
        let composition = show(COLOUR, Background::Solid([0.0; 3]));
        let pixel = pixel_of(&[f32::NAN, f32::INFINITY, -1.0, f32::NAN], &composition);
        assert_eq!(pixel, [0, 255, 0, 255]);
    }

    #[test]
    fn gradients_run_over_the_whole_image_and_not_the_tile() {
        let targets = CpuTargets::new([1, 2], &HOST_TARGETS[..1]);
        let gradient = Background::Gradient([0.0; 3], [1.0; 3]);
        let rows = |tile_origin_y_px| {
            let composition = Composition {
                tile_origin_y_px,
                image_height_px: 4.0,
                ..show(COLOUR, gradient)
            };
            let rgba = compose(&targets, &composition).unwrap().picture.rgba;
            [rgba[0], rgba[4]]
        };
        // Row centres at 1/8, 3/8, 5/8 and 7/8 of 255.
        assert_eq!([rows(0.0), rows(2.0)], [[32, 96], [159, 223]]);
    }

    #[test]
    fn a_normal_towards_the_eye_is_blue_and_none_is_background() {
        let composition = show(NORMAL, Background::Solid([0.0; 3]));
        assert_eq!(
            pixel_of(&[0.0, 0.0, 2.0, 0.0], &composition),
            [128, 128, 255, 255]
        );
        assert_eq!(pixel_of(&[0.0; 4], &composition), [0, 0, 0, 255]);
    }

    #[test]
    fn the_nearest_is_bright_and_the_farthest_dark() {
        let mut targets = CpuTargets::new([3, 1], &HOST_TARGETS);
        let depth = targets
            .planes_mut()
            .iter_mut()
            .find(|plane| plane.spec.key == DEPTH);
        depth.unwrap().values = PlaneValues::Float(vec![0.003, 0.0, 0.001]);
        let composition = show(DEPTH, Background::Transparent);
        let Composed { picture, range } = compose(&targets, &composition).unwrap();
        assert_eq!(picture.rgba[..3], [0xfd, 0xe7, 0x25]);
        assert_eq!(picture.rgba[4..8], [0; 4]);
        assert_eq!(picture.rgba[8..11], [0x44, 0x01, 0x54]);
        // near = 0.003: distance = near / depth.
        let [far, near] = range.unwrap();
        assert!(
            (far - 3.0).abs() < 1e-5 && (near - 1.0).abs() < 1e-5,
            "{far} {near}"
        );
    }

    #[test]
    fn a_given_range_holds_whatever_is_in_view() {
        let mut composition = show(LOD, Background::Transparent);
        let found = pixel_of(&[4.0], &composition);
        composition.ramp_range = Some([0.0, 8.0]);
        let given = pixel_of(&[4.0], &composition);
        assert_ne!(found, given, "the only value in view is at an end");
        let [r, g, b] = ramp_colour(0.5).map(unorm8);
        assert_eq!(given, [r, g, b, 255]);
    }

    #[test]
    fn the_root_level_is_something_and_no_level_is_nothing() {
        let composition = show(LOD, Background::Transparent);
        assert_eq!(pixel_of(&[0.0], &composition)[3], 255);
        assert_eq!(pixel_of(&[255.0], &composition)[3], 0);
    }

    #[test]
    fn kinds_have_their_palette_colours() {
        let composition = show(KIND, Background::Transparent);
        assert_eq!(pixel_of(&[1.0], &composition), [214, 39, 40, 255]);
        assert_eq!(pixel_of(&[2.0], &composition), [0, 114, 178, 255]);
        assert_eq!(pixel_of(&[200.0], &composition), [204, 121, 167, 255]);
    }

    #[test]
    fn a_target_that_was_not_drawn_gives_no_picture() {
        let targets = CpuTargets::new([1, 1], &HOST_TARGETS[..1]);
        assert_eq!(
            compose(&targets, &show(KIND, Background::Transparent)),
            None
        );
    }

    #[test]
    fn pictures_of_no_size_are_empty() {
        let targets = CpuTargets::new([0, 5], &HOST_TARGETS[..1]);
        let composition = Composition {
            clip_from_view: Mat4::IDENTITY,
            ..show(COLOUR, Background::Transparent)
        };
        assert!(
            compose(&targets, &composition)
                .unwrap()
                .picture
                .rgba
                .is_empty()
        );
    }
}
