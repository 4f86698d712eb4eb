//! Which tiles an image is drawn in.

use pointstage_engine::stage::Tile;

/// Bytes that the targets of one tile may take, on the device and in memory together: room for most graphics cards.
const MOST_TILE_BYTES: u64 = 1 << 30;

/// Bytes that one band of rows may take until it is written.
const MOST_BAND_BYTES: u64 = 256 << 20;

/// Sides of tiles are multiples of this, px: whole blocks of textures and of compute passes.
const STEP_PX: u32 = 64;

/// An image cut into tiles, row by row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Tiling {
    image_px: [u32; 2],
    tile_px: [u32; 2],
}

/// One tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    /// Its upper left corner in the image, px.
    pub(super) origin_px: [u32; 2],
    /// px.
    pub(super) size_px: [u32; 2],
    /// Whether it ends a row of tiles.
    pub(super) ends_band: bool,
}

impl Tiling {
    /// Cuts an image.
    ///
    /// * `most_px`: the greatest side of a tile.
    /// * `pixel_bytes`: what a pixel of a tile takes while it is drawn and read back.
    pub(super) fn new(image_px: [u32; 2], most_px: u32, pixel_bytes: u64) -> Self {
        let [width, height] = image_px.map(|side| side.max(1));
        let by_memory = (MOST_TILE_BYTES / pixel_bytes.max(1)).isqrt();
        let by_memory = u32::try_from(by_memory).unwrap_or(u32::MAX);
        let side = stepped(most_px.min(by_memory));
        let rows = MOST_BAND_BYTES / (u64::from(width) * 4);
        let rows = stepped(u32::try_from(rows).unwrap_or(u32::MAX));
        Self {
            image_px: [width, height],
            tile_px: [side.min(width), side.min(rows).min(height)],
        }
    }

    /// Number of tiles.
    pub(super) fn count(&self) -> usize {
        let [across, down] = self.counts();
        across as usize * down as usize
    }

    /// A tile by its number, from the left to the right and then downwards; none beyond the last.
    pub(super) fn place(&self, number: usize) -> Option<Place> {
        let [across, down] = self.counts();
        let column = u32::try_from(number % across as usize).ok()?;
        let row = u32::try_from(number / across as usize).ok()?;
        if row >= down {
            return None;
        }
        let origin_px = [column * self.tile_px[0], row * self.tile_px[1]];
        let size = |axis: usize| self.tile_px[axis].min(self.image_px[axis] - origin_px[axis]);
        Some(Place {
            origin_px,
            size_px: [size(0), size(1)],
            ends_band: column + 1 == across,
        })
    }

    /// The tile's place for the stage; none if the tile is the whole image.
    pub(super) fn tile(&self, place: &Place) -> Option<Tile> {
        (self.count() > 1).then_some(Tile {
            origin_px: place.origin_px,
            image_size_px: self.image_px,
        })
    }

    fn counts(&self) -> [u32; 2] {
        [0, 1].map(|axis| self.image_px[axis].div_ceil(self.tile_px[axis]))
    }
}

/// The next smaller multiple of a step, or the value itself below one step.
fn stepped(side_px: u32) -> u32 {
    match side_px / STEP_PX * STEP_PX {
        0 => side_px.max(1),
        side => side,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_every_pixel_once_and_bands_end_at_the_right_edge() {
        for (image, most) in [
            ([1, 1], 4096),
            ([100, 70], 64),
            ([129, 64], 64),
            ([7, 300], 5),
        ] {
            let tiling = Tiling::new(image, most, 40);
            let mut hits = vec![0; (image[0] * image[1]) as usize];
            let mut bands = 0;
            for number in 0..tiling.count() {
                let place = tiling.place(number).expect("one of the tiles");
                let [left, top] = place.origin_px;
                let [width, height] = place.size_px;
                assert!(width <= most && height <= most);
                for y in top..top + height {
                    for x in left..left + width {
                        hits[(y * image[0] + x) as usize] += 1;
                    }
                }
                bands += u32::from(place.ends_band);
                assert_eq!(place.ends_band, left + width == image[0]);
            }
            assert!(hits.iter().all(|hits| *hits == 1), "{image:?} by {most}");
            assert_eq!(tiling.place(tiling.count()), None);
            assert_eq!(bands, tiling.counts()[1]);
        }
    }

    #[test]
    fn a_small_image_is_no_tile() {
        let tiling = Tiling::new([640, 480], 4096, 40);
        let place = tiling.place(0).expect("one tile");
        assert_eq!((tiling.count(), tiling.tile(&place)), (1, None));
        assert_eq!(place.size_px, [640, 480]);
    }

    #[test]
    fn memory_bounds_tiles_and_bands() {
        let wide = Tiling::new([65_536, 65_536], 4096, 40);
        let place = wide.place(0).expect("many tiles");
        assert_eq!(place.size_px, [4096, 1024], "256 MB of rows");
        let deep = Tiling::new([16_384, 16_384], 4096, 400);
        let place = deep.place(0).expect("many tiles");
        assert_eq!(place.size_px, [1600, 1600], "1 GB of targets");
    }
}
