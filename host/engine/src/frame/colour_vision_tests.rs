//! Legends for people with any colour vision: the palettes, seen through a simulation of the three deficiencies.

use super::legend::{Scale, legend};
use super::palette::RAMP;
use super::targets::HOST_TARGETS;
use pointstage_plugin_api::columns::linear_from_srgb;

/// Linear sRGB as it is seen, row by row: Machado, Oliveira, Fernandes, *A Physiologically-based Model for Simulation of
/// Color Vision Deficiency*, IEEE TVCG 15(6), 2009, the table for severity 1.0.
const VISIONS: [(&str, [[f32; 3]; 3]); 4] = [
    ("full", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
    (
        "protanopia",
        [
            [0.152_286, 1.052_583, -0.204_868],
            [0.114_503, 0.786_281, 0.099_216],
            [-0.003_882, -0.048_116, 1.051_998],
        ],
    ),
    (
        "deuteranopia",
        [
            [0.367_322, 0.860_646, -0.227_968],
            [0.280_085, 0.672_501, 0.047_413],
            [-0.011_820, 0.042_940, 0.968_881],
        ],
    ),
    (
        "tritanopia",
        [
            [1.255_528, -0.076_749, -0.178_779],
            [-0.078_411, 0.930_809, 0.147_602],
            [0.004_733, 0.691_367, 0.303_900],
        ],
    ),
];

/// Least distance of two categories, ΔE*ab: over six just noticeable differences (2.3 each).
const LEAST_DISTANCE: f32 = 15.0;

/// Least rise of lightness from one stop of the ramp to the next, L*: two just noticeable differences.
const LEAST_RISE: f32 = 4.6;

fn product(matrix: &[[f32; 3]; 3], vector: [f32; 3]) -> [f32; 3] {
    matrix.map(|row| row[0] * vector[0] + row[1] * vector[1] + row[2] * vector[2])
}

/// CIE 1976 L*a*b* (white D65) of an 8-bit sRGB colour as a vision sees it.
fn lab(colour: [u8; 3], vision: &[[f32; 3]; 3]) -> [f32; 3] {
    // IEC 61966-2-1.
    const XYZ_FROM_LINEAR: [[f32; 3]; 3] = [
        [0.412_456, 0.357_576, 0.180_437],
        [0.212_673, 0.715_152, 0.072_175],
        [0.019_334, 0.119_192, 0.950_304],
    ];
    const WHITE: [f32; 3] = [0.950_47, 1.0, 1.088_83];
    let linear = colour.map(|byte| linear_from_srgb(f32::from(byte) / 255.0));
    let seen = product(vision, linear).map(|channel| channel.clamp(0.0, 1.0));
    let xyz = product(&XYZ_FROM_LINEAR, seen);
    let [x, y, z] = core::array::from_fn(|axis| {
        let ratio = xyz[axis] / WHITE[axis];
        // (6/29)³ and (29/3)³/116: where the cube root becomes a line.
        if ratio > 0.008_856 {
            ratio.cbrt()
        } else {
            7.787_037 * ratio + 16.0 / 116.0
        }
    });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    let squares = (0..3).map(|axis| (a[axis] - b[axis]).powi(2));
    squares.sum::<f32>().sqrt()
}

#[test]
fn the_categories_of_every_legend_stay_apart_for_any_colour_vision() {
    for spec in &HOST_TARGETS {
        let Scale::Categories(categories) = legend(spec, None).scale else {
            continue;
        };
        for (name, vision) in &VISIONS {
            for (index, a) in categories.iter().enumerate() {
                for b in &categories[..index] {
                    let apart = distance(lab(a.colour, vision), lab(b.colour, vision));
                    assert!(
                        apart >= LEAST_DISTANCE,
                        "{}: '{}' and '{}' are ΔE {apart:.1} apart with {name} vision",
                        spec.key,
                        a.label,
                        b.label
                    );
                }
            }
        }
    }
}

#[test]
fn the_ramp_rises_in_lightness_for_any_colour_vision() {
    for (name, vision) in &VISIONS {
        let lightness = RAMP.map(|colour| lab(colour, vision)[0]);
        let rises = lightness.windows(2).map(|pair| pair[1] - pair[0]);
        let least = rises.fold(f32::INFINITY, f32::min);
        assert!(least >= LEAST_RISE, "{name}: {lightness:?}");
    }
}

#[test]
fn red_and_green_that_people_confuse_are_found_out() {
    // The check can fail: two colours of equal lightness that differ along the confused axis alone.
    let (_, deuteranopia) = &VISIONS[2];
    let (_, full) = &VISIONS[0];
    let (red, green) = ([190, 90, 60], [110, 125, 40]);
    let apart = |vision| distance(lab(red, vision), lab(green, vision));
    assert!(
        apart(full) > 40.0 && apart(deuteranopia) < LEAST_DISTANCE,
        "{} {}",
        apart(full),
        apart(deuteranopia)
    );
}
