//! Sums of what splats give to pixels.

use core::ops::Range;
use pointstage_plugin_api::glam::Vec4;

/// What splats gave a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sum {
    /// Weight times colour (linear), and weight.
    pub colour: Vec4,
    /// Weight times normal (view space), and the greatest coverage.
    pub normal: Vec4,
}

/// Sums of the pixels of one band: a thread keeps them in its cache, and passes on what comes of them before it takes the next
/// band.
#[derive(Clone, Debug, Default)]
pub struct Sums {
    rows: Range<u32>,
    width: usize,
    pixels: Vec<Sum>,
}

/// Beyond this weight nothing is added, so that a mean of very many stays a mean. The compute path, where the number comes
/// from, has no room for more.
pub const FULL: f32 = 45_776.0;

impl Sum {
    /// Adds a splat's share.
    ///
    /// * `colour`: linear RGB and 1; `normal`: view space and 0.
    #[inline]
    pub fn add(&mut self, weight: f32, coverage: f32, colour: Vec4, normal: Vec4) {
        if self.colour.w > FULL {
            return;
        }
        self.colour += colour * weight;
        let greatest = self.normal.w.max(coverage);
        self.normal += normal * weight;
        self.normal.w = greatest;
    }
}

impl Sums {
    /// Starts with nothing in these rows of a picture.
    pub fn start(&mut self, rows: Range<u32>, width: u32) {
        let count = rows.len() * width as usize;
        self.rows = rows;
        self.width = width as usize;
        self.pixels.clear();
        self.pixels.resize(count, Sum::default());
    }

    /// Sums of a row in these columns; none outside the band.
    #[inline]
    pub fn in_row(&mut self, row: u32, columns: Range<u32>) -> Option<&mut [Sum]> {
        let start = row.checked_sub(self.rows.start)? as usize * self.width;
        self.pixels
            .get_mut(start + columns.start as usize..start + columns.end as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_of_a_million_shares_stays_their_mean() {
        let mut sum = Sum::default();
        for number in 0..1_000_000_u32 {
            let colour = if number % 4 == 0 { Vec4::ONE } else { Vec4::W };
            sum.add(0.9, 1.0, colour, Vec4::ZERO);
        }
        let mean = sum.colour.x / sum.colour.w;
        assert!((mean - 0.25).abs() < 0.0025, "{mean}");
        assert!(sum.colour.w < FULL + 1.0);
    }
}
