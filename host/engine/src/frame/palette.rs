//! Colours that stand for numbers and kinds, chosen so that people with any colour vision can tell them apart.
//!
//! Both twins of the composition take their colours from here: the shaders get the tables in their uniform.

/// Ten evenly spaced colours of *viridis*, dark to bright, 8-bit sRGB; between them colours are interpolated in sRGB.
///
/// Viridis is perceptually uniform, also in grey and for all common colour vision deficiencies: Smith and van der Walt,
/// *A Better Default Colormap for Matplotlib*, SciPy 2015; the map is in the public domain (CC0).
pub(crate) const RAMP: [[u8; 3]; 10] = [
    [0x44, 0x01, 0x54],
    [0x48, 0x28, 0x78],
    [0x3e, 0x49, 0x89],
    [0x31, 0x68, 0x8e],
    [0x26, 0x82, 0x8e],
    [0x1f, 0x9e, 0x89],
    [0x35, 0xb7, 0x79],
    [0x6e, 0xce, 0x58],
    [0xb5, 0xde, 0x2b],
    [0xfd, 0xe7, 0x25],
];

/// Colours of the `kind` target by value, 8-bit sRGB: nothing (never shown), surfel, triangle, line, anything else.
///
/// Red splats and blue triangles, as in the pictures of POP (Chen and Nguyen 2001); blue, bluish green and reddish purple are
/// those of Okabe and Ito, *Color Universal Design*, 2002.
pub(crate) const KINDS: [[u8; 3]; 5] = [
    [0, 0, 0],
    [214, 39, 40],
    [0, 114, 178],
    [0, 158, 115],
    [204, 121, 167],
];

/// Names of [`KINDS`].
pub(crate) const KIND_NAMES: [&str; 5] = ["nothing", "surfels", "triangles", "lines", "other"];

/// Colour of the ramp at `position` (0 dark … 1 bright; beyond is clamped), sRGB, 0..1.
pub(crate) fn ramp_colour(position: f32) -> [f32; 3] {
    let scaled = position.clamp(0.0, 1.0) * (RAMP.len() - 1) as f32;
    // NaN is left at 0 by the cast.
    let below = (scaled as usize).min(RAMP.len() - 2);
    let fraction = scaled - below as f32;
    core::array::from_fn(|channel| {
        let [low, high] = [below, below + 1].map(|stop| f32::from(RAMP[stop][channel]) / 255.0);
        low + (high - low) * fraction
    })
}

/// A colour for a number, the same for the same number and far from that of its neighbours, sRGB, 0..1.
///
/// The three bytes of a PCG hash (Jarzynski and Olano, *Hash Functions for GPU Rendering*, JCGT 2020), lifted to 0.25..1
/// so that no number is black.
pub(crate) fn identity_colour(number: u32) -> [f32; 3] {
    let state = number.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    let hash = (word >> 22) ^ word;
    core::array::from_fn(|channel| {
        let byte = (hash >> (8 * channel)) & 255;
        0.25 + 0.75 * (byte as f32 / 255.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance of linear sRGB primaries (IEC 61966-2-1).
    fn luminance(srgb: [f32; 3]) -> f32 {
        let [r, g, b] = srgb.map(pointstage_plugin_api::columns::linear_from_srgb);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    #[test]
    fn the_ramp_gets_brighter_all_the_way() {
        let luminances = (0..=100).map(|step| luminance(ramp_colour(step as f32 / 100.0)));
        let luminances: Vec<f32> = luminances.collect();
        assert!(luminances.is_sorted_by(|a, b| a < b), "{luminances:?}");
    }

    #[test]
    fn the_ramp_ends_in_its_first_and_last_colour() {
        for (position, stop) in [(-3.0, 0), (0.0, 0), (1.0, 9), (f32::INFINITY, 9)] {
            let expected = RAMP[stop].map(|byte| f32::from(byte) / 255.0);
            assert_eq!(ramp_colour(position), expected, "{position}");
        }
    }

    #[test]
    fn neighbouring_numbers_get_distant_colours() {
        let distance = |number: u32| {
            let [a, b] = [number, number + 1].map(identity_colour);
            (0..3).map(|i| (a[i] - b[i]).abs()).sum::<f32>()
        };
        let mean = (1..1000).map(distance).sum::<f32>() / 999.0;
        // Independent bytes differ by a third of their range on average: 3 · 0.75 / 3.
        assert!((mean - 0.75).abs() < 0.05, "mean distance {mean}");
    }
}
