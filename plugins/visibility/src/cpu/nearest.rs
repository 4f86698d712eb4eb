//! The nearest splat of each pixel.

use core::ops::Range;

/// Rows that a thread draws at a time. Its pixels and sums then fit into a core's own cache.
pub const BAND_ROWS: u32 = 16;

/// The nearest splat of each pixel, rows from the top: bits of its depth in the upper half, its id in the lower one; 0 where nothing
/// is. What is greater is nearer, and of equal depths the greatest id stays, as in the buffer of the compute path, which
/// [`Nearest::pixels`] fits byte for byte.
///
/// ```
/// use pointstage_visibility::cpu::Nearest;
///
/// let mut nearest = Nearest::default();
/// nearest.resize([4, 2]);
/// for mut band in nearest.bands() {
///     band.clear();
///     band.offer(3, 1, 0.5, 7);
///     band.offer(3, 1, 0.25, 8);
/// }
/// assert_eq!(nearest.id_at(3, 1), 7);
/// ```
#[derive(Clone, Debug, Default)]
pub struct Nearest {
    size_px: [u32; 2],
    pixels: Vec<u64>,
}

/// Some rows of [`Nearest`]: threads draw them side by side.
#[derive(Debug)]
pub struct NearestBand<'a> {
    /// Which band, from the top.
    pub number: usize,
    /// The rows.
    pub rows: Range<u32>,
    width: usize,
    pixels: &'a mut [u64],
}

impl Nearest {
    /// Gives the picture a size. What its pixels hold means nothing until the bands are cleared.
    pub fn resize(&mut self, size_px: [u32; 2]) {
        self.size_px = size_px;
        let [width, height] = size_px.map(|side| side as usize);
        self.pixels.resize(width * height, 0);
    }

    /// Columns and rows.
    pub fn size_px(&self) -> [u32; 2] {
        self.size_px
    }

    /// All pixels.
    pub fn pixels(&self) -> &[u64] {
        &self.pixels
    }

    /// The id at a pixel; 0 outside the picture, too.
    #[inline]
    pub fn id_at(&self, column: u32, row: u32) -> u32 {
        let place = row as usize * self.size_px[0] as usize + column as usize;
        self.pixels.get(place).map_or(0, |pixel| id_of(*pixel))
    }

    /// Number of bands.
    pub fn band_count(&self) -> usize {
        self.size_px[1].div_ceil(BAND_ROWS) as usize
    }

    /// All bands, from the top.
    pub fn bands(&mut self) -> impl Iterator<Item = NearestBand<'_>> + Send {
        let [width, height] = self.size_px;
        let pixels = (width * BAND_ROWS).max(1) as usize;
        self.pixels
            .chunks_mut(pixels)
            .zip((0..height).step_by(BAND_ROWS as usize))
            .enumerate()
            .map(move |(number, (pixels, first))| NearestBand {
                number,
                rows: first..(first + BAND_ROWS).min(height),
                width: width as usize,
                pixels,
            })
    }
}

impl NearestBand<'_> {
    /// Empties the pixels.
    pub fn clear(&mut self) {
        self.pixels.fill(0);
    }

    /// Pixels of a row in these columns; none outside the band.
    #[inline]
    pub fn pixels(&mut self, row: u32, columns: Range<u32>) -> Option<&mut [u64]> {
        let start = row.checked_sub(self.rows.start)? as usize * self.width;
        self.pixels
            .get_mut(start + columns.start as usize..start + columns.end as usize)
    }

    /// Columns.
    #[inline]
    pub fn width(&self) -> u32 {
        self.width as u32
    }

    /// Pixels of a row in these columns, to look at; none outside the band.
    #[inline]
    pub fn row(&self, row: u32, columns: Range<u32>) -> &[u64] {
        let start = row.saturating_sub(self.rows.start) as usize * self.width;
        self.pixels
            .get(start + columns.start as usize..start + columns.end as usize)
            .unwrap_or_default()
    }

    /// Offers a splat to a pixel; nothing happens outside the band.
    #[inline]
    pub fn offer(&mut self, column: u32, row: u32, depth: f32, id: u32) {
        let pixels = self.pixels(row, column..column + 1);
        if let Some([pixel]) = pixels {
            *pixel = (*pixel).max(packed(depth, id));
        }
    }
}

/// A pixel's number of a depth in 0..1 and an id.
#[inline]
pub fn packed(depth: f32, id: u32) -> u64 {
    u64::from(depth.to_bits()) << 32 | u64::from(id)
}

/// Its depth.
#[inline]
pub fn depth_of(pixel: u64) -> f32 {
    f32::from_bits((pixel >> 32) as u32)
}

/// Its id.
#[inline]
pub fn id_of(pixel: u64) -> u32 {
    pixel as u32
}
