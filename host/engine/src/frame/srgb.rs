//! 8-bit sRGB from linear light and back, by tables.

use std::sync::LazyLock;

/// Below 2⁻¹³ every value rounds to 0: 255 · 12.92 · 2⁻¹³ = 0.40.
const FIRST_EXPONENT_BITS: u32 = (127 - 13) << 23;
/// Octaves from 2⁻¹³ to 1.
const OCTAVES: usize = 13;
/// Bits of the mantissa that choose a bin. Near 1, where the curve is steepest against the exponent, 255 · 1.055 / 2.4
/// · 2⁻⁷ = 0.88 steps fall into a bin, so no bin holds two thresholds.
const MANTISSA_BITS: u32 = 7;

/// Where the 8-bit codes change.
struct Encoder {
    /// `thresholds[k]`: the least linear value that rounds to `k`.
    thresholds: [f32; 257],
    /// The code at each bin's lower end.
    codes: Vec<u8>,
}

static ENCODER: LazyLock<Encoder> = LazyLock::new(|| {
    let mut thresholds = [f32::INFINITY; 257];
    for (code, threshold) in thresholds.iter_mut().enumerate().take(256) {
        // f64, so that the nearest f32 decides and not the rounding of a power.
        *threshold = linear_from_srgb((code as f64 - 0.5) / 255.0) as f32;
    }
    let bins = OCTAVES << MANTISSA_BITS;
    let codes = (0..bins).map(|bin| {
        let lowest = f32::from_bits(FIRST_EXPONENT_BITS + ((bin as u32) << (23 - MANTISSA_BITS)));
        (thresholds.partition_point(|threshold| *threshold <= lowest) - 1) as u8
    });
    let codes = codes.collect();
    Encoder { thresholds, codes }
});

static DECODER: LazyLock<[f32; 256]> =
    LazyLock::new(|| core::array::from_fn(|code| linear_from_srgb(code as f64 / 255.0) as f32));

/// IEC 61966-2-1.
fn linear_from_srgb(srgb: f64) -> f64 {
    if srgb <= 0.04045 {
        srgb / 12.92
    } else {
        ((srgb + 0.055) / 1.055).powf(2.4)
    }
}

/// The nearest 8-bit sRGB code of linear light; NaN and what is below 0 give 0, what is above 1 gives 255.
#[inline]
pub(crate) fn srgb8_from_linear(linear: f32) -> u8 {
    let bits = linear.to_bits();
    let above_black = linear > f32::from_bits(FIRST_EXPONENT_BITS);
    if !above_black {
        return 0;
    }
    if linear >= 1.0 {
        return 255;
    }
    let Encoder { thresholds, codes } = &*ENCODER;
    let code = codes[((bits - FIRST_EXPONENT_BITS) >> (23 - MANTISSA_BITS)) as usize];
    code + u8::from(linear >= thresholds[usize::from(code) + 1])
}

/// Linear light of an 8-bit sRGB code.
#[inline]
pub(crate) fn linear_from_srgb8(code: u8) -> f32 {
    DECODER[usize::from(code)]
}

/// The nearest 8-bit code of a value in 0..1, without any curve; NaN gives 0.
#[inline]
pub(crate) fn unorm8(value: f32) -> u8 {
    // A cast of a float saturates, and takes NaN to 0.
    (value * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use pointstage_plugin_api::columns::srgb_from_linear;

    #[test]
    fn ends_and_middle_are_exact() {
        assert_eq!(srgb8_from_linear(0.0), 0);
        assert_eq!(srgb8_from_linear(1.0), 255);
        // sRGB of linear 0.5 is 0.735357: 187.52 of 255.
        assert_eq!(srgb8_from_linear(0.5), 188);
        // sRGB 0.5 is linear 0.214041: 127.5, the upper side of a step.
        assert_eq!(srgb8_from_linear(0.214_05), 128);
        assert_eq!(srgb8_from_linear(0.214_03), 127);
    }

    #[test]
    fn what_is_no_intensity_is_black_or_white() {
        for (value, code) in [
            (f32::NAN, 0),
            (-1.0, 0),
            (f32::NEG_INFINITY, 0),
            (f32::INFINITY, 255),
            (7.0, 255),
            (1e-40, 0),
        ] {
            assert_eq!(srgb8_from_linear(value), code, "{value}");
        }
    }

    #[test]
    fn the_table_gives_the_nearest_code_everywhere() {
        // Every 61st float of 0..1: 17 million are too many for each run, and no bin is skipped.
        for bits in (0..=1.0_f32.to_bits()).step_by(61) {
            let linear = f32::from_bits(bits);
            let exact = f64::from(srgb_from_linear(linear)) * 255.0;
            let error = (f64::from(srgb8_from_linear(linear)) - exact).abs();
            // Half a step, and the rounding of the single-precision power.
            assert!(error <= 0.5 + 2e-4, "{linear}: {error}");
        }
    }

    #[test]
    fn codes_survive_the_way_through_linear_light() {
        for code in 0..=255 {
            assert_eq!(srgb8_from_linear(linear_from_srgb8(code)), code);
        }
    }
}
