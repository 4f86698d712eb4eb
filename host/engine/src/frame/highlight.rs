//! Marked surfels stand out: a tint over the pixels whose id is a marked one's.
//!
//! Every renderer that gives the `id` target shows marks this way and knows nothing of them. The tint is laid over the finished
//! picture in memory, where every picture ends, so that there is one way for devices and for the CPU.

use std::sync::Arc;

use rayon::prelude::*;

use super::picture::Picture;

/// Colour of the tint, sRGB: a magenta, which is rare in what is scanned.
pub const MARK_COLOUR: [u8; 3] = [255, 0, 160];

/// Part of the tint in a marked pixel, of 256: 60 %, so that the light on the surface is still to be seen.
const WEIGHT: u16 = 154;

/// Tints the pixels of which `is_marked` says yes by their ids. Mixed in sRGB, as it looks; coverage stays.
///
/// * `ids`: the `id` target of the picture, rows from the top; pixels beyond its end stay as they are.
pub(crate) fn highlight(
    picture: &mut Picture,
    ids: &[u32],
    is_marked: impl Fn(u32) -> bool + Sync,
) {
    // Pixels between two steals of work.
    const CHUNK: usize = 4096;
    let pixels = Arc::make_mut(&mut picture.rgba).as_chunks_mut::<4>().0;
    let chunks = pixels.par_chunks_mut(CHUNK).zip(ids.par_chunks(CHUNK));
    chunks.for_each(|(pixels, ids)| {
        // Neighbours often show the same surfel.
        let mut last = (0, false);
        for ([red, green, blue, _], &id) in pixels.iter_mut().zip(ids) {
            if id != last.0 {
                last = (id, is_marked(id));
            }
            if last.1 {
                for (byte, mark) in [red, green, blue].into_iter().zip(MARK_COLOUR) {
                    *byte = mixed(*byte, mark);
                }
            }
        }
    });
}

fn mixed(byte: u8, mark: u8) -> u8 {
    let sum = u16::from(byte) * (256 - WEIGHT) + u16::from(mark) * WEIGHT + 128;
    (sum >> 8) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn just_the_marked_pixels_are_tinted_and_keep_their_coverage() {
        let pixel = [10, 200, 90, 77];
        let mut picture = Picture {
            size_px: [5, 1],
            rgba: pixel.repeat(5).into(),
        };
        highlight(&mut picture, &[0, 3, 3, 4], |id| id == 3);
        let tinted = [157, 80, 132, 77];
        let expected = [pixel, tinted, tinted, pixel, pixel].concat();
        assert_eq!(*picture.rgba, expected[..]);
        assert_eq!((mixed(0, 0), mixed(255, 255)), (0, 255));
    }
}
