//! From samples to pixels.

use pointstage_plugin_api::glam::DVec4;

use crate::settings::SampleFilter;
use crate::tile::{Region, Shaded};

/// Deviation of the Gaussian average, px.
const DEVIATION_PX: f64 = 0.5;
/// Where it ends, px.
const REACH_PX: f64 = 1.25;

/// How far beyond a tile's pixels its samples have to reach, samples.
pub(crate) fn margin(filter: SampleFilter, samples: u32) -> i32 {
    match filter {
        SampleFilter::Box => 0,
        // From a pixel's centre less the half pixel that belongs to the tile.
        SampleFilter::Gaussian => ((REACH_PX - 0.5) * f64::from(samples)).ceil() as i32,
    }
}

/// Weight of each sample along one axis for the pixel that starts at `first`; they sum to 1.
fn weights(filter: SampleFilter, samples: u32) -> (i32, Vec<f64>) {
    let margin = margin(filter, samples);
    let count = samples as i32;
    let centre = f64::from(count) / 2.0;
    let weight = |place: i32| {
        let distance_px = (f64::from(place) + 0.5 - centre) / f64::from(count);
        match filter {
            SampleFilter::Box => 1.0,
            SampleFilter::Gaussian if distance_px.abs() <= REACH_PX => {
                (-0.5 * (distance_px / DEVIATION_PX).powi(2)).exp()
            }
            SampleFilter::Gaussian => 0.0,
        }
    };
    let weights: Vec<f64> = (-margin..count + margin).map(weight).collect();
    let sum: f64 = weights.iter().sum();
    (
        margin,
        weights.into_iter().map(|weight| weight / sum).collect(),
    )
}

/// Mean colour of each pixel of a tile, row by row.
///
/// * `region`: the samples of the tile's pixels, without margin; `shaded` has the margin.
pub(crate) fn average(
    filter: SampleFilter,
    samples: u32,
    region: Region,
    shaded: &[Shaded],
) -> Vec<DVec4> {
    let (margin, weights) = weights(filter, samples);
    let stride = (region.width + 2 * margin) as usize;
    let samples = samples as usize;
    let (columns, rows) = (
        region.width as usize / samples,
        region.height as usize / samples,
    );
    let mut pixels = Vec::with_capacity(columns * rows);
    for row in 0..rows {
        for column in 0..columns {
            let mut sum = DVec4::ZERO;
            for (y, across) in weights.iter().enumerate() {
                let start = (row * samples + y) * stride + column * samples;
                let line = &shaded[start..start + weights.len()];
                let mean: DVec4 = line
                    .iter()
                    .zip(&weights)
                    .map(|(sample, weight)| sample.colour * *weight)
                    .sum();
                sum += mean * *across;
            }
            pixels.push(sum);
        }
    }
    pixels
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_sum_to_one_and_are_even() {
        for filter in [SampleFilter::Box, SampleFilter::Gaussian] {
            for samples in [1, 2, 3, 4, 7] {
                let (margin, weights) = weights(filter, samples);
                assert_eq!(weights.len() as i32, samples as i32 + 2 * margin);
                assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
                let mirrored: Vec<f64> = weights.iter().rev().copied().collect();
                let pairs = weights.iter().zip(&mirrored);
                assert!(pairs.clone().all(|(a, b)| (a - b).abs() < 1e-12));
            }
        }
    }
}
